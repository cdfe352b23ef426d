#include "shade/interleaved.h"

#include <algorithm>

#include "base/check.h"
#include "shade/even_points.h"
#include "shade/pixel.h"
#include "shade/sample_points.h"
#include "shade/shared_pixels.h"
#include "shade/tile.h"
#include "shade/tile_shadows.h"

namespace pocketray {
namespace {

// Neighbouring pixels show the same surface if they hit the same triangle, or if their normals are closer than this
// cosine and the second point lies off the first one's plane by at most this slope.
constexpr float kSameNormal = 0.9f, kSamePlane = 0.15f;
// Fewer pixels cover too few sources to represent all.
constexpr std::uint32_t kSharersMin = 4;

// A region is an aligned tile with a border of the pixels from which its pixels take light, by rows.
constexpr std::uint32_t kRegionSide = kTakenBefore + kTileSide + kTakenAfter;
constexpr std::uint32_t kRegionPixels = kRegionSide * kRegionSide;
enum class Link : std::uint8_t { unknown, different, same };
struct Region {
  bool is_one_surface;  // all of its pixels show one surface, and so do all from which wanted pixels take light
  InterleavedPixel pixel[kRegionPixels];
  Link right[kRegionPixels], below[kRegionPixels];  // whether the next pixel shows the same surface
  InterleavedLight column[kRegionPixels];           // sums along columns for one source; starts with no pixels
};

bool is_known(const InterleavedPixel& pixel) { return pixel.row != kNone; }
bool is_hit(const InterleavedPixel& pixel) { return is_known(pixel) && pixel.triangle != kNone; }

// Pixels to trace in packets. Columns and rows are relative to the region.
struct PixelList {
  std::uint32_t count = 0;
  std::uint8_t column[kRegionPixels] = {}, row[kRegionPixels] = {};

