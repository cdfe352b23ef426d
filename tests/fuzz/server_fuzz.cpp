// A server against arbitrary clients; afterwards it must still greet the next one.
#include <algorithm>

#include "base/check.h"
#include "fuzz/fuzz.h"
#include "fuzz/virtual_peer.h"
#include "remote/server/server.h"

POCKETRAY_FUZZ_TARGET(fuzz_server)

namespace pocketray {
namespace {

using Bytes = std::vector<std::uint8_t>;
constexpr std::uint64_t kMs = 1'000'000;
constexpr int kClients = 2;
constexpr std::uint32_t kImageSide = 32;
constexpr double kServerNs = 100e3;  // per pixel: 200 per slice of CPU time
constexpr int kStepsMax = 400;
const platform::LinkBackend& net = platform::kNullLink;

struct FuzzClient {
  int stream = -1;
  bool reads = true;
  Bytes out;
};

struct Stage {
  FuzzLink link;
  Server* server = nullptr;
  FuzzClient clients[kClients];
  int steps_left = kStepsMax;

  explicit Stage(const platform::NullLinkSettings& line) : link(line) {
    ServerOptions o;
    o.client_count_max = kClients + 1;
    o.client_memory_bytes = 4u << 20;
    o.image_side_max = kImageSide;
    o.pace.ns_per_pixel = kServerNs;
    o.message_timeout_ns = o.stall_timeout_ns = 500 * kMs;
    o.idle_timeout_ns = 2'000 * kMs;
    CHECK(open_server(o, fuzz_store(), link.link, link.address, &server).ok);
  }
  ~Stage() {
    for (FuzzClient& client : clients) hang_up(&client);
    close_server(server);
  }
  void hang_up(FuzzClient* client) {
    if (client->stream >= 0) net.close(link.link, client->stream);
    *client = FuzzClient();
  }
  void connect(FuzzClient* client) {
    platform::Error error;
    hang_up(client);
    // Fails until the server has noticed that earlier connections are gone, as the link has only a few.
    client->stream = net.connect(link.link, link.address, 500 * kMs, &error);
  }
};

void take_all(Stage* stage, FuzzClient* client) {
  std::uint8_t part[4096];
  std::size_t count = 0;
  platform::Error error;
  while (client->stream >= 0 && client->reads) {
    platform::LinkResult result = net.read(stage->link.link, client->stream, part, sizeof part, &count, &error);
    fuzz_counts.answers += count > 0;
    if (result == platform::LinkResult::later) return;
    if (result != platform::LinkResult::done) return stage->hang_up(client);
  }
}

void step(Stage* stage, int count) {
  for (; count > 0 && stage->steps_left > 0; --count, --stage->steps_left) {
    for (FuzzClient& client : stage->clients) {
      if (client.stream >= 0 && !write_some(stage->link.link, client.stream, &client.out)) stage->hang_up(&client);
      take_all(stage, &client);
    }
    step_server(stage->server, 5 * kMs);
  }
}

// A valid message from a client.
Message sensible_message(FuzzInput* input) {
  static const MessageType kTypes[] = {MessageType::hello,       MessageType::scene_list,    MessageType::scene_query,
                                       MessageType::scene_fetch, MessageType::frame_request, MessageType::frame_change,
                                       MessageType::cancel,      MessageType::ping,          MessageType::view_query,
                                       MessageType::error};
  const StoredScene& scene = fuzz_store().scenes[0];
  Message m;
  m.type = kTypes[input->byte() % (sizeof kTypes / sizeof kTypes[0])];
  m.hello.image_side_max = kImageSideMax, m.hello.message_bytes_max = kMessageBytesMax;
  m.scene_query.hash = m.scene_fetch.hash = m.view_query.scene = scene.hash;
  m.scene_fetch.byte_count = 256 * input->byte();
  m.ping = {7, 16u * input->byte()};
  FrameRequest* q = &m.frame_request;
  const std::uint8_t frame = input->byte(), shape = input->byte();
  q->frame = 1 + frame % 16, q->scene = scene.hash;
  q->settings.width = kFuzzWidth, q->settings.height = kFuzzHeight;
  q->row_end = kFuzzHeight;
  q->chunk_rows = 1 + shape % 4;
  q->coarse_first = frame & 16;
  q->light_pitch = frame & 32 ? 6 : 0;
  if (frame & 64) q->settings.indirect = indirect_choice(Effect::instant_radiosity);
  q->seconds = 0.25 * (shape >> 2 & 3);
  q->row_begin = shape >> 4 & 7;
  const bool has_light_alone = (frame & 128) && q->light_pitch > 0;
  // Sometimes an order that begins with the upper rows.
  if (has_light_alone) q->row_end = q->row_begin;
  if (std::uint8_t cut = input->byte() % (2 * kFuzzHeight); cut > 0 && q->row_begin + cut < q->row_end) {
    q->run_count = 2;
    q->runs[0] = {cut, 0}, q->runs[1] = {static_cast<std::uint8_t>(q->row_end - q->row_begin - cut), 1};
  }
  m.view_query.settings = q->settings;
  m.cancel.frame = q->frame;
  return m;
}

void act(Stage* stage, FuzzInput* input) {
  std::uint8_t kind = input->byte();
  FuzzClient* client = &stage->clients[kind & 1];
  if (client->stream < 0) stage->connect(client);
  auto append = [&](const Bytes& bytes) { client->out.insert(client->out.end(), bytes.begin(), bytes.end()); };
  switch (kind >> 1 & 7) {
    case 0:
      return step(stage, 1 + input->byte() % 8);
    case 1:
    case 2:
      return append(wire_bytes(sensible_message(input)));
    case 3:
    case 4: {
      Bytes bytes = wire_bytes(sensible_message(input));
      std::uint8_t offset = input->byte();
      change_sealed(&bytes, offset, input->byte());
      return append(bytes);
    }
    case 5: {
      std::uint8_t type = input->byte();
      return append(sealed_bytes(type, input->bytes(input->byte())));
    }
    case 6:
      return append(input->bytes(input->byte()));
    default:
      if (kind & 16) client->reads = !client->reads;
      if (kind & 32) stage->hang_up(client);
      return;
  }
}

// Connects another client and expects a greeting.
void greet_one_more(Stage* stage) {
  FuzzClient newcomer;
  stage->connect(&newcomer);
  std::size_t come = 0;
  for (std::uint64_t until = net.now_ns(stage->link.link) + 20'000 * kMs;
       come == 0 && net.now_ns(stage->link.link) < until;) {
    step_server(stage->server, 5 * kMs);
    std::uint8_t part[256];
    platform::Error error;
    CHECK(net.read(stage->link.link, newcomer.stream, part, sizeof part, &come, &error) !=
          platform::LinkResult::failed);
  }
  CHECK_GT(come, 0u);
  stage->hang_up(&newcomer);
}

}  // namespace

void fuzz_server(const std::uint8_t* bytes, std::size_t byte_count) {
  FuzzInput input = {bytes, byte_count};
  std::uint8_t flags = input.byte();
  platform::NullLinkSettings line;
  line.latency_ns = flags & 1 ? (flags & 8 ? 100 * kMs : kMs) : 0;
  line.bytes_per_second = flags & 2 ? 100'000 : 0;
  Stage stage(line);
  if (flags & 4)
    for (FuzzClient& client : stage.clients) {
      stage.connect(&client);
      Message hello;
      hello.hello.image_side_max = kImageSideMax, hello.hello.message_bytes_max = kMessageBytesMax;
      client.out = wire_bytes(hello);
    }
  while (input.left > 0 && stage.steps_left > 0) act(&stage, &input);
  step(&stage, 20);
  greet_one_more(&stage);
}

}  // namespace pocketray
