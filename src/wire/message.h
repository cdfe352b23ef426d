// Messages between a device and a render server: bytes ↔ structs, as described in PROTOCOL.md. Pure. Bytes are hostile
// until decoded: everything that decode_message() returns lies within the limits stated here.
#pragma once
#include <cstddef>
#include <cstdint>

#include "base/array.h"
#include "base/box.h"
#include "base/span.h"
#include "effect/setting_list.h"
#include "scene/content_hash.h"
#include "scene/scene.h"

namespace pocketray {

constexpr int settings_on_wire() {
  int count = 0;
  for (const SettingRow& row : kSettingList) count += row.wire_bytes > 0;
  return count;
}
// Each setting added to requests adds 1 to the version; for any other change of the format, raise the first number.
constexpr std::uint16_t kWireVersion = 24 + (settings_on_wire() - 6);
constexpr std::uint32_t kHeaderBytes = 8;
constexpr std::uint32_t kPieceBytesMax = 1u << 16;  // scene bytes per message
constexpr std::uint32_t kPingBytesMax = 1u << 16;   // of a pong's payload
constexpr std::uint32_t kChunkBytesMax = 1u << 20;  // of a chunk's encoded rows
constexpr std::uint32_t kMessageBytesMax = kHeaderBytes + kChunkBytesMax + 64;
constexpr std::uint32_t kNameBytes = 64;

enum class MessageType : std::uint8_t {
  hello = 1,       // both, first
  scene_list,      // device: which scene has this index?
  scene_query,     // device: do you have this scene?
  scene_entry,     // server: answers either
  scene_fetch,     // device: send bytes of a scene's baked file
  scene_piece,     // server
  frame_request,   // device
  row_chunk,       // server
  cancel,          // device
  error,           // both
  ping,            // device
  pong,            // server
  view_query,      // device: how is this scene viewed?
  view_entry,      // server
  frame_change,    // device: a frame_request that differs little from the previous one
  coarse_picture,  // server: preview of a frame, before its rows
  light_map,       // server: indirect light of a frame, instead of rows
};

struct Hello {
  std::uint16_t version = kWireVersion;  // if it differs from ours, nothing else is decoded
  std::uint16_t image_side_max = 0;      // largest picture side that the sender accepts or renders
  std::uint32_t message_bytes_max = 0;   // header included; the sender's receive buffer
  std::uint64_t scene_bytes_max = 0;     // largest baked file that the sender accepts; 0: none
  std::uint16_t price = kPriceUnit;      // of a server's time for this device, see RowChunk; a device states the unit
};

struct SceneList {
  std::uint16_t index = 0;
};
struct SceneQuery {
  ContentHash hash;
};
struct SceneEntry {
  ContentHash hash;
  std::uint64_t byte_count = 0;        // of the baked file; 0: no such scene
  std::uint16_t index = 0, count = 0;  // position in the server's list, length of the list
  std::uint32_t triangle_count = 0;
  char name[kNameBytes] = {0};  // display name; null-terminated
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

constexpr std::uint32_t kRunCountMax = 64;

// Consecutive rows of a request, and their place in the order.
struct RowRun {
  std::uint8_t row_count = 0, place = 0;
};

// How a server sends rows: raw, unless they are unchanged; coded losslessly; or coded with an error of up to one level
// per channel.
enum class RowCoding : std::uint8_t { raw, lossless, near_lossless };

// Requests rows of a frame. They arrive run by run, each from its lowest row upward.
struct FrameRequest {
  std::uint32_t frame = 0;  // increasing
  ContentHash scene;
  double seconds = 0;           // animation time
  std::uint32_t animation = 0;  // index in the scene; kNone: none plays; 0: the default, which every scene has
  bool camera_stated = false;   // false: the scene's camera with that index
  std::uint16_t camera_index = 0;
  Camera camera;       // world space; its node is kNone
  Settings settings;   // those that change pixels; the server chooses threads and memory
  float exposure = 0;  // 0: the scene's own
  bool dither = false;
  WireFormat format = WireFormat::rgb565;
  std::uint16_t row_begin = 0, row_end = 0;
  std::uint16_t chunk_rows = 1;  // maximum per chunk; no chunk spans two runs
  RowCoding coding = RowCoding::lossless;
  bool coarse_first = false;     // a coarse picture of the whole frame may precede the rows
  std::uint8_t light_pitch = 0;  // spacing in pixels of a light_map sent before the rows, if there are any;
                                 // 0: no light map
  std::uint8_t run_count = 0;    // 0: all rows are one run
  RowRun runs[kRunCountMax];     // from top to bottom; their places are a permutation of 0 … run_count − 1
};

constexpr std::uint32_t kChunkRowsLimit = 255;  // maximum of any chunk
// Bits of a chunk's encoding on the wire: the price follows; then, the server's preparation time follows.
constexpr std::uint8_t kEncodingPrice = 2, kEncodingPreparation = 4;

struct RowChunk {
  std::uint32_t frame = 0;  // received: its low 16 bits, see frame_of()
  std::uint16_t row_begin = 0, row_count = 0;
  std::uint32_t pixel_ps = 0;        // server time per pixel of these rows, picoseconds; arrives up to .1 % lower
  std::uint16_t price = kPriceUnit;  // slowdown of work by other clients of the server, in 256ths; 0: as the server
                                     // stated last
  std::uint8_t traced = 0;           // 255ths of these pixels; the server reused the others from its last frame
  std::uint8_t encoding = 0;         // see codec.h
  Array<const std::uint8_t> bytes;
  std::uint32_t prepare_ns = 0;  // server time before the frame's first pixel; arrives up to .1 % lower; 0: not
                                 // stated
};

// Frame number of a received chunk or coarse picture: the last one up to `latest` with these low bits.
inline std::uint32_t frame_of(std::uint32_t low_bits, std::uint32_t latest) {
  return latest - ((latest - low_bits) & 0xFFFFu);
}
// Part of the pixels that were traced, in 255ths, rounded up; 0 only if none was.
inline std::uint8_t traced_part(std::uint64_t traced, std::uint64_t pixel_count) {
  return static_cast<std::uint8_t>((255 * traced + pixel_count - 1) / pixel_count);
}

// The top left pixel of every square of kCoarseSide × kCoarseSide pixels, counted from the top left corner.
constexpr std::uint32_t kCoarseSide = 8;
struct CoarsePicture {
  std::uint32_t frame = 0;  // received: its low 16 bits
  Array<const std::uint8_t> pixels;
};
constexpr std::uint32_t coarse_count(std::uint32_t pixel_count) {
  return (pixel_count + kCoarseSide - 1) / kCoarseSide;
}
// Size of a coarse picture's pixels.
constexpr std::uint32_t coarse_bytes(std::uint32_t width, std::uint32_t height, WireFormat format) {
  return coarse_count(width) * coarse_count(height) * pixel_bytes(format);
}

// Indirect light at every light_pitch-th pixel of every light_pitch-th row, before reflection: irradiance / π on the
// visible surface. light_coder.h describes the coding.
constexpr std::uint32_t kLightPitchLow = 2, kLightPitchHigh = 16;
struct LightMapMessage {
  std::uint32_t frame = 0;           // received: its low 16 bits
  std::uint32_t light_ps = 0;        // server time per light, picoseconds; arrives up to .1 % lower
  std::uint16_t price = kPriceUnit;  // as in a RowChunk
  Array<const std::uint8_t> bytes;
};
constexpr std::uint32_t light_map_side(std::uint32_t pixel_count, std::uint32_t pitch) {
  return (pixel_count + pitch - 1) / pitch;
}

struct Cancel {
  std::uint32_t frame = 0;  // cancels this frame and all before it
};

enum class WireError : std::uint16_t {
  wrong_version = 1,
  malformed,      // the connection ends
  unknown_scene,  // the request is dropped, the connection continues; likewise below
  too_large,      // picture, band or scene
  bad_request,
  busy,
  closing,  // the server shuts down
};
struct ErrorReport {
  WireError code = WireError::malformed;
  std::uint32_t frame = 0;  // of the request; 0: none
};

struct Ping {
  std::uint32_t id = 0, reply_bytes = 0;  // at most kPingBytesMax
};
struct Pong {
  std::uint32_t id = 0;
  std::uint32_t pixel_ps = 0;        // recent time per pixel; 0: the server has rendered none
  std::uint16_t price = kPriceUnit;  // as in a RowChunk
  Array<const std::uint8_t> bytes;   // arbitrary
};

// Asks what a device without the scene must know before it requests frames.
struct ViewQuery {
  ContentHash scene;
  char animation[kNameBytes] = {0};  // as given to --animation; empty: the default
  bool camera_stated = false;        // as in a FrameRequest
  std::uint16_t camera_index = 0;
  Camera camera;
  Settings settings;
  bool measure_exposure = false;  // even if the scene does not ask for it
};
struct ViewEntry {
  ContentHash scene;
  std::uint32_t animation = 0;     // of a FrameRequest: the one asked for
  SceneOrigin origin = {0, 0, 0};  // in the model's own coordinates; origin of all camera coordinates
  Camera camera;                   // world space, at time 0; its node is kNone
  float exposure = 1;              // measured by the server on request, otherwise the scene's
  float frames_per_second = 1;
  EffectMask effects = 0;  // planned
  std::uint32_t triangle_count = 0;
  Box bounds = {{0, 0, 0}, {0, 0, 0}};  // low ≤ high
};

constexpr bool asks_for_something(const FrameRequest& request) {
  return request.row_begin < request.row_end || request.light_pitch > 0;
}

// Only the member of the message's type is valid; the others have their defaults.
struct Message {
  MessageType type = MessageType::hello;
  Hello hello;
  SceneList scene_list;
  SceneQuery scene_query;
  SceneEntry scene_entry;
  SceneFetch scene_fetch;
  ScenePiece scene_piece;
  FrameRequest frame_request;  // frame_change: only the fields that change from frame to frame, see take_change()
  RowChunk row_chunk;
  Cancel cancel;
  ErrorReport error;
  Ping ping;
  Pong pong;
  ViewQuery view_query;
  ViewEntry view_entry;
  CoarsePicture coarse_picture;
  LightMapMessage light_map;
};

enum class DecodeState { need_more, message, malformed };

struct Decoded {
  DecodeState state;
  std::uint32_t byte_count;  // length of the message, to remove from the stream; or a lower bound of the bytes needed
                             // to decode it (header first); 0: malformed
};

// Decodes the message at the front of a stream of bytes. Its arrays point into `bytes`. Reports malformed messages as
// early as possible: an unknown type, a length that the type cannot have or that exceeds message_bytes_max, a wrong
// checksum, a value out of range. Bytes after a malformed message are meaningless: end the connection.
Decoded decode_message(const std::uint8_t* bytes, std::size_t byte_count, std::uint32_t message_bytes_max,
                       Message* message);

// Size of the message, including the header.
std::uint32_t message_bytes(const Message& message);

// Returns whether encode_message() accepts the message: every value is within its limits. For untrusted values.
bool can_encode(const Message& message);
// Writes message_bytes(message) bytes. The content of the message's arrays may already be in place at the end. Passing
// values that the decoder would refuse is a programmer error.
void encode_message(const Message& message, std::uint8_t* bytes);

// Bytes before a row_chunk's rows, including the header: encode the rows there to avoid a copy.
std::uint32_t row_chunk_prefix_bytes(bool states_price, bool states_preparation);
// Bytes before a coarse picture's pixels, including the header.
std::uint32_t coarse_prefix_bytes();
// Bytes before a light_map's lights, including the header.
std::uint32_t light_map_prefix_bytes();

// Applies a frame_change to the previous request: number, time, camera, rows and their order, coarse picture.
void take_change(const FrameRequest& change, FrameRequest* request);
// Returns whether a receiver that holds `before` gets exactly `request` from its frame_change; otherwise send it
// whole.
bool is_change(const FrameRequest& request, const FrameRequest& before);

}  // namespace pocketray
