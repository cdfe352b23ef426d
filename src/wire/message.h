// Messages between a device and a render server: bytes ↔ structs, as PROTOCOL.md describes. Pure. Bytes are hostile
// until decoded: whatever comes out of decode_message() lies within the limits stated here.
#pragma once
#include <cstddef>
#include <cstdint>

#include "base/array.h"
#include "base/box.h"
#include "effect/setting_list.h"
#include "scene/content_hash.h"
#include "scene/scene.h"

namespace pocketray {

// Each setting more in a request is a version more; what else changes bytes raises the other number.
constexpr std::uint16_t kWireVersion = 4 + (kSettingCount - 6);
constexpr std::uint32_t kHeaderBytes = 8;
constexpr std::uint32_t kPieceBytesMax = 1u << 16;  // of a scene, in one message
constexpr std::uint32_t kPingBytesMax = 1u << 16;   // of a pong's payload
constexpr std::uint32_t kChunkBytesMax = 1u << 20;  // of a chunk's encoded rows
constexpr std::uint32_t kMessageBytesMax = kHeaderBytes + kChunkBytesMax + 64;
constexpr std::uint32_t kNameBytes = 64;

enum class MessageType : std::uint8_t {
  hello = 1,      // both, first
  scene_list,     // device: the server's scene of an index?
  scene_query,    // device: do you have this scene?
  scene_entry,    // server: answer to both
  scene_fetch,    // device: bytes of a scene's baked file, please
  scene_piece,    // server
  frame_request,  // device
  row_chunk,      // server
  cancel,         // device
  error,          // both
  ping,           // device
  pong,           // server
  view_query,     // device: how does this scene look from there?
  view_entry,     // server
  frame_change,   // device: a frame_request like the one before
};

struct Hello {
  std::uint16_t version = kWireVersion;  // of another version, this is all that is decoded
  std::uint16_t image_side_max = 0;      // pixels the sender takes or renders
  std::uint32_t message_bytes_max = 0;   // header included; the sender's receive buffer
  std::uint64_t scene_bytes_max = 0;     // of a baked file that the sender would take; 0: none
};

struct SceneList {
  std::uint16_t index = 0;
};
struct SceneQuery {
  ContentHash hash;
};
struct SceneEntry {
  ContentHash hash;
  std::uint64_t byte_count = 0;        // of the baked file; 0: there is no such scene
  std::uint16_t index = 0, count = 0;  // its place in the server's list, and how many that has
  std::uint32_t triangle_count = 0;
  char name[kNameBytes] = {0};  // for people; ends in 0
};
struct SceneFetch {
  ContentHash hash;
  std::uint64_t offset = 0;
  std::uint32_t byte_count = 0;  // at most kPieceBytesMax
};
struct ScenePiece {
  ContentHash hash;
  std::uint64_t offset = 0;
  Array<const std::uint8_t> bytes;
};

enum class WireFormat : std::uint8_t { rgb565, rgb888 };  // 2 bytes, little-endian; 3 bytes R, G, B
constexpr std::uint32_t pixel_bytes(WireFormat format) { return format == WireFormat::rgb565 ? 2 : 3; }

// Rows of a frame, please: from the bottom of the band upward, in chunks.
struct FrameRequest {
  std::uint32_t frame = 0;  // counts up
  ContentHash scene;
  double seconds = 0;          // of the animation
  bool camera_stated = false;  // else the scene's own of that index
  std::uint16_t camera_index = 0;
  Camera camera;       // world space; its node is kNone
  Settings settings;   // those that change pixels; threads and memory are the server's own
  float exposure = 0;  // 0: the scene's own
  bool dither = false;
  WireFormat format = WireFormat::rgb565;
  std::uint16_t row_begin = 0, row_end = 0;
  std::uint16_t chunk_rows = 1, chunk_rows_max = 1;  // of the first chunk and the last; of those between
  std::uint8_t chunk_growth = 0;                     // 16ths by which they grow from either end
  std::uint8_t deflate_level = 1;                    // 0 (no compression) to 9
};

struct RowChunk {
  std::uint32_t frame = 0;
  std::uint16_t row_begin = 0, row_count = 0;
  std::uint32_t pixel_ps = 0;  // what a pixel of these rows cost the server, picoseconds; ~0u: that or more
  std::uint8_t encoding = 0;   // see codec.h
  Array<const std::uint8_t> bytes;
};

struct Cancel {
  std::uint32_t frame = 0;  // this one and all before
};

enum class WireError : std::uint16_t {
  wrong_version = 1,
  malformed,      // the last of the sender's patience: the connection ends
  unknown_scene,  // the request is dropped, the connection goes on; so for those below
  too_large,      // picture, band or scene
  bad_request,
  busy,
  closing,  // the server ends
};
struct ErrorReport {
  WireError code = WireError::malformed;
  std::uint32_t frame = 0;  // the request's; 0 where it is about none
};

struct Ping {
  std::uint32_t id = 0, reply_bytes = 0;  // at most kPingBytesMax
};
struct Pong {
  std::uint32_t id = 0;
  std::uint32_t pixel_ps = 0;       // what a pixel cost the server of late; 0: it has rendered none
  Array<const std::uint8_t> bytes;  // of no meaning
};

// What a device without the scene has to know of it before it asks for frames.
struct ViewQuery {
  ContentHash scene;
  bool camera_stated = false;  // as in a FrameRequest
  std::uint16_t camera_index = 0;
  Camera camera;
  Settings settings;
  bool measure_exposure = false;  // whether or not the scene asks for it
};
struct ViewEntry {
  ContentHash scene;
  Camera camera;       // world space, at time 0; its node is kNone
  float exposure = 1;  // measured from there where that is asked for, else the scene's
  float frames_per_second = 1;
  EffectMask effects = 0;  // planned
  std::uint32_t triangle_count = 0;
  Box bounds = {{0, 0, 0}, {0, 0, 0}};  // low ≤ high
};

// The member of the type holds, the others are at their defaults.
struct Message {
  MessageType type = MessageType::hello;
  Hello hello;
  SceneList scene_list;
  SceneQuery scene_query;
  SceneEntry scene_entry;
  SceneFetch scene_fetch;
  ScenePiece scene_piece;
  FrameRequest frame_request;  // of a frame_change what changes from frame to frame, see take_change()
  RowChunk row_chunk;
  Cancel cancel;
  ErrorReport error;
  Ping ping;
  Pong pong;
  ViewQuery view_query;
  ViewEntry view_entry;
};

enum class DecodeState { need_more, message, malformed };

struct Decoded {
  DecodeState state;
  std::uint32_t byte_count;  // of the message: to take off the stream, or to have before there is one (at least; header
                             // first). 0 where malformed
};

// The message at the front of a stream of bytes. Arrays in it point into `bytes`. Malformed as early as can be told: an
// unknown type, a length that the type cannot have or beyond message_bytes_max, a wrong checksum, a value out of range.
// What follows on a malformed message means nothing: end the connection.
Decoded decode_message(const std::uint8_t* bytes, std::size_t byte_count, std::uint32_t message_bytes_max,
                       Message* message);

// Bytes that the message takes, header included.
std::uint32_t message_bytes(const Message& message);

// Whether encode_message() takes it: every value within its limits. For messages whose values come from elsewhere.
bool can_encode(const Message& message);
// Writes message_bytes(message) of them. What a message's arrays hold may already lie where it goes, at the end. Values
// that the decoder would refuse are a programmer error.
void encode_message(const Message& message, std::uint8_t* bytes);

// Bytes before the rows of a row_chunk, header included: where to encode them so that nothing is copied.
std::uint32_t row_chunk_prefix_bytes();

// What a frame_change says of the request before it: its number, time, camera, rows, chunks and level.
void take_change(const FrameRequest& change, FrameRequest* request);
// Whether `request` says of `before` nothing that a frame_change could not.
bool is_change(const FrameRequest& request, const FrameRequest& before);

// Rows of the next chunk of a request: `rows_before` are those of the chunk before, 0 where it is the first, and
// `rows_left` (≥ 1) those that are still to be sent. A sender may make it smaller.
std::uint32_t next_chunk_rows(const FrameRequest& request, std::uint32_t rows_before, std::uint32_t rows_left);

}  // namespace pocketray