  constexpr void add(std::uint32_t c, std::uint32_t r) {
    column[count] = static_cast<std::uint8_t>(c), row[count++] = static_cast<std::uint8_t>(r);
  }
};
struct PixelLists {
  PixelList wanted;  // in Morton order
  PixelList others;  // the pixels around them within the picture
};

struct SharedTile {
  std::uint32_t column, row;  // of the region's tile in the picture
  const PixelLists* lists;
};

constexpr PixelLists all_pixels() {
  PixelLists lists;
  for (std::uint32_t m = 0; m < kPacketMax; ++m)
    lists.wanted.add(morton_column(m) + kTakenBefore, morton_row(m) + kTakenBefore);
  for (std::uint32_t row = 0; row < kRegionSide; ++row)
    for (std::uint32_t column = 0; column < kRegionSide; ++column)
      if (column - kTakenBefore >= kTileSide || row - kTakenBefore >= kTileSide) lists.others.add(column, row);
  return lists;
}
constexpr PixelLists kAllPixels = all_pixels();  // for a tile that is wanted whole and lies within the picture

// Lists the tile's pixels in the mask and the pixels around them.
void list_pixels(const Settings& settings, std::uint64_t mask, PixelLists* room, SharedTile* tile) {
  if (mask == ~std::uint64_t(0) && tile->column >= kTakenBefore && tile->row >= kTakenBefore &&
      tile->column + kTileSide + kTakenAfter <= settings.width &&
      tile->row + kTileSide + kTakenAfter <= settings.height) {
    tile->lists = &kAllPixels;
    return;
  }
  tile->lists = room;
  bool is_wanted[kRegionPixels] = {}, is_taken[kRegionPixels] = {};
  room->wanted.count = room->others.count = 0;
  for (std::uint32_t m = 0; m < kPacketMax; ++m) {
    const std::uint32_t column = morton_column(m), row = morton_row(m);
    if (!(mask >> m & 1) || tile->column + column >= settings.width || tile->row + row >= settings.height) continue;
    room->wanted.add(column + kTakenBefore, row + kTakenBefore);
    is_wanted[(row + kTakenBefore) * kRegionSide + column + kTakenBefore] = true;
    for (std::uint32_t y = row; y < row + kPatternSide; ++y)
      std::fill_n(&is_taken[y * kRegionSide + column], kPatternSide, true);
  }
  for (std::uint32_t i = 0; i < kRegionPixels; ++i) {
    const std::uint32_t column = i % kRegionSide, row = i / kRegionSide;
    const std::uint32_t x = tile->column + column - kTakenBefore, y = tile->row + row - kTakenBefore;  // wraps
    if (is_taken[i] && !is_wanted[i] && x < settings.width && y < settings.height) room->others.add(column, row);
  }
}

// First hits of one sample of some pixels, with their surfaces and, where known, the shadows of lights.
struct FirstHits {
  Ray ray[kPacketMax];
  Hit hit[kPacketMax];
  TileShadows shadows;
  bool knows_shadows;
};

void find_first_hits(Tracer* tracer, const SharedTile& tile, const PixelList& pixels, std::uint32_t begin,
                     std::uint32_t count, const Vec2& offset, bool with_shadows, FirstHits* first) {
  const FrameData& frame = *tracer->frame;
  CHECK_LE(count, kPacketMax);
  for (std::uint32_t i = 0; i < count; ++i)
    first->ray[i] = pixel_ray(frame, tile.column + pixels.column[begin + i] - kTakenBefore,
                              tile.row + pixels.row[begin + i] - kTakenBefore, offset);
  first->knows_shadows = false;
  if (!frame.view.camera.orthographic && !frame.geometry.ray_by_ray) {
    RayPacket packet;
    packet.origin = frame.view.camera.eye, packet.t_max = __builtin_inff(), packet.count = count;
    for (std::uint32_t i = 0; i < count; ++i)
      for (int axis = 0; axis < 3; ++axis) packet.direction[axis][i] = first->ray[i].direction[axis];
    frame.geometry.first_rays->closest_packet(frame.geometry.accel, packet, visible_filter(frame), first->hit,
                                              &tracer->stats);
    first->knows_shadows = with_shadows && frame.kernels.find_shadows != nullptr;
    if (first->knows_shadows) return frame.kernels.find_shadows(tracer, packet, first->hit, &first->shadows);
  } else {
    for (std::uint32_t i = 0; i < count; ++i)
      frame.geometry.first_rays->closest(frame.geometry.accel, first->ray[i], visible_filter(frame), &first->hit[i],
                                         &tracer->stats);
  }
  for (std::uint32_t i = 0; i < count; ++i)
    if (first->hit[i].triangle != kNoTriangle)
      frame.kernels.first_surface(frame, first->ray[i], first->hit[i], &first->shadows.surface[i]);
}

// Lists the indices in KeptRays::compensation_paths of one sample of some of the region's pixels.
void list_paths(const Settings& settings, const SharedTile& tile, std::uint32_t sample, std::uint32_t count,
                const std::uint8_t* in_region, std::uint32_t* pixel) {
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::uint32_t column = tile.column + in_region[i] % kRegionSide - kTakenBefore,
                        row = tile.row + in_region[i] / kRegionSide - kTakenBefore;
    pixel[i] = (sample * settings.height + row) * settings.width + column;
  }
}

// Gathers light at the pixels of the list from `begin` on and stores it in the region, which lacks them.
void gather(Tracer* tracer, const SharedTile& tile, std::uint32_t sample, const PixelList& pixels, std::uint32_t begin,
            std::uint32_t count, const FirstHits& first, Region* region) {
  const FrameData& frame = *tracer->frame;
  const Surface* surface[kPacketMax];
  std::uint8_t place[kPacketMax], in_region[kPacketMax];
  InterleavedLight light[kPacketMax];
  std::uint32_t found = 0;
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::uint32_t column = pixels.column[begin + i], row = pixels.row[begin + i], k = row * kRegionSide + column;
    InterleavedPixel* pixel = &region->pixel[k];
    if (is_known(*pixel)) continue;
    pixel->row = tile.row + row - kTakenBefore, pixel->triangle = kNone;
    if (first.hit[i].triangle == kNoTriangle) continue;
    const Surface& s = first.shadows.surface[i];
    pixel->triangle = s.hit.triangle, pixel->point = s.point, pixel->normal = s.normal, pixel->geometric = s.geometric;
    surface[found] = &s, in_region[found] = static_cast<std::uint8_t>(k);
    place[found++] = static_cast<std::uint8_t>(morton_place((tile.column + column - kTakenBefore) % kPatternSide,
                                                            (tile.row + row - kTakenBefore) % kPatternSide));
  }
  if (found == 0) return;
  std::uint32_t path[kPacketMax];
  if (frame.kept.compensation_paths) list_paths(frame.settings, tile, sample, found, in_region, path);
  const InterleavedPoints points = {found, surface, place, frame.kept.compensation_paths ? path : nullptr};
  for (int source = 0; source < kInterleavedSourceCount; ++source) {
    if (!has(frame.mask, kInterleavedSources[source]->effect)) continue;
    kInterleavedSources[source]->gather(frame, points, &tracer->stats, &tracer->rays[static_cast<int>(RayKind::shadow)],
                                        light);
    for (std::uint32_t i = 0; i < found; ++i) region->pixel[in_region[i]].light[source] = light[i];
  }
}

