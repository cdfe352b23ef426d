#include "shade/interleaved.h"

#include "base/check.h"
#include "base/fmath.h"
#include "shade/even_points.h"
#include "shade/pixel.h"
#include "shade/tile_shadows.h"

namespace pocketray {
namespace {

// An 8 × 8 tile at a multiple of eight, in Morton order; whole blocks, except at the picture's edge.
struct BlockTile {
  std::uint32_t count = 0;
  std::uint8_t place[kPacketMax];
  std::uint16_t column[kPacketMax], row[kPacketMax];
  bool wanted[kPacketMax];
};

// The pixels of all blocks that have a wanted one.
void list_pixels(const FrameData& frame, std::uint32_t left, std::uint32_t top, std::uint64_t wanted, BlockTile* tile) {
  tile->count = 0;
  for (std::uint32_t m = 0; m < kPacketMax; ++m) {
    std::uint32_t column = left + morton_column(m), row = top + morton_row(m);
    if (!(wanted >> (m & ~(kBlockPixels - 1)) & 0xFFFF)) continue;
    if (column >= frame.settings.width || row >= frame.settings.height) continue;
    std::uint32_t i = tile->count++;
    tile->place[i] = static_cast<std::uint8_t>(m);
    tile->column[i] = static_cast<std::uint16_t>(column), tile->row[i] = static_cast<std::uint16_t>(row);
    tile->wanted[i] = wanted >> m & 1;
  }
}

// First hits of a sample of the tile's pixels, with the surfaces there and, where known, the shadows of lights.
struct FirstHits {
  Ray ray[kPacketMax];
  Hit hit[kPacketMax];
  TileShadows shadows;
  bool knows_shadows;
};

void find_first_hits(Tracer* tracer, const BlockTile& tile, const Vec2& offset, FirstHits* first) {
  const FrameData& frame = *tracer->frame;
  for (std::uint32_t i = 0; i < tile.count; ++i) first->ray[i] = pixel_ray(frame, tile.column[i], tile.row[i], offset);
  first->knows_shadows = false;
  if (!frame.camera.orthographic && !frame.ray_by_ray) {
    RayPacket packet;
    packet.origin = frame.camera.eye, packet.t_max = __builtin_inff(), packet.count = tile.count;
    for (std::uint32_t i = 0; i < tile.count; ++i)
      for (int axis = 0; axis < 3; ++axis) packet.direction[axis][i] = first->ray[i].direction[axis];
    frame.first_rays->closest_packet(frame.accel, packet, visible_filter(frame), first->hit, &tracer->stats);
    first->knows_shadows = frame.find_shadows != nullptr;
    if (first->knows_shadows) return frame.find_shadows(frame, packet, first->hit, &first->shadows, &tracer->stats);
  } else {
    for (std::uint32_t i = 0; i < tile.count; ++i)
      frame.first_rays->closest(frame.accel, first->ray[i], visible_filter(frame), &first->hit[i], &tracer->stats);
  }
  for (std::uint32_t i = 0; i < tile.count; ++i)
    if (first->hit[i].triangle != kNoTriangle)
      frame.first_surface(frame, first->ray[i], first->hit[i], &first->shadows.surface[i]);
}

void trace_block_tile(Tracer* tracer, const BlockTile& tile, const PixelRows& image) {
  const FrameData& frame = *tracer->frame;
  const std::uint32_t sample_count = frame.settings.samples_per_pixel;
  if (sample_count > 1) effect_entered<Effect::supersampling>();
  Vec3 sum[kPacketMax] = {}, irradiance[kPacketMax];
  FirstHits first;
  for (std::uint32_t sample = 0; sample < sample_count; ++sample) {
    find_first_hits(tracer, tile, rook_point(sample, sample_count), &first);
    gather_virtual_light(frame, {tile.count, tile.place, first.shadows.surface, first.hit}, &tracer->stats,
                         &tracer->rays[static_cast<int>(RayKind::shadow)], irradiance);
    tracer->tile_shadows = first.knows_shadows ? &first.shadows : nullptr;
    for (std::uint32_t i = 0; i < tile.count; ++i) {
      if (!tile.wanted[i]) continue;
      Surface* s = &first.shadows.surface[i];
      bool hit = first.hit[i].triangle != kNoTriangle;
      if (hit) s->glow += s->diffuse * (irradiance[i] * (1 / kPiF));
      tracer->tile_pixel = i;
      tracer->first_surface = hit ? s : nullptr;
      sum[i] += sample_radiance(tracer, first.ray[i], first.hit[i], tracer->first_surface);
    }
  }
  tracer->first_surface = nullptr;
  tracer->tile_shadows = nullptr;
  for (std::uint32_t i = 0; i < tile.count; ++i)
    if (tile.wanted[i]) image.at(tile.column[i], tile.row[i]) = sum[i] * (1.0f / static_cast<float>(sample_count));
}

}  // namespace

void trace_interleaved(Tracer* tracer, const TileStrip& strip, const PixelRows& image) {
  if (strip.tile_count == 0) return;
  CHECK(strip.row_count >= 1 && strip.row_count <= kTileRows);
  AlignedTiles tiles;
  align_tiles(strip, &tiles);
  BlockTile tile;
  for (std::uint32_t r = 0; r < 2; ++r)
    for (std::uint32_t c = 0; c < tiles.tile_count; ++c) {
      if (!tiles.mask[r][c]) continue;
      list_pixels(*tracer->frame, tiles.column + c * kTileSide, tiles.row + r * kTileSide, tiles.mask[r][c], &tile);
      trace_block_tile(tracer, tile, image);
    }
}

}  // namespace pocketray
