#include "wire/message.h"

#include <zlib.h>

#include <cstring>

#include "base/check.h"
#include "effect/setting_list.h"
#include "wire/message_io.h"
#include "wire/row_sequence.h"

namespace pocketray {
namespace {

constexpr std::uint32_t kMagic = 0x59415250;  // "PRAY"
constexpr std::uint32_t kChecksumAt = 4;

// 0 means the scene's own exposure.
template <class Io>
void own_or_exposure(Io& io, float* value) {
  raw_real(io, value);
  io.require(*value == 0 || within(Quantity::exposure, *value));
}
template <class Io>
void hash(Io& io, ContentHash* h) {
  number(io, &h->low), number(io, &h->high);
}
template <class Io>
void effects(Io& io, EffectMask* mask) {
  number(io, mask);
  io.require((*mask & ~kAllEffects) == 0);
}
template <class Io>
void point(Io& io, Vec3* v) {
  for (float* x : {&v->x, &v->y, &v->z}) real(io, x, Quantity::coordinate);
}

template <class Io>
void fields(Io& io, Hello* m) {
  std::uint32_t magic = kMagic;
  number(io, &magic);
  io.require(magic == kMagic);
  number(io, &m->version);
  number(io, &m->image_side_max), number(io, &m->message_bytes_max), number(io, &m->scene_bytes_max);
  count(io, &m->price, Quantity::price);
}
template <class Io>
void fields(Io& io, SceneList* m) {
  number(io, &m->index);
}
template <class Io>
void fields(Io& io, SceneQuery* m) {
  hash(io, &m->hash);
}
template <class Io>
void fields(Io& io, SceneEntry* m) {
  hash(io, &m->hash);
  number(io, &m->byte_count), number(io, &m->index), number(io, &m->count), number(io, &m->triangle_count);
  io.text(m->name);
}
template <class Io>
void fields(Io& io, SceneFetch* m) {
  hash(io, &m->hash);
  number(io, &m->offset), number(io, &m->byte_count);
  io.require(m->byte_count <= kPieceBytesMax && m->offset <= ~std::uint64_t(0) - kPieceBytesMax);
}
template <class Io>
void fields(Io& io, ScenePiece* m) {
  hash(io, &m->hash);
  number(io, &m->offset);
  io.require(m->offset <= ~std::uint64_t(0) - kPieceBytesMax);
  io.tail(&m->bytes);
}

template <class Io>
void fields(Io& io, Camera* c) {
  point(io, &c->eye), point(io, &c->target), point(io, &c->up);
  real(io, &c->vertical_fov, Quantity::field_of_view), real(io, &c->vertical_extent, Quantity::vertical_extent);
  choice(io, &c->projection, Projection::orthographic);
}

// Counts and choices are integers of the row's size.
template <class Io>
void setting(Io& io, const SettingRow& row, Settings* settings) {
  if (row.wire_bytes == 0) return;
  double value = row.field.get(*settings);
  if (row.field.kind == SettingKind::real) {
    float real = static_cast<float>(value);
    raw_real(io, &real);
    value = static_cast<double>(real);
  } else {
    std::uint64_t bits = static_cast<std::uint64_t>(value);
    io.integer(&bits, row.wire_bytes);
    value = static_cast<double>(bits);
  }
  bool valid = within_setting(row, value);
  io.require(valid);
  if (valid) row.field.set(settings, value);
}

// Settings that change pixels.
constexpr std::uint32_t kSettingsBytes = 2 * 2 + setting_wire_bytes() + 2 * sizeof(EffectMask) + 1 + 2;
template <class Io>
void fields(Io& io, Settings* settings) {
  count(io, &settings->width, Quantity::width, 2), count(io, &settings->height, Quantity::height, 2);
  for (const SettingRow& row : kSettingList) setting(io, row, settings);
  effects(io, &settings->forced_on), effects(io, &settings->forced_off);
  choice(io, &settings->tone, Tone::film);
  count(io, &settings->texture_side_max, Quantity::texture_side, 2);
}

// The rows and their order.
template <class Io>
void row_fields(Io& io, FrameRequest* m, std::uint32_t height) {
  number(io, &m->row_begin), number(io, &m->row_end);
  io.require(m->row_begin <= m->row_end && m->row_end <= height);
  io.length_of(&m->run_count);
  if (m->run_count > kRunCountMax) return;
  for (std::uint32_t i = 0; i < m->run_count; ++i) number(io, &m->runs[i].row_count), number(io, &m->runs[i].place);
  io.require(is_order(*m));
}

template <class Io>
void fields(Io& io, FrameRequest* m) {
  number(io, &m->frame), hash(io, &m->scene), real(io, &m->seconds, Quantity::seconds), number(io, &m->animation);
  choice(io, &m->camera_stated, true);
  count(io, &m->camera_index, Quantity::camera_index);
  fields(io, &m->camera);
  fields(io, &m->settings);
  own_or_exposure(io, &m->exposure);
  choice(io, &m->dither, true);
  choice(io, &m->format, WireFormat::rgb888);
  number(io, &m->chunk_rows);
  io.require(m->chunk_rows >= 1);
  choice(io, &m->coding, RowCoding::near_lossless);
  choice(io, &m->coarse_first, true);
  number(io, &m->light_pitch);
  io.require(m->light_pitch == 0 || (m->light_pitch >= kLightPitchLow && m->light_pitch <= kLightPitchHigh));
  row_fields(io, m, m->settings.height);
  io.require(asks_for_something(*m));
}

// Fields that change from frame to frame.
template <class Io>
void change_fields(Io& io, FrameRequest* m) {
  number(io, &m->frame), real(io, &m->seconds, Quantity::seconds);
  point(io, &m->camera.eye), point(io, &m->camera.target);
  choice(io, &m->coarse_first, true);
  row_fields(io, m, kImageSideMax);
}

template <class Io>
void fields(Io& io, RowChunk* m) {
  number(io, &m->frame, 2), number(io, &m->row_begin), number(io, &m->row_count, 1);
  io.require(m->row_count >= 1 && m->row_begin <= kImageSideMax - m->row_count);
  rounded(io, &m->pixel_ps), number(io, &m->traced);
  const int stated = (m->price != 0 ? kEncodingPrice : 0) | (m->prepare_ns != 0 ? kEncodingPreparation : 0);
  m->encoding = static_cast<std::uint8_t>(m->encoding | stated);
  number(io, &m->encoding);
  auto follows = [&](std::uint8_t bit) {
    const bool wanted = (m->encoding & bit) != 0, there = io.has(2);
    io.require(there || !wanted);
    return wanted && there;
  };
  follows(kEncodingPrice) ? count(io, &m->price, Quantity::price) : void(m->price = 0);
  const bool states_preparation = follows(kEncodingPreparation);
  states_preparation ? rounded(io, &m->prepare_ns) : void(m->prepare_ns = 0);
  io.require(states_preparation == (m->prepare_ns > 0));
  m->encoding = static_cast<std::uint8_t>(m->encoding & ~(kEncodingPrice | kEncodingPreparation));
  io.tail(&m->bytes);
}
template <class Io>
void fields(Io& io, CoarsePicture* m) {
  number(io, &m->frame, 2);
  io.tail(&m->pixels);
}
template <class Io>
void fields(Io& io, LightMapMessage* m) {
  number(io, &m->frame, 2), rounded(io, &m->light_ps);
  count(io, &m->price, Quantity::price);
  io.tail(&m->bytes);
}
template <class Io>
void fields(Io& io, Cancel* m) {
  number(io, &m->frame);
}
template <class Io>
void fields(Io& io, ErrorReport* m) {
  choice(io, &m->code, WireError::closing);
  io.require(m->code >= WireError::wrong_version);
  number(io, &m->frame);
}
template <class Io>
void fields(Io& io, Ping* m) {
  number(io, &m->id), number(io, &m->reply_bytes);
  io.require(m->reply_bytes <= kPingBytesMax);
}
template <class Io>
void fields(Io& io, Pong* m) {
  number(io, &m->id), number(io, &m->pixel_ps), count(io, &m->price, Quantity::price);
  io.tail(&m->bytes);
}
template <class Io>
void fields(Io& io, ViewQuery* m) {
  hash(io, &m->scene);
  io.text(m->animation);
  choice(io, &m->camera_stated, true);
  count(io, &m->camera_index, Quantity::camera_index);
  fields(io, &m->camera);
  fields(io, &m->settings);
  choice(io, &m->measure_exposure, true);
}
template <class Io>
void fields(Io& io, ViewEntry* m) {
  hash(io, &m->scene);
  number(io, &m->animation);
  for (double* x : {&m->origin.x, &m->origin.y, &m->origin.z}) real(io, x, Quantity::coordinate);
  fields(io, &m->camera);
  real(io, &m->exposure, Quantity::exposure), real(io, &m->frames_per_second, Quantity::frame_rate);
  effects(io, &m->effects), number(io, &m->triangle_count);
  point(io, &m->bounds.low), point(io, &m->bounds.high);
  io.require(!is_empty(m->bounds));
}

template <class Io>
void fields_of_type(Io& io, Message* m) {
  switch (m->type) {
    case MessageType::hello:
      return fields(io, &m->hello);
    case MessageType::scene_list:
      return fields(io, &m->scene_list);
    case MessageType::scene_query:
      return fields(io, &m->scene_query);
    case MessageType::scene_entry:
      return fields(io, &m->scene_entry);
    case MessageType::scene_fetch:
      return fields(io, &m->scene_fetch);
    case MessageType::scene_piece:
      return fields(io, &m->scene_piece);
    case MessageType::frame_request:
      return fields(io, &m->frame_request);
    case MessageType::row_chunk:
      return fields(io, &m->row_chunk);
    case MessageType::cancel:
      return fields(io, &m->cancel);
    case MessageType::error:
      return fields(io, &m->error);
    case MessageType::ping:
      return fields(io, &m->ping);
    case MessageType::pong:
      return fields(io, &m->pong);
    case MessageType::view_query:
      return fields(io, &m->view_query);
    case MessageType::view_entry:
      return fields(io, &m->view_entry);
    case MessageType::frame_change:
      return change_fields(io, &m->frame_request);
    case MessageType::coarse_picture:
      return fields(io, &m->coarse_picture);
    case MessageType::light_map:
      return fields(io, &m->light_map);
  }
}

// Bytes after the header: fixed fields, and the maximum of the data after them.
struct PayloadSize {
  std::uint32_t fields, tail_max;
};
constexpr PayloadSize kPayloadSizes[] = {
    {0, 0},                                          // no type
    {22, 0},                                         // hello
    {2, 0},                                          // scene_list
    {16, 0},                                         // scene_query
    {96, 0},                                         // scene_entry
    {28, 0},                                         // scene_fetch
    {24, kPieceBytesMax},                            // scene_piece
    {98 + kSettingsBytes, kRunBytes* kRunCountMax},  // frame_request
    {9, 4 + kChunkBytesMax},                         // row_chunk
    {4, 0},                                          // cancel
    {6, 0},                                          // error
    {8, 0},                                          // ping
    {10, kPingBytesMax},                             // pong
    {68 + kNameBytes + kSettingsBytes, 0},           // view_query
    {136, 0},                                        // view_entry
    {41, kRunBytes* kRunCountMax},                   // frame_change
    {2, kChunkBytesMax},                             // coarse_picture
    {6, kChunkBytesMax},                             // light_map
};
constexpr std::uint32_t kTypeCount = sizeof kPayloadSizes / sizeof kPayloadSizes[0];
static_assert(kTypeCount == static_cast<std::uint32_t>(MessageType::light_map) + 1, "one for each type");

// The fields of a request, zero-padded.
struct RequestBytes {
  static constexpr PayloadSize kSize = kPayloadSizes[static_cast<std::uint32_t>(MessageType::frame_request)];
  std::uint8_t bytes[kSize.fields + kSize.tail_max] = {};
};
// Returns false if no reader would accept the request.
bool write_request(FrameRequest request, RequestBytes* to) {
  Writer writer = {to->bytes};
  fields(writer, &request);
  return writer.valid;
}

// A hello of another version may end after magic and version, or continue arbitrarily.
constexpr std::uint32_t kForeignHelloBytesMin = 6, kForeignHelloBytesMax = 256;

std::uint32_t tail_bytes(const Message& m) {
  if (m.type == MessageType::scene_piece) return m.scene_piece.bytes.count;
  if (m.type == MessageType::row_chunk)
    return (m.row_chunk.price != 0 ? 2u : 0) + (m.row_chunk.prepare_ns != 0 ? 2u : 0) + m.row_chunk.bytes.count;
  if (m.type == MessageType::pong) return m.pong.bytes.count;
  if (m.type == MessageType::coarse_picture) return m.coarse_picture.pixels.count;
  if (m.type == MessageType::light_map) return m.light_map.bytes.count;
  if (m.type == MessageType::frame_request || m.type == MessageType::frame_change)
    return kRunBytes * m.frame_request.run_count;
  return 0;
}

bool length_possible(std::uint32_t type, std::uint32_t payload) {
  if (type == static_cast<std::uint32_t>(MessageType::hello))
    return payload >= kForeignHelloBytesMin && payload <= kForeignHelloBytesMax;
  const PayloadSize& size = kPayloadSizes[type];
  return payload >= size.fields && payload - size.fields <= size.tail_max;
}

std::uint32_t checksum(const std::uint8_t* bytes, std::uint32_t payload) {
  uLong crc = crc32(0, bytes, kChecksumAt);
  return static_cast<std::uint32_t>(crc32(crc, bytes + kHeaderBytes, payload));
}

bool decode_payload(const std::uint8_t* payload, std::uint32_t byte_count, Message* message) {
  Reader reader = {payload, payload + byte_count};
  if (message->type == MessageType::hello) {
    Reader start = reader;
    std::uint32_t magic = 0;
    number(start, &magic), number(start, &message->hello.version);
    if (magic != kMagic) return false;
    if (message->hello.version != kWireVersion) return true;
    if (byte_count != kPayloadSizes[static_cast<std::uint32_t>(MessageType::hello)].fields) return false;
  }
  fields_of_type(reader, message);
  return reader.valid;
}

}  // namespace

Decoded decode_message(const std::uint8_t* bytes, std::size_t byte_count, std::uint32_t message_bytes_max,
                       Message* message) {
  constexpr Decoded malformed = {DecodeState::malformed, 0};
  if (byte_count >= 1 && (bytes[0] == 0 || bytes[0] >= kTypeCount)) return malformed;
  if (byte_count < kHeaderBytes) return {DecodeState::need_more, kHeaderBytes};
  std::uint32_t payload = std::uint32_t(bytes[1]) | std::uint32_t(bytes[2]) << 8 | std::uint32_t(bytes[3]) << 16;
  if (!length_possible(bytes[0], payload) || kHeaderBytes + payload > message_bytes_max) return malformed;
  if (byte_count < kHeaderBytes + payload) return {DecodeState::need_more, kHeaderBytes + payload};
  Reader header = {bytes + kChecksumAt, bytes + kHeaderBytes};
  std::uint32_t stated = 0;
  number(header, &stated);
  if (stated != checksum(bytes, payload)) return malformed;
  *message = Message();
  message->type = static_cast<MessageType>(bytes[0]);
  if (!decode_payload(bytes + kHeaderBytes, payload, message)) return malformed;
  return {DecodeState::message, kHeaderBytes + payload};
}

std::uint32_t message_bytes(const Message& message) {
  return kHeaderBytes + kPayloadSizes[static_cast<std::uint32_t>(message.type)].fields + tail_bytes(message);
}

bool can_encode(const Message& message) {
  Message copy = message;
  Checker checker;
  fields_of_type(checker, &copy);
  return checker.valid && tail_bytes(message) <= kPayloadSizes[static_cast<std::uint32_t>(message.type)].tail_max;
}

void encode_message(const Message& message, std::uint8_t* bytes) {
  std::uint32_t payload = message_bytes(message) - kHeaderBytes;
  CHECK_LE(tail_bytes(message), kPayloadSizes[static_cast<std::uint32_t>(message.type)].tail_max);
  Message copy = message;  // encoding only reads through the pointers that decoding writes through
  Writer writer = {bytes + kHeaderBytes};
  fields_of_type(writer, &copy);
  CHECK(writer.valid);
  CHECK_EQ(writer.at - (bytes + kHeaderBytes), static_cast<std::ptrdiff_t>(payload));
  writer.at = bytes;
  std::uint8_t type = static_cast<std::uint8_t>(message.type);
  number(writer, &type), number(writer, &payload, 3);
  std::uint32_t sum = checksum(bytes, payload);
  number(writer, &sum);
}

std::uint32_t row_chunk_prefix_bytes(bool states_price, bool states_preparation) {
  return kHeaderBytes + kPayloadSizes[static_cast<std::uint32_t>(MessageType::row_chunk)].fields +
         (states_price ? 2u : 0) + (states_preparation ? 2u : 0);
}

std::uint32_t coarse_prefix_bytes() {
  return kHeaderBytes + kPayloadSizes[static_cast<std::uint32_t>(MessageType::coarse_picture)].fields;
}

std::uint32_t light_map_prefix_bytes() {
  return kHeaderBytes + kPayloadSizes[static_cast<std::uint32_t>(MessageType::light_map)].fields;
}

void take_change(const FrameRequest& change, FrameRequest* request) {
  request->frame = change.frame, request->seconds = change.seconds;
  request->camera.eye = change.camera.eye, request->camera.target = change.camera.target;
  request->coarse_first = change.coarse_first;
  request->row_begin = change.row_begin, request->row_end = change.row_end;
  request->run_count = change.run_count;
  std::memcpy(request->runs, change.runs, sizeof request->runs);
}

bool is_change(const FrameRequest& request, const FrameRequest& before) {
  RequestBytes change, wanted, made;
  FrameRequest sent = request, received, result = before;
  Writer writer = {change.bytes};
  change_fields(writer, &sent);
  Reader reader = {change.bytes, writer.at};
  change_fields(reader, &received);
  if (!writer.valid || !reader.valid) return false;
  take_change(received, &result);
  return write_request(request, &wanted) && write_request(result, &made) &&
         std::memcmp(wanted.bytes, made.bytes, sizeof wanted.bytes) == 0;
}

}  // namespace pocketray