void link_neighbours(Region* region) {
  bool is_one_surface = true;
  auto link = [&](std::uint32_t a, std::uint32_t b, Link* l) {
    const InterleavedPixel &p = region->pixel[a], &q = region->pixel[b];
    if (*l == Link::unknown && is_known(q)) *l = is_hit(q) && shows_same(p, q) ? Link::same : Link::different;
    is_one_surface &= *l == Link::same;
  };
  for (std::uint32_t k = 0; k < kRegionPixels; ++k) {
    if (!is_hit(region->pixel[k])) {
      is_one_surface = false;
      continue;
    }
    if (k % kRegionSide + 1 < kRegionSide) link(k, k + 1, &region->right[k]);
    if (k + kRegionSide < kRegionPixels) link(k, k + kRegionSide, &region->below[k]);
  }
  region->is_one_surface = is_one_surface;
}

// Calls visit(k) for a pixel and the pixels in reach along its row or column that are linked to it by one surface.
template <class Visit>
void along(const Link* links, std::uint32_t step, std::uint32_t own, Visit visit) {
  visit(own);
  for (std::uint32_t k = own, i = 0; i < kTakenBefore && links[k - step] == Link::same; ++i) visit(k -= step);
  for (std::uint32_t k = own, i = 0; i < kTakenAfter && links[k] == Link::same; ++i) visit(k += step);
}

void add(const InterleavedLight& light, InterleavedLight* sum) {
  sum->lit += light.lit, sum->open += light.open, sum->pixel_count += light.pixel_count;
}

constexpr InterleavedLight kNoLight = {{0, 0, 0}, {0, 0, 0}, 0};

// Sums light(k) over everything along() would visit if all links held, in the same order.
template <class Light>
InterleavedLight sum_of_all(std::uint32_t step, std::uint32_t own, bool with_open, Light light) {
  InterleavedLight sum = light(own);
  auto take = [&](const InterleavedLight& other) {
    sum.lit += other.lit, sum.pixel_count += other.pixel_count;
    if (with_open) sum.open += other.open;
  };
  for (std::uint32_t i = 1; i <= kTakenBefore; ++i) take(light(own - i * step));
  for (std::uint32_t i = 1; i <= kTakenAfter; ++i) take(light(own + i * step));
  return sum;
}

