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
constexpr float kSharersMin = 4;

// A region is an aligned tile with a border of the pixels from which its pixels take light, by rows.
enum class Link : std::uint8_t { unknown, different, same };
template <class Reach>
struct Region {
  bool is_one_surface;  // all of its pixels show one surface, and so do all from which wanted pixels take light
  InterleavedPixel pixel[Reach::kRegionPixels];
  Link right[Reach::kRegionPixels], below[Reach::kRegionPixels];  // whether the next pixel shows the same surface
  InterleavedLight column[Reach::kRegionPixels];  // sums along columns for one source; starts with no pixels
};

bool is_known(const InterleavedPixel& pixel) { return pixel.row != kNone; }
bool is_hit(const InterleavedPixel& pixel) { return is_known(pixel) && pixel.triangle != kNone; }

// Pixels to trace in packets. Columns and rows are relative to the region.
template <class Reach>
struct PixelList {
  std::uint32_t count = 0;
  std::uint8_t column[Reach::kRegionPixels] = {}, row[Reach::kRegionPixels] = {};

  constexpr void add(std::uint32_t c, std::uint32_t r) {
    column[count] = static_cast<std::uint8_t>(c), row[count++] = static_cast<std::uint8_t>(r);
  }
};
template <class Reach>
struct PixelLists {
  PixelList<Reach> wanted;  // in Morton order
  PixelList<Reach> others;  // the pixels around them within the picture
};

template <class Reach>
struct SharedTile {
  std::uint32_t column, row;  // of the region's tile in the picture
  const PixelLists<Reach>* lists;
};

template <class Reach>
constexpr PixelLists<Reach> all_pixels() {
  PixelLists<Reach> lists;
  for (std::uint32_t m = 0; m < kPacketMax; ++m)
    lists.wanted.add(morton_column(m) + Reach::kBefore, morton_row(m) + Reach::kBefore);
  for (std::uint32_t row = 0; row < Reach::kRegionSide; ++row)
    for (std::uint32_t column = 0; column < Reach::kRegionSide; ++column)
      if (column - Reach::kBefore >= kTileSide || row - Reach::kBefore >= kTileSide) lists.others.add(column, row);
  return lists;
}
// For a tile that is wanted whole and lies within the picture.
template <class Reach>
constexpr PixelLists<Reach> kAllPixels = all_pixels<Reach>();

