// A device against an arbitrary server: a well-behaved server answers, and the input decides how each message is
// changed before it is sent.
#include <algorithm>
#include <map>
#include <tuple>

#include "base/check.h"
#include "engine/frame.h"
#include "fuzz/fuzz.h"
#include "fuzz/virtual_peer.h"
#include "present/pack.h"
#include "remote/client/client.h"
#include "remote/client/frame.h"
#include "remote/client/inquiry.h"
#include "wire/codec.h"
#include "wire/light_coder.h"
#include "wire/row_sequence.h"

POCKETRAY_FUZZ_TARGET(fuzz_client)

namespace pocketray {
namespace {

using Bytes = std::vector<std::uint8_t>;
constexpr std::uint64_t kMs = 1'000'000;
constexpr double kDeviceNs = 100e3;  // per pixel: 19 ms per frame
// At least; of frames whose way to be shared is chosen, enough for both ways and a second trial of the slower one.
constexpr int kFrames = 3, kChosenFrames = 3 * (kTrialFrames + kRetryFramesMin), kFramesMax = 2 * kChosenFrames;
constexpr std::uint64_t kLatenciesNs[] = {0, kMs, 20 * kMs, 120 * kMs};  // each way
constexpr std::size_t kFloodMessages = 300;
const platform::LinkBackend& net = platform::kNullLink;

struct Peer {
  FuzzInput* input;
  platform::Link* link;
  int listener, stream = -1;
  bool silent = false;
  std::uint64_t stalled_ns = 0;  // time in which the whole machine stood still
  Bytes in, out;
  FrameRequest request;
  RowSequence due;
  std::uint32_t chunk_count = 0;
  Bytes encoder_block;
  RowEncoder* encoder = nullptr;
};
Peer* peer = nullptr;

// The right pixels of a request, by a renderer of the server's own.
const Bytes& picture_of(const FrameRequest& q) {
  static std::map<std::tuple<int, int, double>, Bytes> pictures;
  const WireFormat format = q.format;
  Bytes& pixels = pictures[{static_cast<int>(format), static_cast<int>(q.settings.indirect), q.seconds}];
  if (!pixels.empty()) return pixels;
  Renderer* renderer = fuzz_renderer(FuzzSide::server);
  Settings settings = renderer->settings;
  settings.indirect = q.settings.indirect;
  CHECK(change_settings(renderer, settings).ok);
  CHECK(render_frame(renderer, q.seconds).ok);
  int line_bytes = static_cast<int>(kFuzzWidth * pixel_bytes(format));
  pixels.resize(static_cast<std::size_t>(line_bytes) * kFuzzHeight);
  pack_rows(renderer->image.data, kFuzzWidth, kFuzzHeight, 0, kFuzzHeight, display_of(*renderer),
            format == WireFormat::rgb565 ? kRgb565 : kRgb888, Rotation::none, false, pixels.data(), line_bytes);
  return pixels;
}

void hang_up() {
  if (peer->stream >= 0) net.close(peer->link, peer->stream);
  peer->stream = -1;
}

// Changes a message, or sends others before it, as the input says. Three quarters of all bytes leave it unchanged.
void send(const Message& message) {
  Bytes bytes = wire_bytes(message);
  auto append = [](const Bytes& more) { peer->out.insert(peer->out.end(), more.begin(), more.end()); };
  FuzzInput* input = peer->input;
  std::uint8_t act = input->byte();
  if (act >= 255) {
    net.poll(peer->link, nullptr, 0, 1'000 * kMs);
    peer->stalled_ns += 1'000 * kMs;
  } else if (act >= 254) {
    peer->silent = true;
  } else if (act >= 250) {
    return hang_up();
  } else if (act >= 246) {
    append(input->bytes(input->byte()));
  } else if (act >= 232) {
    std::uint8_t type = input->byte();
    Bytes inserted = sealed_bytes(type, input->bytes(input->byte()));
    for (std::size_t i = act >= 244 ? kFloodMessages : 1; i > 0; --i) append(inserted);
  } else if (act >= 224) {
    append(bytes);
  } else if (act >= 216) {
    return;
  } else if (act >= 212) {
    bytes[input->byte() % bytes.size()] ^= input->byte();
  } else if (act >= 192) {
    std::uint8_t offset = input->byte();
    change_sealed(&bytes, offset, input->byte());
  }
  append(bytes);
}

void send_rows() {
  const FrameRequest& q = peer->request;
  CodecShape shape = {kFuzzWidth, kFuzzHeight, kFuzzHeight, q.format};
  const std::uint32_t row_count = next_chunk_rows(q, peer->due), begin = peer->due.row_end - row_count;
  if (!peer->encoder) {
    peer->encoder_block.assign(row_encoder_need(shape) + kArenaAlignment, 0);
    Arena arena = make_arena("encoder", peer->encoder_block.data(), peer->encoder_block.size());
    make_row_encoder(shape, &arena, &peer->encoder);
  }
  Bytes encoded(encoded_bytes_max(shape, row_count));
  Message message;
  message.type = MessageType::row_chunk;
  RowChunk* chunk = &message.row_chunk;
  chunk->frame = q.frame, chunk->pixel_ps = 10'000'000, chunk->traced = 255;
  chunk->row_begin = static_cast<std::uint16_t>(begin), chunk->row_count = static_cast<std::uint16_t>(row_count);
  const Bytes& picture = picture_of(q);
  std::uint32_t count =
      encode_rows(peer->encoder, q.frame, begin, row_count, picture.data() + begin * kFuzzWidth * pixel_bytes(q.format),
                  q.coding, encoded.data(), &chunk->encoding);
  add_chunk_number(chunk, peer->chunk_count++);
  chunk->bytes = {encoded.data(), count};
  pass_rows(q, row_count, &peer->due);
  send(message);
}

void send_coarse() {
  const FrameRequest& q = peer->request;
  const Bytes pixels(coarse_bytes(kFuzzWidth, kFuzzHeight, q.format), 0x5A);
  Message message;
  message.type = MessageType::coarse_picture;
  message.coarse_picture.frame = q.frame;
  message.coarse_picture.pixels = {pixels.data(), static_cast<std::uint32_t>(pixels.size())};
  send(message);
}

void send_light() {
  const FrameRequest& q = peer->request;
  const LightGrid grid = light_grid(q.settings, q.light_pitch);
  std::vector<Vec3> light(light_count(grid), Vec3{0.5f, 0.25f, 0.125f});
  Bytes bytes(light_bytes_max(light.size()));
  Message message;
  message.type = MessageType::light_map;
  message.light_map.frame = q.frame, message.light_map.light_ps = 10'000'000;
  const std::size_t byte_count = encode_light(light.data(), grid.columns, grid.rows, 0, bytes.data());
  message.light_map.bytes = {bytes.data(), static_cast<std::uint32_t>(byte_count)};
  send(message);
}

void answer(const Message& asked) {
  static const std::uint8_t zeros[kPingBytesMax] = {};
  const StoredScene& stored = fuzz_store().scenes[0];
  Message message;
  switch (asked.type) {
    case MessageType::scene_list:
    case MessageType::scene_query: {
      message.type = MessageType::scene_entry;
      SceneEntry* entry = &message.scene_entry;
      entry->hash = stored.hash, entry->byte_count = stored.byte_count, entry->count = 1;
      entry->triangle_count = stored.scene.triangles.count;
      std::copy(std::begin(stored.name), std::end(stored.name), entry->name);
      return send(message);
    }
    case MessageType::scene_fetch: {
      message.type = MessageType::scene_piece;
      message.scene_piece.hash = asked.scene_fetch.hash, message.scene_piece.offset = asked.scene_fetch.offset;
      std::uint64_t begin = std::min<std::uint64_t>(asked.scene_fetch.offset, stored.byte_count);
      std::uint64_t count = std::min<std::uint64_t>(asked.scene_fetch.byte_count, stored.byte_count - begin);
      message.scene_piece.bytes = {stored.bytes + begin, static_cast<std::uint32_t>(count)};
      return send(message);
    }
    case MessageType::view_query:
      message.type = MessageType::view_entry;
      message.view_entry.scene = stored.hash;
      return send(message);
    case MessageType::ping:
      message.type = MessageType::pong;
      message.pong.id = asked.ping.id, message.pong.pixel_ps = 10'000'000;
      message.pong.bytes = {zeros, asked.ping.reply_bytes};
      return send(message);
    case MessageType::frame_request:
    case MessageType::frame_change:
      if (asked.type == MessageType::frame_change)
        take_change(asked.frame_request, &peer->request);
      else
        peer->request = asked.frame_request;
      peer->due = first_rows(peer->request);
      if (peer->request.light_pitch > 0) send_light();
      return peer->request.coarse_first ? send_coarse() : void();
    case MessageType::cancel:
      peer->due = RowSequence();
      return;
    default:
      return;
  }
}

void step_peer() {
  platform::Error error;
  int stream;
  while (net.accept(peer->link, peer->listener, &stream, &error) == platform::LinkResult::done) {
    hang_up();
    peer->stream = stream, peer->silent = false;
    peer->in.clear(), peer->out.clear();
    peer->due = RowSequence(), peer->chunk_count = 0, peer->encoder = nullptr;
    Message hello;
    hello.type = MessageType::hello;
    hello.hello.image_side_max = kImageSideMax, hello.hello.message_bytes_max = 512;
    send(hello);
  }
  std::uint8_t part[1024];
  std::size_t count = 0;
  while (peer->stream >= 0 &&
         net.read(peer->link, peer->stream, part, sizeof part, &count, &error) == platform::LinkResult::done)
    peer->in.insert(peer->in.end(), part, part + count);
  std::size_t begin = 0;
  while (peer->stream >= 0 && !peer->silent) {
    Message message;
    Decoded decoded = decode_message(peer->in.data() + begin, peer->in.size() - begin, kMessageBytesMax, &message);
    CHECK(decoded.state != DecodeState::malformed);  // a device obeys the protocol whatever it receives
    if (decoded.state != DecodeState::message) break;
    begin += decoded.byte_count;
    answer(message);
  }
  peer->in.erase(peer->in.begin(), peer->in.begin() + static_cast<std::ptrdiff_t>(begin));
  while (peer->stream >= 0 && !peer->silent && peer->out.empty() && has_rows(peer->due)) send_rows();
  if (peer->stream >= 0 && !write_some(peer->link, peer->stream, &peer->out)) hang_up();
}

int poll_both(platform::Link* link, platform::LinkWait* waits, int wait_count, std::uint64_t timeout_ns) {
  std::uint64_t left = timeout_ns;
  for (;;) {
    step_peer();
    std::uint64_t step = std::min<std::uint64_t>(left, 2 * kMs);
    int ready = net.poll(link, waits, wait_count, step);
    left -= step;
    if (ready > 0 || left == 0) return ready;
  }
}

platform::LinkBackend both_backend() {
  platform::LinkBackend backend = net;
  backend.poll = poll_both;
  return backend;
}
const platform::LinkBackend kBothLink = both_backend();

// Renders frames like `render` and `view`.
void share_frames(FuzzInput* input, std::uint8_t flags, std::uint64_t latency_ns) {
  Renderer* renderer = fuzz_renderer();
  ClientOptions o;
  o.has_scene = flags & 1;
  o.format = flags & 2 ? WireFormat::rgb888 : WireFormat::rgb565;
  o.coarse_after_ns = flags & 16 ? 1 : 0;
  Settings settings = renderer->settings;
  settings.indirect = flags & 32 ? indirect_choice(Effect::instant_radiosity) : IndirectChoice::automatic;
  CHECK(change_settings(renderer, settings).ok);
  const SplitKind by_effect = flags & 64 ? SplitKind::automatic : SplitKind::effect;
  o.light.split = flags & 32 ? by_effect : SplitKind::rows;
  o.light.indirect = settings.indirect;
  o.pace.ns_per_pixel = kDeviceNs;
  o.silence_timeout_ns = o.prepare_timeout_ns = o.connect_timeout_ns = 300 * kMs + 2 * latency_ns;
  o.retry_ns_min = kMs, o.retry_ns_max = 20 * kMs;
  static Bytes memory;
  memory.resize(client_need(renderer->settings, o.format, 1, o.light) + kArenaAlignment);
  Arena arena = make_arena("client", memory.data(), memory.size());
  Client client;
  platform::LinkAddress address;
  platform::Error error;
  CHECK(net.resolve("127.0.0.1:4000", &address, &error));
  CHECK(make_client(o, renderer->settings, fuzz_store().scenes[0].hash, peer->link, &address, 1, &arena, &client).ok);
  const int frames = o.light.split == SplitKind::automatic ? kChosenFrames : kFrames;
  for (int frame = 0; frame < frames || (input->left > 0 && frame < kFramesMax); ++frame) {
    CHECK(begin_frame(renderer, &client, 0.25 * (frame % 4)).ok);
    const std::uint64_t begin = client_now_ns(client) - peer->stalled_ns;
    while (!advance_frame(renderer, &client, client_now_ns(client) + 5 * kMs, nullptr)) {
      const std::uint64_t took = client_now_ns(client) - peer->stalled_ns - begin;
      if (!o.has_scene && took > 500 * kMs) break;
      CHECK_LT(took, 20'000 * kMs);
    }
    fuzz_counts.frames += has_all_rows(client), fuzz_counts.coarse += client.coarse.shown;
    fuzz_counts.lit += client.share.has_light, fuzz_counts.by_effect += client.share.by_effect;
    fuzz_counts.server_rows += client.share.server_rows[0];
    for (int i = 0; i < 4; ++i) advance_client(&client, 5 * kMs + latency_ns);
  }
  close_client(&client);
}

// Inquiries before the first frame.
void inquire() {
  InquiryOptions o;
  o.connect_timeout_ns = o.silence_timeout_ns = 300 * kMs;
  o.answer_timeout_ns = 2'000 * kMs;
  platform::LinkAddress address;
  platform::Error error;
  CHECK(net.resolve("127.0.0.1:4000", &address, &error));
  Inquiry inquiry;
  std::vector<SceneEntry> entries;
  if (!open_inquiry(o, peer->link, address, &inquiry).ok || !list_scenes(&inquiry, &entries).ok) return;
  const SceneEntry* entry = find_entry(entries, "cube");
  if (!entry || entry->byte_count > (1u << 20)) return;
  Bytes bytes(entry->byte_count);
  if (fetch_scene(&inquiry, *entry, bytes.data(), bytes.size(), nullptr).ok) ++fuzz_counts.scenes;
  ViewQuery query;
  query.scene = entry->hash;
  query.settings.width = kFuzzWidth, query.settings.height = kFuzzHeight;
  ViewEntry view;
  fuzz_counts.messages += ask_view(&inquiry, query, &view).ok;
}

}  // namespace

void fuzz_client(const std::uint8_t* bytes, std::size_t byte_count) {
  FuzzInput input = {bytes, byte_count};
  std::uint8_t flags = input.byte();
  platform::NullLinkSettings line;
  line.clock_step_ns = 100;
  line.latency_ns = kLatenciesNs[(flags >> 2 & 1) + (flags >> 6 & 2)];
  FuzzLink link(line);
  platform::Error error;
  Peer here;
  here.input = &input, here.link = link.link;
  here.listener = net.listen(link.link, link.address, &error);
  CHECK_GE(here.listener, 0);
  peer = &here;
  link.link->backend = &kBothLink;
  flags & 8 ? inquire() : share_frames(&input, flags, line.latency_ns);
  link.link->backend = &net;
  peer = nullptr;
}

}  // namespace pocketray