// Keeps a pixel's surface, unless it reflects nothing, for keep_sum().
void keep_surfaces(Tracer* tracer, const SharedTile& tile, const Region& region, const FirstHits& first) {
  if (!is_shared(tracer->window)) return;
  const PixelList& wanted = tile.lists->wanted;
  for (std::uint32_t i = 0; i < wanted.count; ++i) {
    const std::uint32_t column = wanted.column[i], row = wanted.row[i];
    SharedPixel* shared = shared_pixel(tracer, tile.column + column - kTakenBefore, tile.row + row - kTakenBefore);
    shared->pixel = region.pixel[row * kRegionSide + column];
    if (is_hit(shared->pixel) && is_zero(first.shadows.surface[i].diffuse)) shared->pixel.triangle = kNone;
  }
}

// Keeps the light that pixel `i` of the wanted ones takes from its neighbours.
void keep_sum(Tracer* tracer, const SharedTile& tile, std::uint32_t i, int source, const InterleavedLight& sum,
              bool are_few) {
  const PixelList& wanted = tile.lists->wanted;
  SharedPixel* shared =
      shared_pixel(tracer, tile.column + wanted.column[i] - kTakenBefore, tile.row + wanted.row[i] - kTakenBefore);
  if (shared) shared->pixel.light[source] = sum, shared->are_few[source] = are_few;
}

// Fast path of add_shared_light() for a region that shows a single surface.
void add_light_of_one_surface(Tracer* tracer, const SharedTile& tile, int source, Region* region, FirstHits* first) {
  CHECK(region->is_one_surface);
  const FrameData& frame = *tracer->frame;
  const PixelList& wanted = tile.lists->wanted;
  const InterleavedSource& info = *kInterleavedSources[source];
  const bool with_open = info.reads_open || is_shared(tracer->window);
  for (std::uint32_t k = kTakenBefore * kRegionSide; k < (kTakenBefore + kTileSide) * kRegionSide; ++k)
    region->column[k] =
        sum_of_all(kRegionSide, k, with_open, [&](std::uint32_t at) { return region->pixel[at].light[source]; });
  for (std::uint32_t i = 0; i < wanted.count; ++i) {
    Surface& s = first->shadows.surface[i];
    if (is_zero(s.diffuse)) continue;
    const InterleavedLight sum = sum_of_all(1, wanted.row[i] * kRegionSide + wanted.column[i], with_open,
                                            [&](std::uint32_t at) { return region->column[at]; });
    keep_sum(tracer, tile, i, source, sum, false);
    s.glow += s.diffuse * info.irradiance(frame, s.point, s.normal, sum, false);
  }
}

// Adds the light that the wanted pixels share with their neighbours to their surfaces' glow.
void add_shared_light(Tracer* tracer, const SharedTile& tile, Region* region, FirstHits* first) {
  const FrameData& frame = *tracer->frame;
  const PixelList& wanted = tile.lists->wanted;
  keep_surfaces(tracer, tile, *region, *first);
  for (int source = 0; source < kInterleavedSourceCount; ++source) {
    if (!has(frame.mask, kInterleavedSources[source]->effect)) continue;
    if (region->is_one_surface) {
      add_light_of_one_surface(tracer, tile, source, region, first);
      continue;
    }
    std::fill_n(region->column, kRegionPixels, kNoLight);
    for (std::uint32_t i = 0; i < wanted.count; ++i) {
      Surface& s = first->shadows.surface[i];
      if (first->hit[i].triangle == kNoTriangle || is_zero(s.diffuse)) continue;
      InterleavedLight sum = kNoLight;
      along(region->right, 1, wanted.row[i] * kRegionSide + wanted.column[i], [&](std::uint32_t in_row) {
        InterleavedLight* column = &region->column[in_row];
        if (column->pixel_count == 0)
          along(region->below, kRegionSide, in_row,
                [&](std::uint32_t k) { add(region->pixel[k].light[source], column); });
        add(*column, &sum);
      });
      const bool are_few = sum.pixel_count < kSharersMin;
      if (are_few) {
        sum = kNoLight;
        for (std::uint32_t k = 0; k < kPatternPixels; ++k) {
          const std::uint32_t column = wanted.column[i] - kTakenBefore + k % kPatternSide;
          const std::uint32_t row = wanted.row[i] - kTakenBefore + k / kPatternSide;
          const InterleavedPixel& pixel = region->pixel[row * kRegionSide + column];
          if (is_hit(pixel)) add(pixel.light[source], &sum);
        }
      }
      keep_sum(tracer, tile, i, source, sum, are_few);
      s.glow += s.diffuse * kInterleavedSources[source]->irradiance(frame, s.point, s.normal, sum, are_few);
    }
  }
}

