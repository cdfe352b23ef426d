#include "hostile_server.h"

#include <doctest/doctest.h>

#include <algorithm>

#include "platform/null/net/null_link.h"
#include "support/scripted_client.h"
#include "wire/light_coder.h"

namespace pocketray {
namespace {

constexpr std::size_t kFloodBytes = 1024;         // that a flood keeps queued
constexpr std::size_t kQueuedBytesMax = 1 << 12;  // unread answers, after which it reads no more
constexpr int kRefillsMax = 2;                    // between two polls of the link
const platform::LinkBackend& net = platform::kNullLink;

using Connection = HostileConnection;

void say(Connection* c, const Message& message) {
  std::vector<std::uint8_t> bytes = bytes_of(message);
  c->out.insert(c->out.end(), bytes.begin(), bytes.end());
}

std::uint32_t price(HostileServer* server) {
  switch (server->settings.malice) {
    case Malice::free_pixels:
      return 0;
    case Malice::dear_pixels:
      return ~0u;
    case Malice::random_prices:
      return static_cast<std::uint32_t>(server->random.scale(1, 4e9));
    default:
      return static_cast<std::uint32_t>(std::min(4e9, 1e3 * server->settings.ns_per_pixel));
  }
}

std::uint16_t stated_price(HostileServer* server) {
  switch (server->settings.malice) {
    case Malice::dear_pixels:
      return UINT16_MAX;
    case Malice::random_prices:
      return static_cast<std::uint16_t>(kPriceUnit + server->random.below(UINT16_MAX - kPriceUnit + 1));
    default:
      return kPriceUnit;
  }
}

void say_hello(HostileServer* server, Connection* c) {
  Message message = hello_message();
  message.hello.message_bytes_max = 512;
  message.hello.price = stated_price(server);
  if (server->settings.malice == Malice::wrong_hello) {
    std::uint64_t kind = server->random.below(3);
    if (kind == 0) message.hello.version = static_cast<std::uint16_t>(server->random.below(65536));
    if (kind == 1) message.hello.image_side_max = static_cast<std::uint16_t>(server->random.below(8));
    if (kind == 2) message.hello.message_bytes_max = static_cast<std::uint32_t>(server->random.below(16));
  }
  say(c, message);
}

void say_entry(HostileServer* server, Connection* c, const ContentHash& hash) {
  FaultRandom* random = &server->random;
  Message message;
  message.type = MessageType::scene_entry;
  SceneEntry* entry = &message.scene_entry;
  *entry = SceneEntry();
  entry->hash = hash, entry->byte_count = 1000, entry->count = 1, entry->triangle_count = 12;
  if (server->settings.malice == Malice::wrong_scene) {
    std::uint64_t kind = random->below(4);
    if (kind == 0) entry->hash.low ^= 1u << random->below(32);
    if (kind == 1) entry->byte_count = 0;
    if (kind == 2) entry->byte_count = ~std::uint64_t(0), entry->triangle_count = ~0u;
    if (kind == 3) entry->index = entry->count = 65535;
  }
  say(c, message);
}

void say_pong(HostileServer* server, Connection* c, std::uint32_t id, std::uint32_t byte_count) {
  static const std::uint8_t zeros[kPingBytesMax] = {};
  Message message;
  message.type = MessageType::pong;
  message.pong.id = id, message.pong.pixel_ps = price(server);
  message.pong.price = stated_price(server);
  message.pong.bytes = {zeros, byte_count};
  say(c, message);
}

// Of the right size or another.
void say_coarse(HostileServer* server, Connection* c) {
  const FrameRequest& q = c->request;
  std::uint32_t byte_count = coarse_bytes(q.settings.width, q.settings.height, q.format);
  if (server->random.below(4) == 0) byte_count += static_cast<std::uint32_t>(server->random.below(3)) - 1;
  const std::vector<std::uint8_t> pixels(byte_count, static_cast<std::uint8_t>(server->random.below(256)));
  Message message;
  message.type = MessageType::coarse_picture;
  message.coarse_picture.frame = q.frame - static_cast<std::uint32_t>(server->random.below(2));
  message.coarse_picture.pixels = {pixels.data(), byte_count};
  say(c, message);
}

// Of the request, or of one of the last.
void say_light(HostileServer* server, Connection* c, std::uint32_t frame) {
  const FrameRequest& q = c->request;
  const std::uint32_t columns = light_map_side(q.settings.width, q.light_pitch),
                      rows = light_map_side(q.settings.height, q.light_pitch);
  std::vector<Vec3> light(std::size_t(columns) * rows, Vec3{0.5f, 0.25f, 0.125f});
  std::vector<std::uint8_t> bytes(light_bytes_max(light.size()));
  Message message;
  message.type = MessageType::light_map;
  message.light_map.frame = frame, message.light_map.light_ps = price(server);
  message.light_map.price = stated_price(server);
  const std::size_t byte_count = encode_light(light.data(), columns, rows, 0, bytes.data());
  message.light_map.bytes = {bytes.data(), static_cast<std::uint32_t>(byte_count)};
  say(c, message);
}

void say_error(HostileServer* server, Connection* c) {
  Message message;
  message.type = MessageType::error;
  message.error.code = static_cast<WireError>(1 + server->random.below(7));
  message.error.frame = server->random.below(2) ? c->request.frame : 0;
  say(c, message);
}

// Sends rows of a frame, with inverted pixels if they are to be wrong.
void say_rows(HostileServer* server, Connection* c, std::uint32_t frame, std::uint32_t begin, std::uint32_t end,
              bool wrong) {
  const FrameRequest& q = c->request;
  CodecShape shape = {q.settings.width, q.settings.height, std::min(32u, q.settings.height), q.format};
  if (!c->encoder) {
    c->block.assign(row_encoder_need(shape) + kArenaAlignment, 0);
    Arena arena = make_arena("encoder", c->block.data(), c->block.size());
    make_row_encoder(shape, &arena, &c->encoder);
  }
  std::size_t line_bytes = std::size_t(shape.width) * pixel_bytes(shape.format);
  const std::vector<std::uint8_t>& picture = server->settings.picture(q.seconds);
  std::vector<std::uint8_t> rows(picture.begin() + static_cast<std::ptrdiff_t>(begin * line_bytes),
                                 picture.begin() + static_cast<std::ptrdiff_t>(end * line_bytes));
  if (wrong)
    for (std::uint8_t& byte : rows) byte = static_cast<std::uint8_t>(byte ^ (1 + server->random.below(255)));
  std::vector<std::uint8_t> encoded(encoded_bytes_max(shape, end - begin));
  Message message;
  message.type = MessageType::row_chunk;
  RowChunk* chunk = &message.row_chunk;
  chunk->frame = frame, chunk->pixel_ps = price(server), chunk->traced = 255;
  chunk->price = stated_price(server);
  chunk->row_begin = static_cast<std::uint16_t>(begin), chunk->row_count = static_cast<std::uint16_t>(end - begin);
  std::uint32_t count =
      encode_rows(c->encoder, frame, begin, end - begin, rows.data(), q.coding, encoded.data(), &chunk->encoding);
  add_chunk_number(chunk, c->chunk_count++);
  chunk->bytes = {encoded.data(), count};
  say(c, message);
}

std::uint64_t chunk_ns(const HostileServer& server, const Connection& c, std::uint32_t row_count) {
  if (server.settings.malice == Malice::dawdles) return server.settings.silence_ns * 9 / 10;
  return static_cast<std::uint64_t>(server.settings.ns_per_pixel * c.request.settings.width * row_count);
}

void plan_chunk(HostileServer* server, Connection* c) {
  const FrameRequest& q = c->request;
  c->due_ns = ~std::uint64_t(0);
  if (!has_rows(c->due) || c->holds_rows) return;
  c->chunk_rows = std::min(next_chunk_rows(q, c->due), std::min(32u, q.settings.height));
  c->due_ns = net.now_ns(server->link) + chunk_ns(*server, *c, c->chunk_rows);
}

void send_due_rows(HostileServer* server, Connection* c) {
  if (net.now_ns(server->link) < c->due_ns) return;
  std::uint32_t end = c->due.row_end, begin = end - c->chunk_rows, height = c->request.settings.height;
  Malice malice = server->settings.malice;
  bool lies = malice == Malice::wrong_pixels && c->request.frame > server->honest_frames;
  say_rows(server, c, c->request.frame, begin, end, lies);
  if (malice == Malice::repeated_rows) say_rows(server, c, c->request.frame, begin, end, true);
  if (malice == Malice::foreign_rows) {
    if (c->request.row_begin > 0) say_rows(server, c, c->request.frame, 0, 1, true);
    if (c->request.row_end < height) say_rows(server, c, c->request.frame, height - 1, height, true);
  }
  pass_rows(c->request, c->chunk_rows, &c->due);
  plan_chunk(server, c);
}

void take_request(HostileServer* server, Connection* c, const FrameRequest& request, bool is_change) {
  const RowSequence held = c->due;
  if (is_change)
    take_change(request, &c->request);
  else
    c->request = request;
  const FrameRequest& q = c->request;
  const Malice malice = server->settings.malice;
  c->holds_rows = malice == Malice::held_rows && server->random.below(2) != 0;
  if (malice == Malice::held_rows && q.row_begin == q.row_end && has_rows(held))
    say_rows(server, c, q.frame, held.row_end - 1, held.row_end, false);
  if (malice == Malice::other_light && q.light_pitch > 0)
    say_light(server, c, q.frame - static_cast<std::uint32_t>(server->random.below(3)));
  const bool has_light = malice != Malice::no_light && (malice != Malice::other_light || server->random.below(2));
  if (q.light_pitch > 0 && has_light) say_light(server, c, q.frame);
  c->due = first_rows(q);
  if (c->request.coarse_first && server->settings.malice == Malice::coarse_pictures) say_coarse(server, c);
  plan_chunk(server, c);
}

// Sends unrequested messages, as many as fit.
void flood(HostileServer* server, Connection* c) {
  FaultRandom* random = &server->random;
  Malice malice = server->settings.malice;
  while (c->ready && c->out.size() < kFloodBytes) {
    if (malice == Malice::pongs) {
      say_pong(server, c, c->ping_id + static_cast<std::uint32_t>(random->below(3)), 0);
    } else if (malice == Malice::entries) {
      say_entry(server, c, c->request.scene);
    } else if (malice == Malice::errors) {
      say_error(server, c);
    } else if (malice == Malice::old_rows && c->request.frame > 1 && server->old_rows_left-- > 0) {
      std::uint32_t row = static_cast<std::uint32_t>(random->below(c->request.settings.height));
      say_rows(server, c, c->request.frame - 1, row, row + 1, random->below(2));
    } else if (malice == Malice::coarse_pictures && server->random.below(64) == 0) {
      say_coarse(server, c);
    } else if (malice == Malice::device_messages) {
      Message message;
      message.type = random->below(2) ? MessageType::cancel : MessageType::scene_list;
      say(c, message);
    } else if (malice == Malice::junk) {
      for (int i = 0; i < 64; ++i) c->out.push_back(static_cast<std::uint8_t>(random->below(256)));
    } else {
      return;
    }
  }
}

// False if it dies.
bool flap(HostileServer* server, Connection* c) {
  if (server->settings.malice != Malice::flaps || c->patience-- > 0) return true;
  std::uint64_t kind = server->random.below(3);
  if (kind == 0) return false;
  if (kind == 1) say_error(server, c);
  c->silent = true;
  return true;
}

void answer(HostileServer* server, Connection* c, const Message& message) {
  Malice malice = server->settings.malice;
  switch (message.type) {
    case MessageType::scene_query:
      return say_entry(server, c, message.scene_query.hash);
    case MessageType::ping:
      c->ping_id = message.ping.id;
      // Without the payload the link seems immeasurably fast.
      return say_pong(server, c, message.ping.id, malice == Malice::quick_pongs ? 0 : message.ping.reply_bytes);
    case MessageType::frame_request:
    case MessageType::frame_change:
      c->ready = true;
      return take_request(server, c, message.frame_request, message.type == MessageType::frame_change);
    case MessageType::cancel:
      if (!c->holds_rows) c->due = RowSequence();
      c->due_ns = ~std::uint64_t(0);
      return;
    default:
      return;
  }
}

// False if the connection has ended.
bool step_connection(HostileServer* server, Connection* c) {
  platform::Error error;
  std::uint8_t part[1024];
  std::size_t count = 0;
  platform::LinkResult result = platform::LinkResult::later;
  while (c->out.size() < kQueuedBytesMax &&
         (result = net.read(server->link, c->stream, part, sizeof part, &count, &error)) == platform::LinkResult::done)
    c->in.insert(c->in.end(), part, part + count);
  if (result != platform::LinkResult::later) return false;
  std::size_t begin = 0;
  while (!c->silent) {
    Message message;
    Decoded decoded = decode_message(c->in.data() + begin, c->in.size() - begin, 512, &message);
    if (decoded.state == DecodeState::malformed) return false;  // from a line that flips bits
    if (decoded.state != DecodeState::message) break;
    begin += decoded.byte_count;
    if (!flap(server, c)) return false;
    if (!c->silent) answer(server, c, message);
  }
  c->in.erase(c->in.begin(), c->in.begin() + static_cast<std::ptrdiff_t>(begin));
  if (!c->silent) send_due_rows(server, c), flood(server, c);
  // Writes to a departed peer always succeed.
  for (int refills = 0; !c->out.empty() && refills < kRefillsMax; ++refills) {
    result = net.write(server->link, c->stream, c->out.data(), c->out.size(), &count, &error);
    if (result == platform::LinkResult::failed) return false;
    if (count == 0) break;
    c->out.erase(c->out.begin(), c->out.begin() + static_cast<std::ptrdiff_t>(count));
    if (!c->silent) flood(server, c);
  }
  return true;
}

}  // namespace

std::unique_ptr<HostileServer> open_hostile_server(platform::Link* link, const platform::LinkAddress& address,
                                                   const HostileSettings& settings) {
  auto server = std::make_unique<HostileServer>();
  platform::Error error;
  server->settings = settings, server->link = link, server->random.state = settings.seed;
  server->honest_frames = static_cast<std::uint32_t>(server->random.below(2) * server->random.below(8));
  server->listener = net.listen(link, address, &error);
  REQUIRE_MESSAGE(server->listener >= 0, error.text);
  return server;
}

void step_hostile_server(HostileServer* server) {
  int stream;
  platform::Error error;
  while (net.accept(server->link, server->listener, &stream, &error) == platform::LinkResult::done) {
    server->connections.push_back(std::make_unique<Connection>());
    Connection* c = server->connections.back().get();
    c->stream = stream;
    c->patience = static_cast<int>(server->random.below(16));
    say_hello(server, c);
  }
  auto& all = server->connections;
  auto over = [&](const std::unique_ptr<Connection>& c) {
    if (step_connection(server, c.get())) return false;
    net.close(server->link, c->stream);
    return true;
  };
  all.erase(std::remove_if(all.begin(), all.end(), over), all.end());
}

std::uint64_t hostile_due_ns(const HostileServer& server) {
  std::uint64_t now = net.now_ns(server.link), due = ~std::uint64_t(0);
  // A flood must wait for room at times, but not with a departed peer.
  for (const auto& c : server.connections)
    if (!c->out.empty()) due = std::min(due, kMs);
  for (const auto& c : server.connections)
    if (c->due_ns != ~std::uint64_t(0)) due = std::min(due, c->due_ns > now ? c->due_ns - now : 0);
  return due;
}

void add_hostile_waits(const HostileServer& server, std::vector<platform::LinkWait>* waits) {
  platform::LinkWait wait = {};
  wait.stream = server.listener, wait.want_read = true;
  waits->push_back(wait);
  for (const auto& c : server.connections) {
    wait.stream = c->stream, wait.want_read = c->out.size() < kQueuedBytesMax;
    waits->push_back(wait);
  }
}

void close_hostile_server(HostileServer* server) {
  for (const auto& c : server->connections) net.close(server->link, c->stream);
  server->connections.clear();
  net.close(server->link, server->listener);
}

}  // namespace pocketray
