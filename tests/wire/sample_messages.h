// Random valid messages of every type.
#pragma once
#include <cstdio>
#include <cstring>
#include <utility>
#include <vector>

#include "base/limits.h"
#include "base/rng.h"
#include "wire/message.h"

namespace pocketray {

constexpr int kMessageTypeCount = static_cast<int>(MessageType::light_map);

// The message's array points to `tail`, which must outlive it.
inline Message sample_message(MessageType type, Rng* rng, const std::vector<std::uint8_t>& tail) {
  auto wide = [&] { return std::uint64_t(next_u32(rng)) << 32 | next_u32(rng); };
  auto narrow = [&] { return static_cast<std::uint16_t>(next_u32(rng)); };
  auto price = [&] { return static_cast<std::uint16_t>(kPriceUnit + next_u32(rng) % (UINT16_MAX - kPriceUnit + 1)); };
  auto real = [&] { return (next_float(rng) - 0.5f) * 200; };
  Array<const std::uint8_t> bytes = {tail.data(), static_cast<std::uint32_t>(tail.size())};
  ContentHash hash = {wide(), wide()};
  Message m;
  m.type = type;
  m.hello.image_side_max = narrow(), m.hello.message_bytes_max = next_u32(rng), m.hello.scene_bytes_max = wide();
  m.scene_list.index = narrow();
  m.scene_query.hash = m.scene_entry.hash = m.scene_fetch.hash = m.scene_piece.hash = hash;
  m.scene_entry.byte_count = wide(), m.scene_entry.index = narrow(), m.scene_entry.count = narrow();
  m.scene_entry.triangle_count = next_u32(rng);
  std::snprintf(m.scene_entry.name, kNameBytes, "scene %u", next_u32(rng));
  m.scene_fetch.offset = wide() >> 8, m.scene_fetch.byte_count = next_u32(rng) % (kPieceBytesMax + 1);
  m.scene_piece.offset = wide() >> 8, m.scene_piece.bytes = bytes;
  FrameRequest* f = &m.frame_request;
  f->frame = next_u32(rng), f->scene = hash, f->seconds = static_cast<double>(real());
  f->animation = next_u32(rng) % 2 ? kNone : next_u32(rng);
  f->camera_stated = next_u32(rng) % 2 != 0, f->camera_index = narrow() % kCameraCountMax;
  f->camera.eye = {real(), real(), real()}, f->camera.target = {real(), real(), real()}, f->camera.up = {0, real(), 1};
  f->camera.vertical_fov = 1 + next_float(rng), f->camera.vertical_extent = 1 + next_float(rng);
  f->camera.projection = static_cast<Projection>(next_u32(rng) % 2);
  f->settings.width = 1 + next_u32(rng) % kImageSideMax, f->settings.height = 1 + next_u32(rng) % kImageSideMax;
  f->settings.samples_per_pixel = 1 + next_u32(rng) % kSampleCountMax;
  f->settings.ray_depth = next_u32(rng) % (kRayDepthMax + 1);
  f->settings.points_per_area_light = 1 + next_u32(rng) % kPointsPerAreaLightMax;
  f->settings.cut_off_levels = static_cast<float>(next_u32(rng) % 64);
  f->settings.texture_filter = static_cast<TextureFilter>(next_u32(rng) % 5);
  f->settings.normals = static_cast<NormalMode>(next_u32(rng) % 2);
  f->settings.forced_on = wide() & kAllEffects, f->settings.forced_off = wide() & kAllEffects;
  f->exposure = 1 + next_float(rng), f->dither = next_u32(rng) % 2 != 0;
  f->format = static_cast<WireFormat>(next_u32(rng) % 2);
  f->row_begin = static_cast<std::uint16_t>(next_u32(rng) % f->settings.height);
  f->row_end = static_cast<std::uint16_t>(f->row_begin + 1 + next_u32(rng) % (f->settings.height - f->row_begin));
  f->chunk_rows = static_cast<std::uint16_t>(2 + next_u32(rng) % 64);
  // Runs of one to 255 rows, in any order, where the rows are few enough.
  const std::uint32_t rows = f->row_end - f->row_begin, runs = 1 + next_u32(rng) % kRunCountMax;
  if (rows >= runs && rows <= 255 * runs && next_u32(rng) % 4 > 0) {
    f->run_count = static_cast<std::uint8_t>(runs);
    for (std::uint32_t i = 0, left = rows; i < runs; left -= f->runs[i++].row_count) {
      const std::uint32_t behind = runs - i - 1, most = left - behind < 255 ? left - behind : 255;
      const std::uint32_t least = left > 255 * behind ? left - 255 * behind : 1;
      f->runs[i].row_count = static_cast<std::uint8_t>(least + next_u32(rng) % (most - least + 1));
      f->runs[i].place = static_cast<std::uint8_t>(i);
      std::swap(f->runs[i].place, f->runs[next_u32(rng) % (i + 1)].place);
    }
  }
  f->coding = static_cast<RowCoding>(next_u32(rng) % 3), f->coarse_first = next_u32(rng) % 2 != 0;
  m.row_chunk.frame = next_u32(rng), m.row_chunk.row_begin = narrow() % 4000;
  m.row_chunk.row_count = static_cast<std::uint16_t>(1 + next_u32(rng) % 100);
  m.row_chunk.traced = static_cast<std::uint8_t>(next_u32(rng));
  m.row_chunk.pixel_ps = next_u32(rng), m.row_chunk.encoding = static_cast<std::uint8_t>(next_u32(rng));
  m.row_chunk.bytes = bytes, m.row_chunk.prepare_ns = next_u32(rng) | 1;
  m.cancel.frame = next_u32(rng);
  m.error.code = static_cast<WireError>(1 + next_u32(rng) % 7), m.error.frame = next_u32(rng);
  m.ping.id = next_u32(rng), m.ping.reply_bytes = next_u32(rng) % (kPingBytesMax + 1);
  m.pong.id = next_u32(rng), m.pong.pixel_ps = next_u32(rng), m.pong.bytes = bytes;
  ViewQuery* q = &m.view_query;
  q->scene = hash, q->camera_stated = f->camera_stated, q->camera_index = narrow() % kCameraCountMax;
  std::snprintf(q->animation, kNameBytes, "animation %u", next_u32(rng) % 9);
  q->camera = f->camera, q->settings = f->settings, q->measure_exposure = next_u32(rng) % 2 != 0;
  ViewEntry* v = &m.view_entry;
  v->scene = hash, v->animation = f->animation, v->origin = {f->seconds, 5e6, -1}, v->camera = f->camera,
  v->exposure = 1 + next_float(rng), v->frames_per_second = 1 + next_float(rng);
  v->effects = wide() & kAllEffects, v->triangle_count = next_u32(rng);
  v->bounds = {{-next_float(rng), -1, 0}, {next_float(rng), real() + 100, 1}};
  m.coarse_picture.frame = next_u32(rng), m.coarse_picture.pixels = bytes;
  if (next_u32(rng) % 2) f->light_pitch = static_cast<std::uint8_t>(kLightPitchLow + next_u32(rng) % 15);
  if (f->light_pitch > 0 && next_u32(rng) % 4 == 0) f->row_end = f->row_begin, f->run_count = 0;
  m.light_map.frame = next_u32(rng), m.light_map.light_ps = next_u32(rng), m.light_map.bytes = bytes;
  m.hello.price = price(), m.row_chunk.price = price(), m.pong.price = price(), m.light_map.price = price();
  return m;
}

inline std::vector<std::uint8_t> encoded(const Message& message) {
  std::vector<std::uint8_t> bytes(message_bytes(message));
  encode_message(message, bytes.data());
  return bytes;
}

}  // namespace pocketray