// Traces one sample of the tile's wanted pixels and adds it to the image.
void trace_sample(Tracer* tracer, const SharedTile& tile, std::uint32_t sample, const PixelRows& image,
                  Region* region) {
  const FrameData& frame = *tracer->frame;
  const std::uint32_t sample_count = frame.settings.samples_per_pixel;
  const Vec2 offset = rook_point(sample, sample_count);
  const PixelList& wanted = tile.lists->wanted;
  FirstHits first;
  PixelList lacking;
  use_points_of(tracer, sample);
  for (std::uint32_t i = 0; i < tile.lists->others.count; ++i)
    if (!is_known(region->pixel[tile.lists->others.row[i] * kRegionSide + tile.lists->others.column[i]]))
      lacking.add(tile.lists->others.column[i], tile.lists->others.row[i]);
  for (std::uint32_t begin = 0; begin < lacking.count; begin += kPacketMax) {
    const std::uint32_t count = std::min(lacking.count - begin, kPacketMax);
    find_first_hits(tracer, tile, lacking, begin, count, offset, false, &first);
    gather(tracer, tile, sample, lacking, begin, count, first, region);
  }
  find_first_hits(tracer, tile, wanted, 0, wanted.count, offset, true, &first);
  gather(tracer, tile, sample, wanted, 0, wanted.count, first, region);
  link_neighbours(region);
  add_shared_light(tracer, tile, region, &first);
  tracer->tile_shadows = first.knows_shadows ? &first.shadows : nullptr;
  for (std::uint32_t i = 0; i < wanted.count; ++i) {
    Surface* s = &first.shadows.surface[i];
    const bool hit = first.hit[i].triangle != kNoTriangle;
    const std::uint32_t column = tile.column + wanted.column[i] - kTakenBefore,
                        row = tile.row + wanted.row[i] - kTakenBefore;
    tracer->tile_pixel = i;
    tracer->first_surface = hit ? s : nullptr;
    observe_pixel(tracer, column, row);
    if (frame.kept.first_hits) keep_first_hit(tracer, sample, column, row, first.hit[i]);
    Vec3* pixel = &image.at(column, row);
    Vec3 sum = sample_radiance(tracer, first.ray[i], first.hit[i], tracer->first_surface);
    if (sample > 0) sum = *pixel + sum;
    *pixel = sample + 1 == sample_count ? sum * (1.0f / static_cast<float>(sample_count)) : sum;
  }
  tracer->first_surface = nullptr;
  tracer->tile_shadows = nullptr;
}

// Moves what the region shares with the next tile to the right.
void move_on(Region* region) {
  for (std::uint32_t row = 0; row < kRegionSide; ++row)
    for (std::uint32_t column = 0; column < kRegionSide; ++column) {
      const std::uint32_t to = row * kRegionSide + column, from = to + kTileSide;
      region->right[to] = region->below[to] = Link::unknown;
      region->pixel[to].row = kNone;
      if (column + kTileSide >= kRegionSide || !is_known(region->pixel[from])) continue;
      region->right[to] = region->right[from], region->below[to] = region->below[from];
      region->pixel[to] = region->pixel[from];
    }
}

