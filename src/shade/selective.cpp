#include "shade/selective.h"

#include <algorithm>

#include "base/check.h"
#include "effect/effect_probe.h"
#include "shade/filters.h"
#include "shade/pixel.h"
#include "shade/tile.h"

namespace pocketray {
namespace {

// Fewer camera rays are traced one by one: measured by bench-device for 1 to 33 (Cortex-A7, the built-in scenes). Only
// their surfaces are needed at first, not their light, hence fewer than kPacketRaysMin.
constexpr std::uint32_t kCameraRaysMin = 8;

// A tile with the corners of its cells, by column and row.
struct CellTile {
  Tracer* tracer;
  std::uint32_t column, row;  // of the first pixel
  CellCorner corner[3][3];

  const FrameData& frame() const { return *tracer->frame; }
};

// Column of a corner's pixel: the picture's last cells end at its edge.
std::uint32_t corner_column(const CellTile& tile, std::uint32_t i) {
  return std::min(tile.column + i * kCellSide, tile.frame().settings.width - 1);
}
std::uint32_t corner_row(const CellTile& tile, std::uint32_t k) {
  return std::min(tile.row + k * kCellSide, tile.frame().settings.height - 1);
}

// Returns the thread's slot for the corner, or null. A new row of corners below the tile replaces an old one.
CellCorner* kept_corner(const CellTile& tile, std::uint32_t i, std::uint32_t k) {
  const std::uint32_t row = tile.row + k * kCellSide;
  const std::uint32_t count = tile.tracer->corner_row_count;
  if (count == 0 || (count == 2 && k == 1)) return nullptr;
  CornerRow* kept = &tile.tracer->corner_rows[row / (count == 2 ? kTileSide : kCellSide) % count];
  if (kept->row != row) {
    if (k == 0) return nullptr;
    kept->row = row;
    for (CellCorner& corner : kept->corners) corner.known = false;
  }
  CHECK_LT(tile.column / kCellSide + i, kept->corners.count);
  return &kept->corners[tile.column / kCellSide + i];
}

const CellCorner& corner_at(CellTile* tile, std::uint32_t i, std::uint32_t k) {
  CellCorner& corner = tile->corner[i][k];
  if (corner.known) return corner;
  if (i > 0 && corner_column(*tile, i) == corner_column(*tile, i - 1)) return corner = corner_at(tile, i - 1, k);
  if (k > 0 && corner_row(*tile, k) == corner_row(*tile, k - 1)) return corner = corner_at(tile, i, k - 1);
  CellCorner* kept = kept_corner(*tile, i, k);
  if (kept && kept->known) return corner = *kept;
  Surface s;
  corner.radiance = pixel_radiance(tile->tracer, corner_column(*tile, i), corner_row(*tile, k), &s);
  corner.material = s.material;
  corner.is_smooth = !s.material || has_smooth_light(tile->frame(), s);
  if (s.material) corner.diffuse = s.diffuse, corner.glow = s.glow, corner.normal = s.normal;
  corner.known = true;
  if (kept) *kept = corner;
  return corner;
}

PixelCell cell_at(CellTile* tile, std::uint32_t i, std::uint32_t k) {
  PixelCell cell;
  for (std::uint32_t c = 0; c < 4; ++c) cell.corner[c] = &corner_at(tile, i + c % 2, k + c / 2);
  const std::uint32_t width = corner_column(*tile, i + 1) - corner_column(*tile, i);
  const std::uint32_t height = corner_row(*tile, k + 1) - corner_row(*tile, k);
  cell.across = 1 / static_cast<float>(std::max(width, 1u)), cell.down = 1 / static_cast<float>(std::max(height, 1u));
  return cell;
}

// Interpolates the pixels of a cell in the mask, by their places in the tile.
void interpolate(const CellTile& tile, const PixelCell& cell, std::uint64_t mask, const PixelRows& image) {
  const Vec3 &a = cell.corner[0]->radiance, &b = cell.corner[1]->radiance;
  const Vec3 &c = cell.corner[2]->radiance, &d = cell.corner[3]->radiance;
  for (; mask; mask &= mask - 1) {
    const auto m = static_cast<std::uint32_t>(__builtin_ctzll(mask));
    const std::uint32_t column = morton_column(m), row = morton_row(m);
    const float x = static_cast<float>(column % kCellSide) * cell.across;
    const float y = static_cast<float>(row % kCellSide) * cell.down;
    const Vec3 left = a + (c - a) * y, right = b + (d - b) * y;
    image.at(tile.column + column, tile.row + row) = left + (right - left) * x;
  }
}

// Pixels of a tile that are not interpolated, with their cells.
struct Doubtful {
  Tile tile;
  PixelCell cell[4];
  std::uint8_t place[kPacketMax];  // in the tile, in Morton order: 16 to a cell
};

// Takes a pixel's light from its cell's corners if they predict it. `s` receives the surface that the ray hits, if any.
bool take_light(Tracer* tracer, const Doubtful& pixels, std::uint32_t i, const Ray& ray, const Hit& hit, Surface* s,
                Vec3* radiance) {
  if (hit.triangle == kNoTriangle) return false;
  tracer->frame->kernels.surface(*tracer->frame, ray, hit, s);
  const std::uint32_t m = pixels.place[i], column = morton_column(m) % kCellSide, row = morton_row(m) % kCellSide;
  const PixelCell& cell = pixels.cell[m / (kCellSide * kCellSide)];
  if (!predict(*tracer->frame, cell, tracer->frame->selection.contrast, *s, column, row, radiance)) return false;
  ++tracer->rays[static_cast<int>(RayKind::primary)];
  return true;
}

void trace_together(Tracer* tracer, const Doubtful& pixels, const PixelRows& image) {
  const FrameData& frame = *tracer->frame;
  const Tile& tile = pixels.tile;
  RayPacket packet, rays;
  packet.origin = frame.view.camera.eye, packet.t_max = __builtin_inff(), packet.count = tile.count;
  for (std::uint32_t i = 0; i < tile.count; ++i) {
    const Vec3 direction = pixel_ray(frame, tile.column[i], tile.row[i], {0.5f, 0.5f}).direction;
    for (int axis = 0; axis < 3; ++axis) packet.direction[axis][i] = direction[axis];
  }
  Hit hits[kPacketMax];
  frame.geometry.first_rays->closest_packet(frame.geometry.accel, packet, visible_filter(frame), hits, &tracer->stats);
  Tile shaded;
  for (std::uint32_t i = 0; i < tile.count; ++i) {
    Surface s;
    Vec3* pixel = &image.at(tile.column[i], tile.row[i]);
    if (take_light(tracer, pixels, i, ray_of(packet, i), hits[i], &s, pixel)) continue;
    for (int axis = 0; axis < 3; ++axis) rays.direction[axis][shaded.count] = packet.direction[axis][i];
    hits[shaded.count] = hits[i];
    add_pixel(tile.column[i], tile.row[i], &shaded);
  }
  if (shaded.count == 0) return;
  rays.origin = packet.origin, rays.t_max = packet.t_max, rays.count = shaded.count;
  Vec3 sum[kPacketMax] = {};
  add_sample(tracer, shaded, rays, hits, sum);
  for (std::uint32_t i = 0; i < shaded.count; ++i) image.at(shaded.column[i], shaded.row[i]) = sum[i];
}

void trace_one(Tracer* tracer, const Doubtful& pixels, std::uint32_t i, const PixelRows& image) {
  const FrameData& frame = *tracer->frame;
  const Ray ray = pixel_ray(frame, pixels.tile.column[i], pixels.tile.row[i], {0.5f, 0.5f});
  Hit hit;
  frame.geometry.first_rays->closest(frame.geometry.accel, ray, visible_filter(frame), &hit, &tracer->stats);
  Surface s;
  Vec3* pixel = &image.at(pixels.tile.column[i], pixels.tile.row[i]);
  if (take_light(tracer, pixels, i, ray, hit, &s, pixel)) return;
  tracer->first_surface = hit.triangle != kNoTriangle ? &s : nullptr;
  *pixel = sample_radiance(tracer, ray, hit, tracer->first_surface);
  tracer->first_surface = nullptr;
}

void trace_doubtful(Tracer* tracer, const Doubtful& pixels, const PixelRows& image) {
  const FrameData& frame = *tracer->frame;
  const Tile& tile = pixels.tile;
  const bool has_packets = !frame.geometry.ray_by_ray && frame.view.camera.has_one_origin;
  if (frame.settings.samples_per_pixel == 1) {
    if (has_packets && tile.count >= kCameraRaysMin) return trace_together(tracer, pixels, image);
    for (std::uint32_t i = 0; i < tile.count; ++i) trace_one(tracer, pixels, i, image);
    return;
  }
  // A pixel with several samples has no single surface.
  if (has_packets && tile.count >= kPacketRaysMin) return trace_tile(tracer, tile, image);
  for (std::uint32_t i = 0; i < tile.count; ++i)
    image.at(tile.column[i], tile.row[i]) = pixel_radiance(tracer, tile.column[i], tile.row[i]);
}

// Traces the wanted pixels of a tile, cell by cell.
void trace_cells(CellTile* tile, std::uint64_t wanted, const PixelRows& image) {
  constexpr std::uint32_t kCellPixels = kCellSide * kCellSide;
  const FrameData& frame = tile->frame();
  Doubtful doubtful;
  for (std::uint32_t c = 0; c < 4; ++c) {
    const std::uint64_t cell_mask = ((std::uint64_t(1) << kCellPixels) - 1) << kCellPixels * c;
    const std::uint64_t corner_mask = std::uint64_t(1) << kCellPixels * c;
    const std::uint32_t i = c % 2, k = c / 2;
    std::uint64_t mask = wanted & cell_mask;
    if (mask & corner_mask) image.at(corner_column(*tile, i), corner_row(*tile, k)) = corner_at(tile, i, k).radiance;
    mask &= ~corner_mask;
    if (!mask) continue;
    const PixelCell cell = doubtful.cell[c] = cell_at(tile, i, k);
    if (is_flat(frame, cell, frame.selection.contrast)) {
      interpolate(*tile, cell, mask, image);
      continue;
    }
    for (; mask; mask &= mask - 1) {
      const auto m = static_cast<std::uint32_t>(__builtin_ctzll(mask));
      doubtful.place[doubtful.tile.count] = static_cast<std::uint8_t>(m);
      add_pixel(tile->column + morton_column(m), tile->row + morton_row(m), &doubtful.tile);
    }
  }
  trace_doubtful(tile->tracer, doubtful, image);
}

// Moves to the next tile to the right, which shares a column of corners.
void move_right(CellTile* tile) {
  for (int k = 0; k < 3; ++k) {
    tile->corner[0][k] = tile->corner[2][k];
    tile->corner[1][k].known = tile->corner[2][k].known = false;
  }
  tile->column += kTileSide;
}

}  // namespace

void keep_corner_rows(Array<CellCorner> rows, Tracer* tracer) {
  CHECK(tracer->frame != nullptr);
  const std::uint32_t count = corner_count(tracer->frame->settings.width);
  tracer->corner_row_count = rows.count / count;
  CHECK(rows.count == 2 * count || rows.count == 4 * count);
  for (std::uint32_t i = 0; i < tracer->corner_row_count; ++i)
    tracer->corner_rows[i] = {{rows.data + i * count, count}, ~0u};
}

void trace_selectively(Tracer* tracer, const TileStrip& strip, const PixelRows& image) {
  effect_entered<Effect::selective>();
  if (strip.tile_count == 0) return;
  CHECK(strip.row_count >= 1 && strip.row_count <= kTileRows);
  AlignedTiles tiles;
  align_tiles(strip, &tiles);
  for (std::uint32_t r = 0; r < 2; ++r) {
    CellTile tile;
    tile.tracer = tracer, tile.column = tiles.column, tile.row = tiles.row + r * kTileSide;
    for (std::uint32_t c = 0; c < tiles.tile_count; ++c) {
      if (tiles.mask[r][c]) trace_cells(&tile, tiles.mask[r][c], image);
      move_right(&tile);
    }
  }
}

}  // namespace pocketray
