// The effect of other clients on one with light frames, in virtual time: with an emulated CPU and counted pixels and
// messages, the load of this machine does not matter.
#include <doctest/doctest.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>

#include "client_count.h"
#include "remote/server/state.h"
#include "support/effort.h"
#include "support/scripted_client.h"

using namespace pocketray;

namespace {

constexpr std::uint64_t kPixelNs = 50'000;
constexpr std::uint32_t kGoodWidth = 40, kGoodHeight = 30;

// Addresses of connections in order of creation, as the simulated link has only one.
std::vector<int>* address_of = nullptr;
const char* named_by_address(const platform::Link* link, int stream) {
  static char name[48];
  const char* own = platform::kNullLink.stream_name(link, stream);
  int port = std::atoi(std::strrchr(own, ':') + 1);
  std::size_t connection = static_cast<std::size_t>(port - 49152);
  if (connection >= address_of->size()) return own;
  std::snprintf(name, sizeof name, "10.0.0.%d:%d", (*address_of)[connection], port);
  return name;
}

enum class Attack {
  none,
  heavy_frames,  // of 8 s each
  given_up,      // replaced after a while
  views,         // with measured exposure
  pings,         // with the largest answers
  fetches,       // of a scene
  small_messages,
  silence,       // holds a place and nothing else
  light_frames,  // as light as the good client's
  // On a connection of its own each:
  views_again,
  pings_again,
  given_up_again,
};

// Where each attacker's connections come from.
enum class Origin { own, new_one, one, the_clients };
const char* const kOriginNames[] = {"addresses of their own", "a new address each time", "one address",
                                    "the client's address"};

struct Attacker {
  std::unique_ptr<ScriptedClient> client;
  std::uint32_t frame = 0;
  std::uint64_t asked_ns = 0, begun_ns = 0;
  std::size_t waiting = 0;
};

// Whether it has had its answer, or waited long enough, and comes again.
bool comes_again(Attack kind, ServerRig* rig, const Attacker& a) {
  const std::uint64_t passed = rig->now() - a.begun_ns;
  const bool late = a.frame > 0 && passed > 100 * kMs;
  if (passed < 5 * kMs) return false;
  return a.client->closed || late ||
         a.client->has(kind == Attack::pings_again ? MessageType::pong : MessageType::view_entry);
}

void attack(Attack kind, ServerRig* rig, Attacker* a) {
  ScriptedClient* c = a->client.get();
  Message message;
  message.type = MessageType::ping;
  if (kind >= Attack::views_again) {
    if (a->frame > 0) return;
    a->frame = 1;
    message.ping = {1, kPingBytesMax};
    message.view_query.scene = builtin_hash("cube");
    message.view_query.measure_exposure = true;
    message.view_query.settings.width = 999;
    message.view_query.settings.height = 500;
    if (kind == Attack::given_up_again) return c->request(frame_request("cube", 1, 480, 320));
    if (kind == Attack::views_again) message.type = MessageType::view_query;
    for (int i = 0; i < 8; ++i) c->send(message);
    return;
  }
  c->poll();
  if (c->closed || c->has(MessageType::error)) FAIL("an attacker was refused");
  bool is_flood = kind == Attack::pings || kind == Attack::fetches || kind == Attack::small_messages;
  if (is_flood) {
    a->waiting -= std::min(a->waiting, c->received.size());
    c->received.clear();
    message.ping = {1, kPingBytesMax};
    if (kind == Attack::fetches) {
      message.type = MessageType::scene_fetch;
      message.scene_fetch = {builtin_hash("cornell"), 0, kPieceBytesMax};
    }
    if (kind == Attack::small_messages) message.type = MessageType::scene_list;
    for (; a->waiting < 8; ++a->waiting) c->send(message);
    return;
  }
  bool first = a->frame == 0, done = c->rows_come > 0;
  if (kind == Attack::views && (first || c->has(MessageType::view_entry))) {
    c->received.clear();
    message.type = MessageType::view_query;
    message.view_query.scene = builtin_hash("cube");
    message.view_query.measure_exposure = true;
    message.view_query.settings.width = 999;
    message.view_query.settings.height = 500;
    c->send(message);
    a->frame = 1;
  }
  if (kind == Attack::heavy_frames) done = c->rows_come == 320;
  if (kind == Attack::light_frames) done = c->rows_come == kGoodHeight;
  if (kind == Attack::given_up) done = rig->now() - a->asked_ns > 150 * kMs;
  if (kind < Attack::views || kind == Attack::light_frames)
    if (kind != Attack::none && (first || done)) {
      FrameRequest request = frame_request("cube", ++a->frame, 480, 320);
      if (kind == Attack::light_frames) request = frame_request("cube", a->frame, kGoodWidth, kGoodHeight);
      c->request(request);
      a->asked_ns = rig->now();
    }
}

struct FrameTimes {
  double median_ms = 0, longest_ms = 0;
};

// Times of the good client's frames from the first second of the attack on. It comes before the attackers, or after
// they have begun.
FrameTimes frame_times(Attack kind, int attacker_count, Origin origin, bool comes_first = true) {
  ServerOptions options;
  options.pace.ns_per_pixel = static_cast<double>(kPixelNs);
  options.message_ns = 50'000, options.byte_ps = 10'000;
  options.client_count_max = 24;
  options.client_memory_bytes = 12u << 20;
  ServerRig rig(options);
  constexpr int kGood = 1, kOne = 2, kOwn = 100;
  std::vector<int> addresses;
  address_of = &addresses;
  platform::LinkBackend net = platform::kNullLink;
  net.stream_name = named_by_address;
  rig.server->net = &net;

  std::unique_ptr<ScriptedClient> good;
  auto come = [&] {
    addresses.push_back(kGood);
    good = std::make_unique<ScriptedClient>(&rig);
  };
  if (comes_first) come(), good->wait_for(MessageType::hello);
  std::vector<Attacker> attackers(static_cast<std::size_t>(attacker_count));
  auto connect = [&](std::size_t i) {
    const int own = kOwn + static_cast<int>(origin == Origin::new_one ? addresses.size() : i);
    addresses.push_back(origin == Origin::the_clients ? kGood : origin == Origin::one ? kOne : own);
    attackers[i] = Attacker();
    attackers[i].begun_ns = rig.now();
    attackers[i].client = std::make_unique<ScriptedClient>(&rig);
  };
  for (std::size_t i = 0; i < attackers.size(); ++i) connect(i);
  FrameRequest request = frame_request("cornell", 0, kGoodWidth, kGoodHeight);
  std::vector<double> times;
  const std::uint64_t start = rig.now(), settled = start + (attacker_count > 0 ? 1000 * kMs : 0);
  std::uint64_t begin = 0;
  const std::size_t wanted = 15;
  rig.run_until(
      [&] {
        for (std::size_t i = 0; i < attackers.size(); ++i) {
          attackers[i].client->poll();
          if (kind >= Attack::views_again && comes_again(kind, &rig, attackers[i])) connect(i);
          attack(kind, &rig, &attackers[i]);
        }
        if (!good && rig.now() - start > 200 * kMs) come();
        if (!good) return false;
        good->poll();
        if (good->closed) FAIL("the good client was closed");
        if (request.frame > 0 && good->rows_come < kGoodHeight) return false;
        std::uint64_t now = rig.now();
        if (request.frame > 0 && begin >= settled) times.push_back(static_cast<double>(now - begin) * 1e-6);
        ++request.frame;
        good->request(request);
        begin = now;
        return times.size() >= wanted;
      },
      200'000 * kMs);
  rig.server->net = &platform::kNullLink;
  std::sort(times.begin(), times.end());
  return {times[times.size() / 2], times.back()};
}

}  // namespace

// Goal: whatever twenty others do, from wherever they come and however often, light frames of a client take at most 1.5
// times as long as alone in the median, and never more than twice, from the first second on. Method: successive frames
// relative to those of the client alone, which comes first or while the attack lasts.
TEST_CASE("neighbours_cost_a_light_client_a_third_of_its_frames_at_most") {
  const double alone = frame_times(Attack::none, 0, Origin::own).median_ms;
  CHECK(alone == doctest::Approx(kGoodWidth * kGoodHeight * kPixelNs * 1e-6).epsilon(0.05));
  struct Case {
    Attack kind;
    const char* name;
    std::vector<Origin> origins;
    bool quick;
  };
  const Case cases[] = {
      {Attack::heavy_frames, "heavy frames", {Origin::own, Origin::the_clients}, true},
      {Attack::given_up, "frames given up", {Origin::own, Origin::the_clients}, false},
      {Attack::views, "view queries", {Origin::own}, true},
      {Attack::pings, "pings", {Origin::own, Origin::the_clients}, true},
      {Attack::fetches, "fetches of a scene", {Origin::own}, false},
      {Attack::small_messages, "small messages", {Origin::own}, false},
      {Attack::silence, "silence", {Origin::own}, false},
      {Attack::views_again, "view queries", {Origin::own, Origin::new_one, Origin::one, Origin::the_clients}, true},
      {Attack::pings_again, "pings", {Origin::own, Origin::new_one, Origin::the_clients}, false},
      {Attack::given_up_again, "frames given up", {Origin::own, Origin::new_one, Origin::the_clients}, true},
  };
  for (const Case& c : cases) {
    if (!c.quick && kEffortDivisor > 1) continue;
    for (const Origin origin : c.origins)
      for (const bool comes_first : {true, false}) {
        const FrameTimes times = frame_times(c.kind, 20, origin, comes_first);
        const std::string name = std::string(c.name) + (c.kind >= Attack::views_again ? ", each anew" : "") +
                                 ", from " + kOriginNames[static_cast<int>(origin)] +
                                 (comes_first ? "" : ", already there");
        MESSAGE("20 neighbours, " << name << ": " << times.median_ms / alone << " times as long, at most "
                                  << times.longest_ms / alone);
        CHECK_MESSAGE(times.median_ms <= 1.5 * alone, name);
        CHECK_MESSAGE(times.longest_ms <= 2 * alone, name);
      }
  }
}

// Goal: twenty others with frames as light as the client's, from one address, have half of the time. Method: as above.
TEST_CASE("neighbours_with_light_frames_share_by_address") {
  const double alone = frame_times(Attack::none, 0, Origin::own).median_ms;
  CHECK(frame_times(Attack::light_frames, 20, Origin::one).median_ms <= 2.1 * alone);
}

// Goal: a view_query measures exposure in slices, so that nobody waits for all of it. Method: the longest busy time of
// the emulated CPU for an exposure of 125 s; a ping answered meanwhile.
TEST_CASE("server_measures_exposures_in_slices") {
  ServerOptions options;
  options.pace.ns_per_pixel = 25e6;
  ServerRig rig(options);
  ScriptedClient client(&rig);
  client.wait_for(MessageType::hello);
  Message query, ping;
  query.type = MessageType::view_query;
  query.view_query.scene = builtin_hash("cube");
  query.view_query.measure_exposure = true;
  query.view_query.settings.width = 999;
  query.view_query.settings.height = 500;
  client.send(query);
  ping.type = MessageType::ping;
  std::uint64_t longest_ns = 0;
  rig.run_until(
      [&] {
        const Work& work = rig.server->work;
        if (work.session >= 0) longest_ns = std::max(longest_ns, work.end_ns - work.begin_ns);
        client.poll();
        return client.has(MessageType::view_entry);
      },
      200'000 * kMs);
  CHECK(longest_ns <= 8 * 25'000'000ull);  // the first ones, with unknown cost
  client.send(ping);
  client.wait_for(MessageType::pong);
}

// Goal: silent clients give way to others. Method: eight that only say hello, from eight addresses; a ninth is told
// that the server is busy, and admitted once they have been silent for ten seconds.
TEST_CASE("server_gives_the_place_of_who_is_silent_to_who_comes") {
  ServerRig rig;
  std::vector<int> addresses = {1, 2, 3, 4, 5, 6, 7, 8, 9, 9};
  address_of = &addresses;
  platform::LinkBackend net = platform::kNullLink;
  net.stream_name = named_by_address;
  rig.server->net = &net;
  std::vector<std::unique_ptr<ScriptedClient>> silent;
  for (int i = 0; i < 8; ++i) silent.push_back(std::make_unique<ScriptedClient>(&rig));
  rig.run_until([&] { return client_count(*rig.server) == 8; });
  ScriptedClient early(&rig);
  CHECK(early.wait_for(MessageType::error)->message.error.code == WireError::busy);
  std::uint64_t later = rig.now() + 10'000 * kMs;
  rig.run_until([&] { return rig.now() >= later; });
  ScriptedClient ninth(&rig);
  ninth.request(frame_request("cube", 1, 16, 12));
  ninth.wait_for_rows(12);
  CHECK(client_count(*rig.server) == 8);
  rig.run_until([&] { return silent[0]->poll(), silent[0]->closed; });
  CHECK(silent[0]->has_error(WireError::busy));
  rig.server->net = &platform::kNullLink;
}

// Goal: one address cannot keep others out, however busy its clients are. Method: eight from one address with frames in
// progress; two from other addresses get in, a ninth from the first does not.
TEST_CASE("server_gives_no_address_all_places_for_long") {
  ServerOptions options;
  options.pace.ns_per_pixel = 100'000;
  ServerRig rig(options);
  std::vector<int> addresses = {1, 1, 1, 1, 1, 1, 1, 1, 2, 3, 1};
  address_of = &addresses;
  platform::LinkBackend net = platform::kNullLink;
  net.stream_name = named_by_address;
  rig.server->net = &net;
  std::vector<std::unique_ptr<ScriptedClient>> many;
  for (int i = 0; i < 8; ++i) {
    many.push_back(std::make_unique<ScriptedClient>(&rig));
    many.back()->request(frame_request("cube", 1, 320, 240));
  }
  rig.run_until([&] { return client_count(*rig.server) == 8; });
  for (int i = 0; i < 2; ++i) {
    many.push_back(std::make_unique<ScriptedClient>(&rig));
    many.back()->request(frame_request("cube", 1, 16, 12));
    many.back()->wait_for_rows(12);
  }
  ScriptedClient late(&rig);
  CHECK(late.wait_for(MessageType::error)->message.error.code == WireError::busy);
  CHECK(client_count(*rig.server) == 8);
  rig.server->net = &platform::kNullLink;
}

// Goal: after a failed accept() the listener rests for a while. Method: a link whose accept() fails, with a waiting
// peer; calls in ten seconds, and the log.
TEST_CASE("server_rests_where_it_cannot_accept") {
  static int calls = 0;
  calls = 0;
  ServerRig rig;
  platform::LinkBackend net = platform::kNullLink;
  net.accept = [](platform::Link*, int, int*, platform::Error* error) {
    std::snprintf(error->text, sizeof error->text, "too many files are open");
    ++calls;
    return platform::LinkResult::failed;
  };
  rig.server->net = &net;
  ScriptedClient waiting(&rig);
  std::uint64_t later = rig.now() + 10'000 * kMs;
  rig.run_until([&] { return rig.now() >= later; });
  CHECK(calls >= 9);
  CHECK(calls <= 12);
  CHECK(rig.log.size() <= 12);
  rig.server->net = &platform::kNullLink;
  waiting.wait_for(MessageType::hello);
}

// Goal: frame 0, which means none in an error, cannot be requested. Method: request it.
TEST_CASE("server_refuses_frame_zero") {
  ServerRig rig;
  ScriptedClient client(&rig);
  client.request(frame_request("cube", 0, 16, 12));
  CHECK(client.wait_for(MessageType::error)->message.error.code == WireError::bad_request);
}

// Goal: suddenly expensive pixels do not make a slice long, since cheap pixels before them say little. Method: slice
// time in a room behind a background a thousand times cheaper, with expensive settings; with cheap settings slices have
// their normal length.
TEST_CASE("server_slices_expect_dear_pixels_behind_cheap_ones") {
  constexpr std::uint64_t kSliceNs = 20 * kMs;
  constexpr double kRoomNs = 650'000, kBackgroundNs = 650;
  Settings dear, cheap;
  dear.samples_per_pixel = 16;
  CHECK(slice_pixels(dear, 512, kBackgroundNs, kSliceNs) * kRoomNs < 2.0 * kSliceNs);
  CHECK(slice_pixels(dear, 512, 10 * kRoomNs, kSliceNs) * 10 * kRoomNs <= kSliceNs);
  CHECK(slice_pixels(dear, 512, 1e12, kSliceNs) == 1);
  CHECK(slice_pixels(cheap, 8, 2'000, kSliceNs) == kSliceNs / 2'000);
  double known = kRoomNs;
  for (int i = 0; i < 3; ++i) known = dear_pixel_ns(known, kBackgroundNs);  // left and right of the room
  CHECK(known > 0.6 * kRoomNs);
  CHECK(dear_pixel_ns(known, kRoomNs) == kRoomNs);
}

// Goal: whoever opens connections without a hello has half of the guests' places at most, so that a client from
// elsewhere gets in at once, and its own oldest ones make way. Method: a flood from one address, then a client.
TEST_CASE("server_keeps_guests_places_for_other_addresses") {
  ServerRig rig;
  const int half = ServerOptions().guest_count_max / 2;
  std::vector<int> flood;
  auto is_open = [&](int stream) {
    char byte[64];
    std::size_t count = 0;
    platform::Error error;
    platform::LinkResult result = platform::LinkResult::done;
    while (result == platform::LinkResult::done)
      result = rig.net->read(rig.link, stream, byte, sizeof byte, &count, &error);
    return result == platform::LinkResult::later;
  };
  for (int i = 0; i < 3 * half; ++i) {
    platform::Error error;
    int stream = platform::null_link_connect_from(rig.link, "10.0.0.7", rig.address, 1000 * kMs, &error);
    REQUIRE_MESSAGE(stream >= 0, error.text);
    flood.push_back(stream);
    rig.step();
    rig.step();
  }
  for (int i = 0; i < 3 * half; ++i) {
    CAPTURE(i);
    CHECK_EQ(is_open(flood[static_cast<std::size_t>(i)]), i >= 2 * half);
  }
  ScriptedClient client(&rig);
  client.wait_for(MessageType::hello, 100 * kMs);
  for (int i = 2 * half; i < 3 * half; ++i) CHECK(is_open(flood[static_cast<std::size_t>(i)]));
  for (int stream : flood) rig.net->close(rig.link, stream);
}