// Calls visit(kept, y, pixel) for pixels of kKeptRows rows of the region and their slots in the tracer.
template <class Visit>
void for_kept_pixels(Tracer* tracer, const SharedTile& tile, std::uint32_t first_row, Region* region, Visit visit) {
  const std::uint32_t width = tracer->frame->settings.width;
  for (std::uint32_t row = first_row; row < first_row + kKeptRows; ++row)
    for (std::uint32_t column = 0; column < kRegionSide; ++column) {
      const std::uint32_t x = tile.column + column - kTakenBefore, y = tile.row + row - kTakenBefore;
      if (x < width)
        visit(&tracer->interleaved_pixels[y % kKeptRows * width + x], y, &region->pixel[row * kRegionSide + column]);
    }
}

void take_kept(Tracer* tracer, const SharedTile& tile, Region* region) {
  if (tracer->interleaved_pixels.empty()) return;
  for_kept_pixels(tracer, tile, 0, region, [](InterleavedPixel* kept, std::uint32_t row, InterleavedPixel* pixel) {
    if (kept->row == row && !is_known(*pixel)) *pixel = *kept;
  });
}

void keep(Tracer* tracer, const SharedTile& tile, Region* region) {
  if (tracer->interleaved_pixels.empty()) return;
  for_kept_pixels(tracer, tile, kTileSide, region, [](InterleavedPixel* kept, std::uint32_t, InterleavedPixel* pixel) {
    if (is_known(*pixel)) *kept = *pixel;
  });
}

void trace_tile_row(Tracer* tracer, const AlignedTiles& tiles, std::uint32_t r, const PixelRows& image) {
  const FrameData& frame = *tracer->frame;
  Region region;
  PixelLists room;
  SharedTile tile;
  for (std::uint32_t sample = 0; sample < frame.settings.samples_per_pixel; ++sample) {
    for (InterleavedPixel& pixel : region.pixel) pixel.row = kNone;
    std::fill_n(region.right, kRegionPixels, Link::unknown), std::fill_n(region.below, kRegionPixels, Link::unknown);
    for (std::uint32_t c = 0; c < tiles.tile_count; ++c) {
      tile.column = tiles.column + c * kTileSide, tile.row = tiles.row + r * kTileSide;
      if (c > 0) move_on(&region);
      if (!tiles.mask[r][c]) continue;
      list_pixels(frame.settings, tiles.mask[r][c], &room, &tile);
      if (tile.lists->wanted.count == 0) continue;
      if (frame.settings.samples_per_pixel > 1) {
        trace_sample(tracer, tile, sample, image, &region);
        continue;
      }
      take_kept(tracer, tile, &region);
      trace_sample(tracer, tile, sample, image, &region);
      keep(tracer, tile, &region);
    }
  }
}

}  // namespace

bool shows_same(const InterleavedPixel& a, const InterleavedPixel& b) {
  if (a.triangle == b.triangle) return true;
  if (!(dot(a.normal, b.normal) > kSameNormal)) return false;
  Vec3 way = b.point - a.point;
  float height = dot(a.geometric, way);
  return height * height <= kSamePlane * kSamePlane * dot(way, way);
}

void keep_interleaved_pixels(Array<InterleavedPixel> pixels, Tracer* tracer) {
  CHECK_LE(kept_pixel_count(tracer->frame->settings), pixels.count);
  for (InterleavedPixel& pixel : pixels) pixel.row = kNone;
  tracer->interleaved_pixels = pixels;
}

void trace_interleaved(Tracer* tracer, const TileStrip& strip, const PixelRows& image) {
  if (strip.tile_count == 0) return;
  CHECK(strip.row_count >= 1 && strip.row_count <= kTileRows);
  if (tracer->frame->settings.samples_per_pixel > 1) effect_entered<Effect::supersampling>();
  AlignedTiles tiles;
  align_tiles(strip, &tiles);
  for (std::uint32_t r = 0; r < 2; ++r) trace_tile_row(tracer, tiles, r, image);
}

}  // namespace pocketray
