#include "support/scripted_client.h"

#include <chrono>
#include <cstring>

#include "base/seal.h"
#include "engine/frame.h"
#include "present/pack.h"

namespace pocketray {
namespace {

std::uint64_t steady_ns() {
  return static_cast<std::uint64_t>(std::chrono::steady_clock::now().time_since_epoch().count());
}

constexpr int kStreams = 128;

}  // namespace

const SceneStore& builtin_store() {
  static SceneStore store;
  if (store.scenes.empty()) REQUIRE(open_scene_store(SceneStoreOptions(), &store).ok);
  return store;
}

ContentHash builtin_hash(const std::string& name) {
  for (const StoredScene& stored : builtin_store().scenes)
    if (name == stored.name) return stored.hash;
  FAIL("no such scene");
  return ContentHash();
}

ServerRig::ServerRig(const ServerOptions& given, const platform::NullLinkSettings& settings,
                     const platform::LinkBackend& backend, const SceneStore& store) {
  bool simulated = &backend == &platform::kNullLink;
  platform::LinkOptions link_options;
  link_options.memory_bytes = simulated ? null_link_need(kStreams, settings) : backend.need(kStreams);
  memory.resize(link_options.memory_bytes / sizeof(std::max_align_t) + 1);
  link_options.memory = memory.data();
  link_options.stream_count_max = kStreams;
  link_options.now_ns = steady_ns;
  platform::Error error;
  net = &backend;
  link = simulated ? null_link_open(link_options, settings, &error) : backend.open(link_options, &error);
  REQUIRE_MESSAGE(link != nullptr, error.text);
  REQUIRE(net->resolve(":0", &address, &error));
  ServerOptions options = given;
  options.log = [](void* context, const char* line) {
    unseal_memory();
    static_cast<ServerRig*>(context)->log.push_back(line);
    seal_memory();
  };
  options.log_context = this;
  Status status = open_server(options, store, link, address, &server);
  REQUIRE_MESSAGE(status.ok, status.message);
  REQUIRE(net->resolve(server_address(*server), &address, &error));
}

ServerRig::~ServerRig() {
  close();
  net->close_all(link);
}

void ServerRig::close() {
  close_server(server);
  unseal_memory();
  server = nullptr;
}

void ServerRig::step(std::uint64_t timeout_ns) {
  seal_memory();
  step_server(server, timeout_ns);
  unseal_memory();
}

void ServerRig::run_until(const std::function<bool()>& done, std::uint64_t timeout_ns) {
  platform::LinkTimer timer = platform::link_timer(now(), timeout_ns);
  while (!done()) {
    REQUIRE(platform::link_timer_left(&timer, now()) > 0);
    step();
  }
}

bool ServerRig::logged(const std::string& text) const {
  for (const std::string& line : log)
    if (line.find(text) != std::string::npos) return true;
  return false;
}

ScriptedClient::ScriptedClient(ServerRig* rig_, bool says_hello) : rig(rig_) {
  platform::Error error;
  stream = rig->net->connect(rig->link, rig->address, 5000 * kMs, &error);
  REQUIRE_MESSAGE(stream >= 0, error.text);
  rig->run_until([&] { return rig->net->connected(rig->link, stream, &error) == platform::LinkResult::done; });
  if (says_hello) send_hello();
}

ScriptedClient::~ScriptedClient() { rig->net->close(rig->link, stream); }

void ScriptedClient::send_bytes(const std::vector<std::uint8_t>& bytes) {
  for (std::size_t sent = 0; sent < bytes.size();) {
    std::size_t count = 0;
    platform::Error error;
    platform::LinkResult result =
        rig->net->write(rig->link, stream, bytes.data() + sent, bytes.size() - sent, &count, &error);
    if (result == platform::LinkResult::failed) return;
    sent += count;
    if (count == 0) rig->step();
  }
}

void ScriptedClient::send(const Message& message) { send_bytes(bytes_of(message)); }
void ScriptedClient::send_hello() { send(hello_message()); }

void ScriptedClient::request(const FrameRequest& request, MessageType type) {
  CodecShape shape = {request.settings.width, request.settings.height, 1, request.format};
  if (!decoder || decoder->state.shape.width != shape.width || decoder->state.shape.height != shape.height ||
      decoder->state.shape.format != shape.format) {
    shape.chunk_rows_max = std::min(shape.height, std::max(1u, 20000 / shape.width));
    block.assign(row_decoder_need(shape) + kArenaAlignment, 0);
    arena = make_arena("decoder", block.data(), block.size());
    make_row_decoder(shape, &arena, &decoder);
  }
  frame = request.frame;
  rows_come = 0;
  chunks.clear();
  Message message;
  message.type = type;
  message.frame_request = request;
  send(message);
}

void ScriptedClient::poll() {
  if (!reads || closed) return;
  for (;;) {
    std::uint8_t part[4096];
    std::size_t count = 0;
    platform::Error error;
    platform::LinkResult result = rig->net->read(rig->link, stream, part, sizeof part, &count, &error);
    input.insert(input.end(), part, part + count);
    received_bytes += count;
    if (result == platform::LinkResult::done) continue;
    closed = result != platform::LinkResult::later;
    break;
  }
  std::size_t begin = 0;
  for (;;) {
    auto come = std::make_unique<Received>();
    Decoded decoded = decode_message(input.data() + begin, input.size() - begin, kMessageBytesMax, &come->message);
    REQUIRE(decoded.state != DecodeState::malformed);
    if (decoded.state == DecodeState::need_more) break;
    if (come->message.type == MessageType::row_chunk) {
      RowChunk chunk = come->message.row_chunk;
      chunk.frame = frame_of(chunk.frame, frame);
      price = chunk.price = chunk.price != 0 ? chunk.price : price;
      REQUIRE(take_chunk_number(&chunk, chunk_count++));
      REQUIRE(decode_rows(decoder, chunk));
      if (chunk.frame == frame) {
        chunks.push_back(chunk);
        rows_come += chunk.row_count;
      }
    } else {
      come->bytes.assign(input.begin() + static_cast<std::ptrdiff_t>(begin),
                         input.begin() + static_cast<std::ptrdiff_t>(begin + decoded.byte_count));
      decode_message(come->bytes.data(), come->bytes.size(), kMessageBytesMax, &come->message);
      received.push_back(std::move(come));
    }
    begin += decoded.byte_count;
  }
  input.erase(input.begin(), input.begin() + static_cast<std::ptrdiff_t>(begin));
}

bool ScriptedClient::has(MessageType type) const {
  for (const auto& come : received)
    if (come->message.type == type) return true;
  return false;
}

bool ScriptedClient::has_error(WireError code) const {
  for (const auto& come : received)
    if (come->message.type == MessageType::error && come->message.error.code == code) return true;
  return false;
}

std::unique_ptr<Received> ScriptedClient::wait_for(MessageType type, std::uint64_t timeout_ns) {
  rig->run_until([&] { return poll(), has(type) || closed; }, timeout_ns);
  for (auto it = received.begin(); it != received.end(); ++it)
    if ((*it)->message.type == type) {
      std::unique_ptr<Received> found = std::move(*it);
      received.erase(it);
      return found;
    }
  FAIL("the connection ended before the message came");
  return nullptr;
}

void ScriptedClient::wait_for_rows(std::uint32_t row_count) {
  rig->run_until([&] { return poll(), rows_come >= row_count || closed || has(MessageType::error); });
  REQUIRE(rows_come == row_count);
}

std::vector<std::uint8_t> ScriptedClient::picture() const {
  const CodecShape& shape = decoder->state.shape;
  std::vector<std::uint8_t> bytes;
  for (std::uint32_t row = 0; row < shape.height; ++row) {
    const std::uint8_t* pixels = picture_row(decoder->state, row);
    bytes.insert(bytes.end(), pixels, pixels + shape.width * pixel_bytes(shape.format));
  }
  return bytes;
}

Message hello_message() {
  Message message;
  message.type = MessageType::hello;
  message.hello.image_side_max = kImageSideMax;
  message.hello.message_bytes_max = kMessageBytesMax;
  return message;
}

FrameRequest frame_request(const std::string& scene, std::uint32_t frame, std::uint32_t width, std::uint32_t height) {
  FrameRequest request;
  request.frame = frame;
  request.scene = builtin_hash(scene);
  request.settings.width = width;
  request.settings.height = height;
  request.row_end = static_cast<std::uint16_t>(height);
  request.chunk_rows = 8;
  return request;
}

std::vector<std::uint8_t> squares_of(const std::vector<std::uint8_t>& picture, const FrameRequest& request) {
  const std::uint32_t bytes = pixel_bytes(request.format), width = request.settings.width;
  std::vector<std::uint8_t> squares;
  for (std::uint32_t y = 0; y < request.settings.height; y += kCoarseSide)
    for (std::uint32_t x = 0; x < width; x += kCoarseSide) {
      const auto at = picture.begin() + static_cast<std::ptrdiff_t>((std::size_t(y) * width + x) * bytes);
      squares.insert(squares.end(), at, at + bytes);
    }
  return squares;
}

std::vector<std::uint8_t> rendered_here(const FrameRequest& request, const SceneStore& store) {
  const StoredScene* stored = find_scene(store, request.scene);
  REQUIRE(stored != nullptr);
  Scene scene = stored->scene;
  scene.accel = {};
  std::vector<std::uint8_t> block(request.settings.memory_bytes);
  Renderer renderer, *r = &renderer;
  start_renderer(block.data(), block.size(), request.settings, r);
  r->scene = scene;
  r->view.camera_index = request.camera_index;
  r->view.animation = request.animation;
  REQUIRE(plan_renderer(r, SceneStorage(), 0).ok);
  REQUIRE(build_renderer(r).ok);
  if (request.camera_stated) REQUIRE(set_camera(r, request.camera).ok);
  if (request.exposure > 0) r->view.exposure = request.exposure;
  REQUIRE(render_frame(r, request.seconds).ok);
  int width = static_cast<int>(request.settings.width), height = static_cast<int>(request.settings.height);
  int line_bytes = width * static_cast<int>(pixel_bytes(request.format));
  std::vector<std::uint8_t> pixels(static_cast<std::size_t>(line_bytes) * request.settings.height);
  pack_rows(r->image.data, width, height, 0, height, display_of(*r),
            request.format == WireFormat::rgb565 ? kRgb565 : kRgb888, Rotation::none, request.dither, pixels.data(),
            line_bytes);
  return pixels;
}

std::vector<std::uint8_t> bytes_of(const Message& message) {
  std::vector<std::uint8_t> bytes(message_bytes(message));
  encode_message(message, bytes.data());
  return bytes;
}

}  // namespace pocketray
