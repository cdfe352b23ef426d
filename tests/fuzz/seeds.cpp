#include <array>
#include <cstdint>

#include "accel/accel_list.h"
#include "fuzz/fuzz.h"
#include "plan/front.h"
#include "scene/baked_file.h"
#include "scene/full_scene.h"
#include "wire/codec.h"
#include "wire/sample_messages.h"

namespace pocketray {
namespace {

using Bytes = std::vector<std::uint8_t>;

void append(Bytes* bytes, const Bytes& more) { bytes->insert(bytes->end(), more.begin(), more.end()); }

// The message as the sealed kind of input has it.
Bytes unsealed(const Bytes& message) {
  Bytes bytes(message.begin(), message.begin() + 3);
  bytes.insert(bytes.end(), message.begin() + kHeaderBytes, message.end());
  return bytes;
}

// A picture of 24 × 16 that drifts, as chunks an encoder writes.
Bytes chunk_seed(WireFormat format, RowCoding coding) {
  CodecShape shape = {24, 16, 4, format};
  Bytes block(row_encoder_need(shape) + kArenaAlignment), chunk(encoded_bytes_max(shape, 4));
  Arena arena = make_arena("seed", block.data(), block.size());
  RowEncoder* encoder;
  Bytes bytes = {2, static_cast<std::uint8_t>(format)};
  make_row_encoder(shape, &arena, &encoder);
  std::size_t row_bytes = 24 * pixel_bytes(format);
  Bytes picture(16 * row_bytes);
  for (std::uint32_t frame = 0; frame < 2; ++frame)
    for (std::uint32_t row = 16; row > 0; row -= 4) {
      for (std::size_t i = (row - 4) * row_bytes; i < row * row_bytes; ++i)
        if (frame == 0 || i % 50 > 40) picture[i] = static_cast<std::uint8_t>(i / 5 + i % 7 + row);
      std::uint8_t encoding;
      std::uint32_t count = encode_rows(encoder, 1 + frame, row - 4, 4, picture.data() + (row - 4) * row_bytes, coding,
                                        chunk.data(), &encoding);
      encoding = static_cast<std::uint8_t>(encoding | frame << 7);
      append(&bytes, {static_cast<std::uint8_t>(row - 4), 4, encoding, static_cast<std::uint8_t>(count),
                      static_cast<std::uint8_t>(count >> 8)});
      append(&bytes, Bytes(chunk.begin(), chunk.begin() + count));
    }
  return bytes;
}

Bytes pray_seed(const Scene& scene) {
  BakedFile file = bake(scene);
  Bytes bytes(1 + file.size(), 1);
  std::memcpy(bytes.data() + 1, file.data(), file.size());
  return bytes;
}

// A scene with its own accelerator.
Bytes accelerated_seed(Scene scene) {
  const AccelInfo& info = *kAccelList[0];
  std::size_t keep_bytes = info.need(scene.triangles.count), scratch_bytes = info.scratch_need(scene.triangles.count);
  Bytes block(keep_bytes + scratch_bytes + 2 * kArenaAlignment);
  Arena keep = make_arena("accelerator", block.data(), keep_bytes + kArenaAlignment);
  Arena scratch = make_arena("scratch", block.data() + keep_bytes + kArenaAlignment, scratch_bytes + kArenaAlignment);
  Accel accel;
  accel.positions = scene.positions, accel.triangles = scene.triangles;
  info.build(&accel, &keep, &scratch);
  scene.accel = accel.data;
  return pray_seed(scene);
}

}  // namespace

std::vector<FuzzSeed> message_seeds() {
  std::vector<FuzzSeed> seeds;
  Rng rng = make_rng(17);
  Bytes all = {0};
  for (int type = 1; type <= kMessageTypeCount; ++type) {
    Bytes tail(static_cast<std::size_t>(type), static_cast<std::uint8_t>(type));
    Bytes message = encoded(sample_message(static_cast<MessageType>(type), &rng, tail));
    append(&all, message);
    Bytes sealed(1, 1);
    append(&sealed, unsealed(message));
    seeds.push_back({"type_" + std::to_string(type), sealed});
  }
  seeds.push_back({"every_type", all});
  // Rows, other rows, light alone, rows and light.
  Bytes requests = {0};
  Message request = sample_message(MessageType::frame_request, &rng, {});
  FrameRequest* q = &request.frame_request;
  q->settings.height = 40, q->run_count = 0;
  for (const auto& part : {std::array<std::uint8_t, 3>{0, 9, 0}, {9, 40, 0}, {0, 0, 6}, {5, 6, 6}}) {
    q->row_begin = part[0], q->row_end = part[1], q->light_pitch = part[2];
    append(&requests, encoded(request));
  }
  seeds.push_back({"requests", requests});
  for (WireFormat format : {WireFormat::rgb565, WireFormat::rgb888})
    for (RowCoding coding : {RowCoding::raw, RowCoding::lossless, RowCoding::near_lossless}) {
      const char* codings[] = {"raw", "lossless", "near_lossless"};
      const std::uint8_t format_byte = static_cast<std::uint8_t>(format),
                         coding_byte = static_cast<std::uint8_t>(coding);
      const std::string name = std::string(format == WireFormat::rgb565 ? "rgb565_" : "rgb888_") + codings[coding_byte];
      seeds.push_back({"chunks_" + name, chunk_seed(format, coding)});
      seeds.push_back({"pictures_" + name,
                       {3, format_byte, 0, 3, coding_byte, 2, 7, 9, 5, 1, coding_byte, 1, 255, 0, 3, coding_byte, 0}});
    }
  return seeds;
}

std::vector<FuzzSeed> pray_seeds() {
  std::vector<FuzzSeed> seeds;
  FullScene full;
  make_full_scene(11, 12, 4, &full);
  full.accel.clear();
  full.bind();
  seeds.push_back({"full", pray_seed(full.scene)});
  seeds.push_back({"accelerated", accelerated_seed(full.scene)});
  return seeds;
}

std::vector<FuzzSeed> front_seeds() {
  auto text_of = [](const Front& front) {
    std::vector<char> text(kFrontTextMax);
    std::size_t length = format_front(front, text.data(), text.size());
    return Bytes(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(length));
  };
  auto bytes_of = [](const std::string& text) { return Bytes(text.begin(), text.end()); };
  Front front = builtin_front(0), few = front;
  few.count = 3;
  for (std::uint32_t i = 0; i < few.count; ++i) {
    few.candidates[i].flip = 0.1f / static_cast<float>(i + 1);
    few.candidates[i].ns_per_pixel = 100.5f * static_cast<float>(i + 1);
  }
  Bytes both = text_of(few);
  both.push_back(0);
  append(&both, text_of(front));
  return {{"builtin", text_of(front)},
          {"with_prices", both},
          {"comments", bytes_of("pocketray-front 2\r\n\n# what follows\nsamples=4 depth=8 area-lights=16 "
                                "cut-off=5e-1 "
                                "texture-filter=nearest normals=flat indirect=auto reconstruction=bicubic "
                                "virtual-lights=64 selective=0 resolution=full light-tolerance=0.0625 "
                                "environment-shadows=32 flip=1 ns=1e9\n")},
          {"another_version", bytes_of("pocketray-front 2\nsamples=4\n")}};
}

std::vector<FuzzSeed> text_seeds() {
  auto seed = [](const char* name, std::uint8_t kind, const std::string& text) {
    Bytes bytes(1, kind);
    append(&bytes, Bytes(text.begin(), text.end()));
    return FuzzSeed{name, bytes};
  };
  return {
      seed("size", 0, "320x240"),
      seed("bytes", 1, "24.5M"),
      seed("camera", 2, "0,1.5,-3 0,1,0 0,1,0 40"),
      seed("exposure", 3, "-1.5"),
      seed("effects", 4, "auto,-shadow"),
      seed("callgrind", 5, "version: 1\ndesc: Trigger: --dump-before=work\nevents: Ir\ntotals: 123456\n"),
      seed(
          "state", 6,
          R"({"key": {}, "rounds": 1, "counted": "", "references": ["a"], "points": {"samples 4": )"
          R"({"ns_per_pixel": [812.5], "instructions_per_pixel": "none", "bytes_per_frame": 9500.5, "stored_bytes": 1e6, )"
          R"("bake_seconds": "none", "errors": [0.1, 0.01, 0.1, 0.1, 0.1, 0.1, "inf"], "truth": {"flip": 0.2, "one": [0.2, 0.25], "other": [0.2, 0.15]}, )"
          R"("model": {"flip": 0.1, "one": [0.1], "other": [0.1]}, "flip_as": [0.2, 0.2, 0.15]}}})")};
}

// A well-behaved server with each kind of device; then one that changes, drops, repeats and adds messages.
std::vector<FuzzSeed> client_seeds() {
  std::vector<FuzzSeed> seeds;
  const char* const kNames[] = {"thin", "scene", "thin_rgb888", "scene_rgb888", "thin_far", "scene_far"};
  for (std::uint8_t flags = 0; flags < 6; ++flags) {
    Bytes bytes(16, 0);
    bytes[0] = flags;
    seeds.push_back({kNames[flags], bytes});
  }
  for (std::uint8_t flags : {16, 19}) {
    Bytes bytes(16, 0);
    bytes[0] = flags;
    seeds.push_back({flags == 16 ? "thin_coarse" : "scene_coarse", bytes});
  }
  // Frames by effect, and by what is faster, over links of every latency.
  const std::pair<const char*, std::uint8_t> kLit[] = {{"scene_light", 33},
                                                       {"scene_light_and_rows", 97},
                                                       {"scene_light_and_rows_near", 101},
                                                       {"scene_light_and_rows_far", 225},
                                                       {"scene_light_and_rows_farthest", 229}};
  for (const auto& lit : kLit) {
    Bytes bytes(16, 0);
    bytes[0] = lit.second;
    seeds.push_back({lit.first, bytes});
  }
  // As below, of the light map.
  seeds.push_back({"changes_a_light_map", {33, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 192, 9, 1, 0, 192, 20, 255, 0}});
  Bytes inquiry(16, 0);
  inquiry[0] = 8;
  seeds.push_back({"inquiry", inquiry});
  // After the hello, the scene and three pongs.
  seeds.push_back({"changes_a_chunk", {1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 192, 9, 1, 0, 192, 20, 255, 0}});
  seeds.push_back({"adds_a_pong", {1, 0, 0, 0, 0, 0, 232, 12, 8, 1, 0, 0, 0, 0, 0, 0, 0, 0}});
  seeds.push_back({"floods", {1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 244, 12, 8, 1, 0, 0, 0, 0, 0, 0, 0, 0}});
  seeds.push_back({"reports_errors", {1, 0, 0, 232, 10, 6, 6, 0, 0, 0, 0, 0, 0}});
  seeds.push_back({"hangs_up", {0, 0, 0, 0, 0, 0, 250, 0, 0, 254, 0, 0, 255}});
  return seeds;
}

// Two clients at once: their messages, with rounds of the server in between.
std::vector<FuzzSeed> server_seeds() {
  return {{"lists", {4, 2, 1, 0, 0, 1, 0, 7, 3, 2, 0, 0, 1, 0, 7}},
          {"fetches", {4, 2, 3, 16, 0, 1, 0, 7, 3, 3, 255, 0, 1, 0, 7}},
          {"frames", {4, 2, 4, 0, 0, 1, 1, 0, 7, 3, 4, 0, 0, 2, 3, 0, 7, 2, 5, 0, 0, 2, 0, 0, 7}},
          {"cancels", {5, 2, 4, 0, 0, 1, 1, 0, 1, 2, 6, 0, 0, 1, 0, 0, 7}},
          {"pings", {6, 2, 7, 0, 200, 1, 0, 3, 7, 0, 255, 1, 0, 0, 7}},
          {"views", {4, 2, 8, 0, 0, 0, 0, 0, 7, 3, 8, 0, 0, 0, 0, 1, 7}},
          {"changed", {4, 6, 4, 0, 0, 1, 1, 60, 255, 0, 7, 8, 8, 0, 0, 0, 0, 30, 1, 0, 7}},
          {"not_greeted", {0, 10, 9, 4, 1, 2, 3, 4, 0, 3, 12, 8, 1, 2, 3, 4, 5, 6, 7, 8, 0, 7}},
          // Rows, light alone, light and rows, rows; far away.
          {"light", {13, 2, 4, 0, 0,  1,  1, 0, 0, 7, 2, 4, 0, 0, 226, 1, 0, 0, 7,
                     2,  4, 0, 0, 99, 81, 0, 0, 7, 2, 4, 0, 0, 4, 5,   0, 0, 7}},
          {"hangs_up", {4, 2, 4, 0, 0, 1, 1, 0, 1, 46, 0, 1, 31, 2, 0, 0, 0, 0, 0, 0, 7}}};
}

}  // namespace pocketray
