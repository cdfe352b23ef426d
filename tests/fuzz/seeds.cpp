#include <cstdint>

#include "accel/accel_list.h"
#include "fuzz/fuzz.h"
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

// A picture of 24 × 16 that drifts, as chunks an encoder writes at a level.
Bytes chunk_seed(WireFormat format, int level) {
  CodecShape shape = {24, 16, 4, format};
  Bytes block(row_encoder_need(shape) + kArenaAlignment), chunk(encoded_bytes_max(shape, 4));
  Arena arena = make_arena("seed", block.data(), block.size());
  RowEncoder* encoder;
  Bytes bytes = {2, static_cast<std::uint8_t>(format)};
  if (!make_row_encoder(shape, &arena, &encoder).ok) return bytes;
  std::size_t row_bytes = 24 * pixel_bytes(format);
  Bytes picture(16 * row_bytes);
  for (int frame = 0; frame < 2; ++frame)
    for (std::uint32_t row = 16; row > 0; row -= 4) {
      for (std::size_t i = (row - 4) * row_bytes; i < row * row_bytes; ++i)
        if (frame == 0 || i % 50 > 40) picture[i] = static_cast<std::uint8_t>(i / 5 + i % 7 + row);
      std::uint8_t encoding;
      std::uint32_t count =
          encode_rows(encoder, row - 4, 4, picture.data() + (row - 4) * row_bytes, level, chunk.data(), &encoding);
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

// With an accelerator of its own in it.
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
  for (WireFormat format : {WireFormat::rgb565, WireFormat::rgb888})
    for (int level : {0, 6}) {
      std::string name = (format == WireFormat::rgb565 ? "rgb565_level_" : "rgb888_level_") + std::to_string(level);
      seeds.push_back({"chunks_" + name, chunk_seed(format, level)});
      std::uint8_t format_byte = static_cast<std::uint8_t>(format), level_byte = static_cast<std::uint8_t>(level);
      seeds.push_back({"pictures_" + name,
                       {3, format_byte, 0, 3, level_byte, 2, 7, 9, 5, 1, level_byte, 1, 255, 0, 3, level_byte, 0}});
    }
  return seeds;
}

std::vector<FuzzSeed> pray_seeds() {
  std::vector<FuzzSeed> seeds;
  FullScene full;
  make_full_scene(11, 12, 4, &full);
  full.accel.clear();
  for (Material& material : full.materials) material.brdf = 0;  // the one glossy lobe there is
  full.bind();
  seeds.push_back({"full", pray_seed(full.scene)});
  seeds.push_back({"accelerated", accelerated_seed(full.scene)});
  return seeds;
}

}  // namespace pocketray