// Lists the tile's pixels in the mask and the pixels around them.
template <class Reach>
void list_pixels(const Settings& settings, std::uint64_t mask, PixelLists<Reach>* room, SharedTile<Reach>* tile) {
  if (mask == ~std::uint64_t(0) && tile->column >= Reach::kBefore && tile->row >= Reach::kBefore &&
      tile->column + kTileSide + Reach::kAfter <= settings.width &&
      tile->row + kTileSide + Reach::kAfter <= settings.height) {
    tile->lists = &kAllPixels<Reach>;
    return;
  }
  tile->lists = room;
  bool is_wanted[Reach::kRegionPixels] = {}, is_taken[Reach::kRegionPixels] = {};
  room->wanted.count = room->others.count = 0;
  for (std::uint32_t m = 0; m < kPacketMax; ++m) {
    const std::uint32_t column = morton_column(m), row = morton_row(m);
    if (!(mask >> m & 1) || tile->column + column >= settings.width || tile->row + row >= settings.height) continue;
    room->wanted.add(column + Reach::kBefore, row + Reach::kBefore);
    is_wanted[(row + Reach::kBefore) * Reach::kRegionSide + column + Reach::kBefore] = true;
    for (std::uint32_t y = row; y < row + Reach::kTakenSide; ++y)
      std::fill_n(&is_taken[y * Reach::kRegionSide + column], Reach::kTakenSide, true);
  }
  for (std::uint32_t i = 0; i < Reach::kRegionPixels; ++i) {
    const std::uint32_t column = i % Reach::kRegionSide, row = i / Reach::kRegionSide;
    const std::uint32_t x = tile->column + column - Reach::kBefore, y = tile->row + row - Reach::kBefore;  // wraps
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

template <class Reach>
void find_first_hits(Tracer* tracer, const SharedTile<Reach>& tile, const PixelList<Reach>& pixels, std::uint32_t begin,
                     std::uint32_t count, const Vec2& offset, bool with_shadows, FirstHits* first) {
  const FrameData& frame = *tracer->frame;
  CHECK_LE(count, kPacketMax);
  for (std::uint32_t i = 0; i < count; ++i)
    first->ray[i] = pixel_ray(frame, tile.column + pixels.column[begin + i] - Reach::kBefore,
                              tile.row + pixels.row[begin + i] - Reach::kBefore, offset);
  first->knows_shadows = false;
  if (frame.view.camera.has_one_origin && !frame.geometry.ray_by_ray) {
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
      frame.kernels.surface(frame, first->ray[i], first->hit[i], &first->shadows.surface[i]);
}

// Lists the indices in KeptRays::compensation_paths of one sample of some of the region's pixels.
template <class Reach>
void list_paths(const Settings& settings, const SharedTile<Reach>& tile, std::uint32_t sample, std::uint32_t count,
                const std::uint8_t* in_region, std::uint32_t* pixel) {
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::uint32_t column = tile.column + in_region[i] % Reach::kRegionSide - Reach::kBefore,
                        row = tile.row + in_region[i] / Reach::kRegionSide - Reach::kBefore;
    pixel[i] = (sample * settings.height + row) * settings.width + column;
  }
}

// Gathers light at the pixels of the list from `begin` on and stores it in the region, which lacks them.
template <class Reach>
void gather(Tracer* tracer, const SharedTile<Reach>& tile, std::uint32_t sample, const PixelList<Reach>& pixels,
            std::uint32_t begin, std::uint32_t count, const FirstHits& first, Region<Reach>* region) {
  const FrameData& frame = *tracer->frame;
  const Surface* surface[kPacketMax];
  std::uint8_t place[kPacketMax], in_region[kPacketMax];
  InterleavedLight light[kPacketMax];
  std::uint32_t found = 0;
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::uint32_t column = pixels.column[begin + i], row = pixels.row[begin + i],
                        k = row * Reach::kRegionSide + column;
    InterleavedPixel* pixel = &region->pixel[k];
    if (is_known(*pixel)) continue;
    pixel->row = tile.row + row - Reach::kBefore, pixel->triangle = kNone;
    if (first.hit[i].triangle == kNoTriangle) continue;
    const Surface& s = first.shadows.surface[i];
    pixel->triangle = s.hit.triangle, pixel->point = s.point, pixel->normal = s.normal, pixel->geometric = s.geometric;
    surface[found] = &s, in_region[found] = static_cast<std::uint8_t>(k);
    place[found++] =
        static_cast<std::uint8_t>(source_place(tile.column + column - Reach::kBefore, tile.row + row - Reach::kBefore));
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

template <class Reach>
void link_neighbours(Region<Reach>* region) {
  bool is_one_surface = true;
  auto link = [&](std::uint32_t a, std::uint32_t b, Link* l) {
    const InterleavedPixel &p = region->pixel[a], &q = region->pixel[b];
    if (*l == Link::unknown && is_known(q)) *l = is_hit(q) && shows_same(p, q) ? Link::same : Link::different;
    is_one_surface &= *l == Link::same;
  };
  for (std::uint32_t k = 0; k < Reach::kRegionPixels; ++k) {
    if (!is_hit(region->pixel[k])) {
      is_one_surface = false;
      continue;
    }
    if (k % Reach::kRegionSide + 1 < Reach::kRegionSide) link(k, k + 1, &region->right[k]);
    if (k + Reach::kRegionSide < Reach::kRegionPixels) link(k, k + Reach::kRegionSide, &region->below[k]);
  }
  region->is_one_surface = is_one_surface;
}

// Calls visit(k) for a pixel and the pixels in reach along its row or column that are linked to it by one surface.
template <class Reach, class Visit>
void along(const Link* links, std::uint32_t step, std::uint32_t own, Visit visit) {
  visit(own);
  for (std::uint32_t k = own, i = 0; i < Reach::kBefore && links[k - step] == Link::same; ++i) visit(k -= step);
  for (std::uint32_t k = own, i = 0; i < Reach::kAfter && links[k] == Link::same; ++i) visit(k += step);
}

constexpr InterleavedLight kNoLight = {{0, 0, 0}, {0, 0, 0}, 0};

// Sums light(k) over everything along() would visit if all links held, in the same order.
template <class Reach, class Light>
InterleavedLight sum_of_all(std::uint32_t step, std::uint32_t own, Light light) {
  InterleavedLight sum = light(own);
  for (std::uint32_t i = 1; i <= Reach::kBefore; ++i) add(light(own - i * step), &sum);
  for (std::uint32_t i = 1; i <= Reach::kAfter; ++i) add(light(own + i * step), &sum);
  return sum;
}

// Keeps a pixel's surface, unless it reflects nothing, for keep_sum().
template <class Reach>
void keep_surfaces(Tracer* tracer, const SharedTile<Reach>& tile, const Region<Reach>& region, const FirstHits& first) {
  if (!is_shared(tracer->window)) return;
  const PixelList<Reach>& wanted = tile.lists->wanted;
  for (std::uint32_t i = 0; i < wanted.count; ++i) {
    const std::uint32_t column = wanted.column[i], row = wanted.row[i];
    SharedPixel* shared = shared_pixel(tracer, tile.column + column - Reach::kBefore, tile.row + row - Reach::kBefore);
    shared->pixel = region.pixel[row * Reach::kRegionSide + column];
    if (is_hit(shared->pixel) && is_zero(first.shadows.surface[i].diffuse)) shared->pixel.triangle = kNone;
  }
}

// Keeps the light that pixel `i` of the wanted ones takes from its neighbours.
template <class Reach>
void keep_sum(Tracer* tracer, const SharedTile<Reach>& tile, std::uint32_t i, int source, const InterleavedLight& sum,
              bool are_few) {
  const PixelList<Reach>& wanted = tile.lists->wanted;
  SharedPixel* shared =
      shared_pixel(tracer, tile.column + wanted.column[i] - Reach::kBefore, tile.row + wanted.row[i] - Reach::kBefore);
  if (shared) shared->pixel.light[source] = sum, shared->are_few[source] = are_few;
}

// Fast path of add_shared_light() for a region that shows a single surface.
template <class Reach>
void add_light_of_one_surface(Tracer* tracer, const SharedTile<Reach>& tile, int source, Region<Reach>* region,
                              FirstHits* first) {
  CHECK(region->is_one_surface);
  const FrameData& frame = *tracer->frame;
  const PixelList<Reach>& wanted = tile.lists->wanted;
  const InterleavedSource& info = *kInterleavedSources[source];
  for (std::uint32_t k = Reach::kBefore * Reach::kRegionSide; k < (Reach::kBefore + kTileSide) * Reach::kRegionSide;
       ++k)
    region->column[k] = sum_of_all<Reach>(Reach::kRegionSide, k, [&](std::uint32_t at) -> const InterleavedLight& {
      return region->pixel[at].light[source];
    });
  for (std::uint32_t i = 0; i < wanted.count; ++i) {
    Surface& s = first->shadows.surface[i];
    if (is_zero(s.diffuse)) continue;
    const InterleavedLight sum =
        sum_of_all<Reach>(1, wanted.row[i] * Reach::kRegionSide + wanted.column[i],
                          [&](std::uint32_t at) -> const InterleavedLight& { return region->column[at]; });
    keep_sum(tracer, tile, i, source, sum, false);
    s.glow += s.diffuse * info.irradiance(frame, s.point, s.normal, sum, false);
  }
}

// Adds the light that the wanted pixels share with their neighbours to their surfaces' glow.
template <class Reach>
void add_shared_light(Tracer* tracer, const SharedTile<Reach>& tile, Region<Reach>* region, FirstHits* first) {
  const FrameData& frame = *tracer->frame;
  const PixelList<Reach>& wanted = tile.lists->wanted;
  keep_surfaces(tracer, tile, *region, *first);
  for (int source = 0; source < kInterleavedSourceCount; ++source) {
    if (!has(frame.mask, kInterleavedSources[source]->effect)) continue;
    if (region->is_one_surface) {
      add_light_of_one_surface(tracer, tile, source, region, first);
      continue;
    }
    std::fill_n(region->column, Reach::kRegionPixels, kNoLight);
    for (std::uint32_t i = 0; i < wanted.count; ++i) {
      Surface& s = first->shadows.surface[i];
      if (first->hit[i].triangle == kNoTriangle || is_zero(s.diffuse)) continue;
      InterleavedLight sum = kNoLight;
      along<Reach>(region->right, 1, wanted.row[i] * Reach::kRegionSide + wanted.column[i], [&](std::uint32_t in_row) {
        InterleavedLight* column = &region->column[in_row];
        if (column->pixel_count == 0)
          along<Reach>(region->below, Reach::kRegionSide, in_row,
                       [&](std::uint32_t k) { add(region->pixel[k].light[source], column); });
        add(*column, &sum);
      });
      const bool are_few = sum.pixel_count < kSharersMin;
      if (are_few) {
        sum = kNoLight;
        for (std::uint32_t k = 0; k < Reach::kTakenPixels; ++k) {
          const std::uint32_t column = wanted.column[i] - Reach::kBefore + k % Reach::kTakenSide;
          const std::uint32_t row = wanted.row[i] - Reach::kBefore + k / Reach::kTakenSide;
          const InterleavedPixel& pixel = region->pixel[row * Reach::kRegionSide + column];
          if (is_hit(pixel)) add(pixel.light[source], &sum);
        }
      }
      keep_sum(tracer, tile, i, source, sum, are_few);
      s.glow += s.diffuse * kInterleavedSources[source]->irradiance(frame, s.point, s.normal, sum, are_few);
    }
  }
}

// Traces one sample of the tile's wanted pixels and adds it to the image.
template <class Reach>
void trace_sample(Tracer* tracer, const SharedTile<Reach>& tile, std::uint32_t sample, const PixelRows& image,
                  Region<Reach>* region) {
  const FrameData& frame = *tracer->frame;
  const std::uint32_t sample_count = frame.settings.samples_per_pixel;
  CHECK_LT(sample, sample_count);
  const Vec2 offset = rook_point(sample, sample_count);
  const PixelList<Reach>& wanted = tile.lists->wanted;
  FirstHits first;
  PixelList<Reach> lacking;
  use_points_of(tracer, sample);
  for (std::uint32_t i = 0; i < tile.lists->others.count; ++i)
    if (!is_known(region->pixel[tile.lists->others.row[i] * Reach::kRegionSide + tile.lists->others.column[i]]))
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
    const std::uint32_t column = tile.column + wanted.column[i] - Reach::kBefore,
                        row = tile.row + wanted.row[i] - Reach::kBefore;
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
template <class Reach>
void move_on(Region<Reach>* region) {
  for (std::uint32_t row = 0; row < Reach::kRegionSide; ++row)
    for (std::uint32_t column = 0; column < Reach::kRegionSide; ++column) {
      const std::uint32_t to = row * Reach::kRegionSide + column, from = to + kTileSide;
      region->right[to] = region->below[to] = Link::unknown;
      region->pixel[to].row = kNone;
      if (column + kTileSide >= Reach::kRegionSide || !is_known(region->pixel[from])) continue;
      region->right[to] = region->right[from], region->below[to] = region->below[from];
      region->pixel[to] = region->pixel[from];
    }
}

// Calls visit(kept, y, pixel) for pixels of kKeptRows rows of the region and their slots in the tracer.
template <class Reach, class Visit>
void for_kept_pixels(Tracer* tracer, const SharedTile<Reach>& tile, std::uint32_t first_row, Region<Reach>* region,
                     Visit visit) {
  const std::uint32_t width = tracer->frame->settings.width;
  for (std::uint32_t row = first_row; row < first_row + Reach::kKeptRows; ++row)
    for (std::uint32_t column = 0; column < Reach::kRegionSide; ++column) {
      const std::uint32_t x = tile.column + column - Reach::kBefore, y = tile.row + row - Reach::kBefore;
      if (x < width)
        visit(&tracer->interleaved_pixels[y % Reach::kKeptRows * width + x], y,
              &region->pixel[row * Reach::kRegionSide + column]);
    }
}

template <class Reach>
void take_kept(Tracer* tracer, const SharedTile<Reach>& tile, Region<Reach>* region) {
  if (tracer->interleaved_pixels.empty()) return;
  for_kept_pixels(tracer, tile, 0, region, [](InterleavedPixel* kept, std::uint32_t row, InterleavedPixel* pixel) {
    if (kept->row == row && !is_known(*pixel)) *pixel = *kept;
  });
}

template <class Reach>
void keep(Tracer* tracer, const SharedTile<Reach>& tile, Region<Reach>* region) {
  if (tracer->interleaved_pixels.empty()) return;
  for_kept_pixels(tracer, tile, kTileSide, region, [](InterleavedPixel* kept, std::uint32_t, InterleavedPixel* pixel) {
    if (is_known(*pixel)) *kept = *pixel;
  });
}

template <class Reach>
void trace_tile_row(Tracer* tracer, const AlignedTiles& tiles, std::uint32_t r, const PixelRows& image) {
  const FrameData& frame = *tracer->frame;
  Region<Reach> region;
  PixelLists<Reach> room;
  SharedTile<Reach> tile;
  for (std::uint32_t sample = 0; sample < frame.settings.samples_per_pixel; ++sample) {
    for (InterleavedPixel& pixel : region.pixel) pixel.row = kNone;
    std::fill_n(region.right, Reach::kRegionPixels, Link::unknown),
        std::fill_n(region.below, Reach::kRegionPixels, Link::unknown);
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

void add_later_sources(Tracer* tracer, const Vec3& weight, Surface* surface) {
  for (const InterleavedSource* source : kInterleavedSources)
    if (has(tracer->frame->mask, source->effect)) source->add_later(tracer, weight, surface);
}

void keep_interleaved_pixels(Array<InterleavedPixel> pixels, Tracer* tracer) {
  CHECK_LE(kept_pixel_count(tracer->frame->settings, tracer->frame->mask), pixels.count);
  for (InterleavedPixel& pixel : pixels) pixel.row = kNone;
  tracer->interleaved_pixels = pixels;
}

void trace_interleaved(Tracer* tracer, const TileStrip& strip, const PixelRows& image) {
  if (strip.tile_count == 0) return;
  CHECK(strip.row_count >= 1 && strip.row_count <= kTileRows);
  if (tracer->frame->settings.samples_per_pixel > 1) effect_entered<Effect::supersampling>();
  AlignedTiles tiles;
  align_tiles(strip, &tiles);
  for (std::uint32_t r = 0; r < 2; ++r)
    has(tracer->frame->mask, Effect::environment_shadow) ? trace_tile_row<FarReach>(tracer, tiles, r, image)
                                                         : trace_tile_row<NearReach>(tracer, tiles, r, image);
}

}  // namespace pocketray
