#include "shade/tile.h"

#include "base/check.h"
#include "effect/effect_probe.h"
#include "shade/even_points.h"
#include "shade/filters.h"
#include "shade/pixel.h"
#include "shade/sample_points.h"
#include "shade/strip.h"
#include "shade/tile_shadows.h"

namespace pocketray {
namespace {

// Sets the directions of camera_ray() for a tile's pixels; what columns or rows share is computed once.
void set_directions(const CameraRays& camera, const Tile& tile, const Vec2& offset, RayPacket* packet) {
  constexpr std::uint32_t kKept = 8;  // columns and rows of a full tile
  constexpr std::uint32_t kNone = 0xFFFFFFFF;
  std::uint32_t column[kKept], row[kKept];
  Vec3 across[kKept], down[kKept];
  for (std::uint32_t k = 0; k < kKept; ++k) column[k] = row[k] = kNone;
  for (std::uint32_t i = 0; i < tile.count; ++i) {
    const std::uint32_t x = tile.column[i], y = tile.row[i], c = x % kKept, r = y % kKept;
    if (column[c] != x) column[c] = x, across[c] = column_part(camera, static_cast<float>(x) + offset.x);
    if (row[r] != y) row[r] = y, down[r] = row_part(camera, static_cast<float>(y) + offset.y);
    const Vec3 direction = normalize(across[c] + down[r]);
    for (int axis = 0; axis < 3; ++axis) packet->direction[axis][i] = direction[axis];
  }
}

// Threads trace pixels for those of others around them, too, and store equal values.
[[gnu::noinline]] void keep_for_neighbours(const Hit& hit, Hit* kept) {
  Hit stored = hit;
  __atomic_store(&kept->t, &stored.t, __ATOMIC_RELAXED);
  __atomic_store(&kept->u, &stored.u, __ATOMIC_RELAXED);
  __atomic_store(&kept->v, &stored.v, __ATOMIC_RELAXED);
  __atomic_store(&kept->triangle, &stored.triangle, __ATOMIC_RELAXED);
}

}  // namespace

void keep_first_hit(Tracer* tracer, std::uint32_t sample, std::uint32_t column, std::uint32_t row, const Hit& hit) {
  const FrameData& frame = *tracer->frame;
  std::size_t width = frame.settings.width;
  Hit* kept = &frame.kept.first_hits[(std::size_t(sample) * frame.settings.height + row) * width + column];
  if (has(frame.mask, Effect::edge_sampling))
    keep_for_neighbours(hit, kept);
  else
    *kept = hit;
}

void observe_pixel(Tracer* tracer, std::uint32_t column, std::uint32_t row) {
  if (RayObserver* observer = tracer->stats.observer)
    observer->column = static_cast<std::uint16_t>(column), observer->row = static_cast<std::uint16_t>(row);
}

Vec3 pixel_radiance(Tracer* tracer, std::uint32_t column, std::uint32_t row, Surface* first) {
  const FrameData& frame = *tracer->frame;
  CHECK(column < frame.settings.width && row < frame.settings.height);
  std::uint32_t sample_count = frame.settings.samples_per_pixel;
  if (sample_count > 1) effect_entered<Effect::supersampling>();
  Vec3 sum = {0, 0, 0};
  observe_pixel(tracer, column, row);
  for (std::uint32_t sample = 0; sample < sample_count; ++sample) {
    use_points_of(tracer, sample);
    Ray ray = pixel_ray(frame, column, row, rook_point(sample, sample_count));
    Hit hit;
    frame.geometry.first_rays->closest(frame.geometry.accel, ray, visible_filter(frame), &hit, &tracer->stats);
    if (frame.kept.first_hits) keep_first_hit(tracer, sample, column, row, hit);
    Surface surface;
    if (first && sample == 0) first->material = nullptr;
    if ((frame.kept.first_hits || (first && sample == 0)) && hit.triangle != kNoTriangle) {
      frame.kernels.surface(frame, ray, hit, &surface);
      tracer->first_surface = &surface;
      if (first && sample == 0) *first = surface;
    }
    sum += sample_radiance(tracer, ray, hit, tracer->first_surface);
    tracer->first_surface = nullptr;
  }
  return sum * (1.0f / static_cast<float>(sample_count));
}

void add_sample(Tracer* tracer, const Tile& tile, const RayPacket& packet, const Hit* hits, Vec3* sum) {
  const FrameData& frame = *tracer->frame;
  CHECK_EQ(tile.count, packet.count);
  TileShadows shadows;
  if (frame.kernels.find_shadows) {
    frame.kernels.find_shadows(tracer, packet, hits, &shadows);
    tracer->tile_shadows = &shadows;
  }
  const bool has_plain_background = !has(frame.mask, Effect::environment);
  std::uint32_t missed = 0;
  for (std::uint32_t i = 0; i < tile.count; ++i) {
    if (hits[i].triangle == kNoTriangle && has_plain_background) {
      sum[i] += frame.scene->info.background;
      ++missed;
      continue;
    }
    tracer->tile_pixel = i;
    tracer->first_surface =
        frame.kernels.find_shadows && hits[i].triangle != kNoTriangle ? &shadows.surface[i] : nullptr;
    observe_pixel(tracer, tile.column[i], tile.row[i]);
    sum[i] += sample_radiance(tracer, ray_of(packet, i), hits[i], tracer->first_surface);
  }
  tracer->rays[static_cast<int>(RayKind::primary)] += missed;
  tracer->first_surface = nullptr;
  tracer->tile_shadows = nullptr;
}

void trace_tile(Tracer* tracer, const Tile& tile, const PixelRows& image) {
  const FrameData& frame = *tracer->frame;
  std::uint32_t sample_count = frame.settings.samples_per_pixel;
  if (sample_count > 1) effect_entered<Effect::supersampling>();
  Vec3 sum[kPacketMax] = {};
  RayPacket packet;
  packet.origin = frame.view.camera.eye, packet.t_max = __builtin_inff(), packet.count = tile.count;
  for (std::uint32_t sample = 0; sample < sample_count; ++sample) {
    use_points_of(tracer, sample);
    set_directions(frame.view.camera, tile, rook_point(sample, sample_count), &packet);
    Hit hits[kPacketMax];
    frame.geometry.first_rays->closest_packet(frame.geometry.accel, packet, visible_filter(frame), hits,
                                              &tracer->stats);
    if (frame.kept.first_hits)
      for (std::uint32_t i = 0; i < tile.count; ++i)
        keep_first_hit(tracer, sample, tile.column[i], tile.row[i], hits[i]);
    add_sample(tracer, tile, packet, hits, sum);
  }
  for (std::uint32_t i = 0; i < tile.count; ++i)
    image.at(tile.column[i], tile.row[i]) = sum[i] * (1.0f / static_cast<float>(sample_count));
}

}  // namespace pocketray
