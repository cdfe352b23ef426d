#include "crowd_rig.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "remote/server/state.h"

namespace pocketray {
namespace {

constexpr std::uint64_t kReturnNs = 50 * kMs;  // after which an attacker that was refused comes back
constexpr int kOneAddress = 2, kOwnAddresses = 100;

std::vector<int>* address_of = nullptr;

Message exposure_query() {
  Message message;
  message.type = MessageType::view_query;
  message.view_query.scene = builtin_hash("cube");
  message.view_query.measure_exposure = true;
  message.view_query.settings.width = 999;
  message.view_query.settings.height = 500;
  return message;
}

Message largest_ping() {
  Message message;
  message.type = MessageType::ping;
  message.ping = {1, kPingBytesMax};
  return message;
}

// Returns true once the attacker has its answer or has waited long enough, and attacks again.
bool comes_again(Attack kind, ServerRig* rig, const Attacker& a) {
  const std::uint64_t passed = rig->now() - a.begun_ns;
  const bool late = a.frame > 0 && passed > 100 * kMs;
  if (passed < 5 * kMs) return false;
  return a.client->closed || late ||
         a.client->has(kind == Attack::pings_again ? MessageType::pong : MessageType::view_entry);
}

void attack_once(Attack kind, Attacker* a) {
  if (a->frame > 0) return;
  a->frame = 1;
  if (kind == Attack::given_up_again) return a->client->request(frame_request("cube", 1, 480, 320));
  for (int i = 0; i < 8; ++i) a->client->send(kind == Attack::views_again ? exposure_query() : largest_ping());
}

void flood(Attack kind, Attacker* a) {
  ScriptedClient* c = a->client.get();
  a->waiting -= std::min(a->waiting, c->received.size());
  c->received.clear();
  Message message = largest_ping();
  if (kind == Attack::fetches) {
    message.type = MessageType::scene_fetch;
    message.scene_fetch = {builtin_hash("cornell"), 0, kPieceBytesMax};
  }
  if (kind == Attack::small_messages) message.type = MessageType::scene_list;
  for (; a->waiting < 8; ++a->waiting) c->send(message);
}

void attack(Attack kind, ServerRig* rig, Attacker* a) {
  ScriptedClient* c = a->client.get();
  if (is_repeated(kind)) return attack_once(kind, a);
  if (kind == Attack::none || kind == Attack::silence) return;
  if (kind == Attack::pings || kind == Attack::fetches || kind == Attack::small_messages) return flood(kind, a);
  const bool first = a->frame == 0;
  if (kind == Attack::views) {
    if (!first && !c->has(MessageType::view_entry)) return;
    c->received.clear();
    c->send(exposure_query());
    a->frame = 1;
    return;
  }
  bool done = c->rows_come == (kind == Attack::heavy_frames ? 320 : kGoodHeight);
  if (kind == Attack::given_up || kind == Attack::given_up_late) done = rig->now() - a->asked_ns > 150 * kMs;
  if (!first && !done) return;
  a->asked_ns = rig->now();
  if (kind == Attack::given_up_late) {
    FrameRequest request = frame_request("cube", ++a->frame, 64, 480);
    request.chunk_rows = 1;
    return c->request(request);
  }
  const bool is_light = kind == Attack::light_frames;
  c->request(frame_request("cube", ++a->frame, is_light ? kGoodWidth : 480, is_light ? kGoodHeight : 320));
}

void connect_attacker(AttackCrowd* crowd, std::size_t index) {
  int address = crowd->origin == Origin::one ? kOneAddress : kGoodAddress;
  if (crowd->origin == Origin::own) address = kOwnAddresses + static_cast<int>(index);
  if (crowd->origin == Origin::new_one) address = kOwnAddresses + crowd->book->connection_count();
  crowd->attackers[index] = Attacker();
  crowd->attackers[index].begun_ns = crowd->rig->now();
  crowd->attackers[index].client = crowd->book->connect(address);
}

}  // namespace

const char* const kOriginNames[] = {"addresses of their own", "a new address each time", "one address",
                                    "the client's address"};

AddressBook::AddressBook(ServerRig* rig) : rig_(rig) {
  address_of = &addresses_;
  net_.stream_name = name;
  rig->server->net = &net_;
}

AddressBook::~AddressBook() { rig_->server->net = &platform::kNullLink; }

const char* AddressBook::name(const platform::Link* link, int stream) {
  static char name[48];
  const char* own = platform::kNullLink.stream_name(link, stream);
  const int port = std::atoi(std::strrchr(own, ':') + 1);
  const std::size_t connection = static_cast<std::size_t>(port - 49152);
  if (connection >= address_of->size()) return own;
  std::snprintf(name, sizeof name, "10.0.0.%d:%d", (*address_of)[connection], port);
  return name;
}

std::unique_ptr<ScriptedClient> AddressBook::connect(int address) {
  addresses_.push_back(address);
  return std::make_unique<ScriptedClient>(rig_);
}

ServerOptions crowd_options(int client_count_max) {
  ServerOptions options;
  options.pace.ns_per_pixel = static_cast<double>(kPixelNs);
  options.message_ns = 50'000, options.byte_ps = 10'000;
  options.client_count_max = client_count_max;
  options.client_memory_bytes = 12u << 20;
  return options;
}

void AttackCrowd::connect(int attacker_count) {
  attackers.resize(static_cast<std::size_t>(attacker_count));
  for (std::size_t i = 0; i < attackers.size(); ++i) connect_attacker(this, i);
}

void AttackCrowd::act() {
  for (std::size_t i = 0; i < attackers.size(); ++i) {
    Attacker* a = &attackers[i];
    a->client->poll();
    const bool refused = a->client->closed || a->client->has(MessageType::error);
    if (refused && !comes_back && !is_repeated(kind)) FAIL("an attacker was refused");
    const bool returns = refused && rig->now() - a->begun_ns > kReturnNs;
    if (is_repeated(kind) ? comes_again(kind, rig, *a) : returns) connect_attacker(this, i);
    if (!refused) attack(kind, rig, a);
  }
}

}  // namespace pocketray
