#include "shade/trace_spans.h"

#include "base/check.h"
#include "shade/camera.h"
#include "shade/even_points.h"
#include "shade/filters.h"
#include "shade/indirect_light.h"
#include "shade/strip.h"
#include "shade/tile.h"

namespace pocketray {
namespace {

Vec3 same(float value) { return {value, value, value}; }

Vec3 in_model(const Scene& scene, const Vec3& p) {
  if (scene.origin.empty()) return p;
  const SceneOrigin& origin = scene.origin[0];
  return {static_cast<float>(origin.x + p.x), static_cast<float>(origin.y + p.y), static_cast<float>(origin.z + p.z)};
}

Vec3 pixel_aov(Tracer* tracer, std::uint32_t column, std::uint32_t row, Aov aov) {
  const FrameData& frame = *tracer->frame;
  if (aov == Aov::cost) {
    TraceStats before = tracer->stats;
    pixel_radiance(tracer, column, row);
    return same(static_cast<float>(tracer->stats.nodes - before.nodes + tracer->stats.triangles - before.triangles));
  }
  if (aov == Aov::indirect_light) return pixel_indirect_light(tracer, column, row);
  Ray ray = camera_ray(frame.view.camera, static_cast<float>(column) + 0.5f, static_cast<float>(row) + 0.5f);
  ++tracer->rays[static_cast<int>(RayKind::primary)];
  Hit hit;
  frame.geometry.accel_info->closest(frame.geometry.accel, ray, visible_filter(frame), &hit, &tracer->stats);
  Surface s;
  float passed;
  if (!visible_surface(tracer, &ray, &hit, &s, &passed)) return {0, 0, 0};
  if (aov == Aov::depth) return same(near_part(frame.view.camera, ray.direction) + passed + hit.t);
  if (aov == Aov::position) return in_model(*frame.scene, s.point);
  return aov == Aov::triangle ? same(static_cast<float>(hit.triangle + 1)) : s.normal;
}

// Appends the tile's pixels in Morton order.
void add_pixels(const TileStrip& strip, std::uint32_t index, std::uint32_t pitch, Tile* tile) {
  const std::uint32_t left = strip.column + index * kTileSide;
  for (std::uint64_t mask = strip.mask[index]; mask; mask &= mask - 1) {
    std::uint32_t m = static_cast<std::uint32_t>(__builtin_ctzll(mask));
    add_pixel((left + morton_column(m)) * pitch, (strip.row + morton_row(m)) * pitch, tile);
  }
}

// Rays of pixels that are not neighbours are faster one by one, unless packets are traced ray by ray anyway: a packet
// of rays 8 pixels apart takes up to 7 times the instructions (Buddha, AVX2).
void trace_pixels(Tracer* tracer, const Tile& tile, std::uint32_t pitch, const PixelRows& image) {
  const FrameData& frame = *tracer->frame;
  const bool adjacent = pitch == 1 || frame.geometry.accel_info->packets_by_rays;
  if (tile.count >= kPacketRaysMin && adjacent && !frame.geometry.ray_by_ray) return trace_tile(tracer, tile, image);
  for (std::uint32_t i = 0; i < tile.count; ++i)
    image.at(tile.column[i], tile.row[i]) = pixel_radiance(tracer, tile.column[i], tile.row[i]);
}

// Tiles with few rows share a packet with adjacent tiles, up to 64 pixels. Other tiles do not, even if they have few
// pixels: rays that are far apart have no boxes in common.
void trace_strip(Tracer* tracer, const TileStrip& strip, std::uint32_t pitch, const PixelRows& image) {
  if (strip.tile_count == 0) return;
  CHECK(strip.row_count >= 1 && strip.row_count <= kTileRows);
  const std::uint32_t tiles_max = packet_columns(strip.row_count) / kTileSide;
  Tile tile;
  for (std::uint32_t i = 0; i < strip.tile_count; i += tiles_max) {
    tile.count = 0;
    for (std::uint32_t k = i; k < i + tiles_max && k < strip.tile_count; ++k) add_pixels(strip, k, pitch, &tile);
    trace_pixels(tracer, tile, pitch, image);
  }
}

// Traces pixels of a coarse grid in blocks, each pixel with its own block.
void trace_blocks(Tracer* tracer, StripFunction trace, const Span& span, std::uint32_t pitch, const PixelRows& image) {
  const auto row = static_cast<std::uint16_t>(span.row * pitch);
  for (std::uint32_t x = span.column_begin * pitch; x < span.column_end * pitch; x += pitch) {
    const Span pixel = {row, static_cast<std::uint16_t>(x), static_cast<std::uint16_t>(x + 1)};
    TileStrip strip;
    make_strip(&pixel, 1, &strip);
    trace(tracer, strip, image);
  }
}

// Traces ray by ray, when rays share no origin or each is inspected separately.
void trace_span(Tracer* tracer, const Span& span, std::uint32_t pitch, Aov aov, const PixelRows& image) {
  const std::uint32_t row = span.row * pitch;
  for (std::uint32_t column = span.column_begin * pitch; column < span.column_end * pitch; column += pitch)
    image.at(column, row) =
        aov == Aov::none ? pixel_radiance(tracer, column, row) : pixel_aov(tracer, column, row, aov);
}

}  // namespace

Vec2 sample_offset(std::uint32_t sample, std::uint32_t sample_count) { return rook_point(sample, sample_count); }

Tracer make_tracer(const FrameData& frame) {
  CHECK(frame.scene != nullptr && frame.geometry.accel_info != nullptr);
  CHECK(frame.kernels.surface != nullptr && frame.kernels.radiance != nullptr && frame.geometry.first_rays != nullptr);
  Tracer tracer;
  tracer.frame = &frame;
  tracer.light_points = frame.lights.points.data;
  tracer.points_of_lamp = frame.settings.points_per_area_light;
  return tracer;
}

std::uint32_t strip_span_count(const Span* spans, std::uint32_t span_count) {
  std::uint32_t n = 0;
  while (n < span_count && spans[n].row >= spans[0].row && spans[n].row - spans[0].row < static_cast<int>(kTileRows))
    ++n;
  return n;
}

void trace_spans(Tracer* tracer, const Span* spans, std::uint32_t span_count, Aov aov, Vec3* image,
                 std::uint32_t pitch) {
  CHECK(tracer->frame != nullptr);
  CHECK_GT(pitch, 0u);
  CHECK(span_count == 0 || (spans != nullptr && image != nullptr));
  const FrameData& frame = *tracer->frame;
  for (std::uint32_t i = 0; i < span_count; ++i) {
    CHECK_LT(spans[i].row * pitch, frame.settings.height);
    CHECK_LE(spans[i].column_end, grid_side(frame.settings.width, pitch));
  }
  const PixelRows rows = {image, frame.settings.width, 0};
  const std::uint32_t sample_count = frame.settings.samples_per_pixel;
  CHECK(sample_count >= 1 && sample_count <= kSampleCountMax);
  // A grid coarser than the picture is a preview, in which nothing adjoins a pixel's edges.
  const StripFunction trace = has(frame.mask, Effect::edge_sampling) && pitch > 1 ? frame.kernels.trace_window_strip
                                                                                  : frame.kernels.trace_strip;
  if (aov == Aov::none && trace && pitch > 1) {
    tracer->window.row = ~0u;
    for (std::uint32_t i = 0; i < span_count; ++i) trace_blocks(tracer, trace, spans[i], pitch, rows);
    return;
  }
  if (aov != Aov::none || (!frame.view.camera.has_one_origin && !trace)) {
    for (std::uint32_t i = 0; i < span_count; ++i) trace_span(tracer, spans[i], pitch, aov, rows);
    return;
  }
  TileStrip strip;
  for (std::uint32_t i = 0, count; i < span_count; i += count) {
    count = strip_span_count(spans + i, span_count - i);
    CHECK_GT(count, 0u);
    make_strip(spans + i, count, &strip);
    trace ? trace(tracer, strip, rows) : trace_strip(tracer, strip, pitch, rows);
  }
}

}  // namespace pocketray
