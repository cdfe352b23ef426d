#include "temporal/tile_changes.h"

#include <algorithm>
#include <cstring>

#include "base/check.h"
#include "brdf/clear_coat.h"
#include "brdf/sheen.h"
#include "scene/diffuse_transmission.h"
#include "shade/edges.h"
#include "shade/sample_points.h"
#include "shade/trace_spans.h"
#include "temporal/tile_search.h"

namespace pocketray {
namespace {

TilePixels pixels_of(const Settings& settings, std::uint32_t column, std::uint32_t row, std::uint64_t known) {
  TilePixels p;
  p.column = column, p.row = row;
  for (std::uint32_t m = 0; m < kPacketMax; ++m) {
    std::uint32_t x = (m & 1) | (m >> 1 & 2) | (m >> 2 & 4), y = (m >> 1 & 1) | (m >> 2 & 2) | (m >> 3 & 4);
    if (p.column + x >= settings.width || p.row + y >= settings.height || !(known >> (8 * y + x) & 1)) continue;
    p.x[p.count] = static_cast<std::uint8_t>(x), p.y[p.count++] = static_cast<std::uint8_t>(y);
  }
  return p;
}

bool scatters(const Scene& scene, std::uint32_t material) {
  const Material& m = scene.materials[material];
  return !is_zero(m.diffuse) || !is_zero(m.specular) || coat_of(scene, material) || sheen_of(scene, material) ||
         diffuse_transmission_of(scene, material);
}

// Finds the pixels whose first hits are unchanged and may receive light.
void find_receivers(TileSearch* t) {
  t->receiver_count = 0;
  t->has_surface = 0;
  for (std::uint32_t i = 0; i < t->pixels.count; ++i) {
    const Hit& hit = t->hits[index_of(t->frame.settings, t->pixels, i)];
    if (hit.triangle == kNoTriangle || t->changed & bit_of(t->pixels, i)) continue;
    if (!scatters(*t->frame.scene, t->frame.scene->triangles[hit.triangle].material())) continue;
    t->point[t->receiver_count] = point_of(t->frame, hit);
    t->receiver[t->receiver_count++] = static_cast<std::uint8_t>(i);
  }
}

bool has_light_changed(const ChangeSearch& search, const LightRun& run, std::uint32_t light) {
  const FrameData& frame = *search.frame;
  if (!search.lights_changed) return false;
  const Lights& lights = frame.lights;
  if (std::memcmp(&search.last.lights[light], &lights.points[light], sizeof(LightPoint)) != 0) return true;
  for (std::uint32_t k = light; k < lights.sample_points.count; k += lights.points.count)
    if (std::memcmp(&search.last.sample_lights[k], &lights.sample_points[k], sizeof(LightPoint)) != 0) return true;
  if (!run.polygons) return false;
  const std::uint32_t lamp = (light - run.begin) / frame.settings.points_per_area_light;
  return std::memcmp(&search.last.light_polygons[lamp], &run.polygons[lamp], sizeof(LightPolygon)) != 0;
}

// Calls visit(run, light, has_changed) for each suspect light that has changed or to which the tile has a ray that can
// meet a change. Stops when visit returns false.
template <class Visit>
void for_each_suspect(const ChangeSearch& search, const TileHits& hits, std::uint64_t suspects, Visit visit) {
  const FrameData& frame = *search.frame;
  if (is_empty(hits.points)) return;
  const bool casts = has(frame.mask, Effect::shadow) && search.moving->changed;
  for (int r = 0; r < frame.lights.run_count; ++r) {
    const LightRun& run = frame.lights.runs[r];
    for (std::uint32_t i = run.begin; i < run.end; ++i) {
      if (i < kSuspectLights && !(suspects >> i & 1)) continue;
      const bool has_changed = has_light_changed(search, run, i);
      if (!has_changed && (!casts || !may_shade(search, hits, run, i))) continue;
      if (!visit(run, i, has_changed)) return;
    }
  }
}

// Finds pixels with rays in the tables that may have met a change.
std::uint64_t find_marked(const ChangeSearch& search, std::uint32_t column, std::uint32_t row) {
  std::uint64_t found = 0;
  if (!search.tables) return 0;
  const Settings& settings = search.frame->settings;
  for (std::uint32_t y = 0; y < kChangeTileSide && row + y < settings.height; ++y) {
    for (std::uint32_t x = 0; x < kChangeTileSide && column + x < settings.width; ++x) {
      if (!search.last.marked[std::size_t(row + y) * settings.width + column + x]) continue;
      if (search.lights_changed || is_dirty(*search.tables, block_of(*search.tables, column + x, row + y)))
        found |= std::uint64_t(1) << (8 * y + x);
    }
  }
  return found;
}

// Returns which of a tile's known pixels have samples added at edges.
std::uint64_t edges_of(const ChangeSearch& search, std::uint32_t column, std::uint32_t row, std::uint64_t known) {
  const Settings& settings = search.frame->settings;
  std::uint64_t found = 0;
  for (std::uint32_t y = 0; y < kChangeTileSide && row + y < settings.height; ++y)
    for (std::uint32_t x = 0; x < kChangeTileSide && column + x < settings.width; ++x)
      if (is_edge(settings, search.last.first_hits, column + x, row + y)) found |= std::uint64_t(1) << (8 * y + x);
  return found & known;
}

std::uint64_t find_changes_of(const ChangeSearch& search, std::uint32_t tile, const Suspects& suspects,
                              std::uint64_t known_pixels, std::uint64_t* given, ChangeCounts* counts,
                              TraceStats* stats) {
  const FrameData& frame = *search.frame;
  const TileHits& hits = search.tiles[tile];
  const std::uint32_t column = tile % search.tile_columns * kChangeTileSide,
                      row = tile / search.tile_columns * kChangeTileSide;
  const std::uint64_t marked = find_marked(search, column, row) & known_pixels;
  const bool seen = suspects.seen && sees_change(search, {column, row, kChangeTileSide, kChangeTileSide}, hits.t_max);
  bool any = seen;
  if (!any)
    for_each_suspect(search, hits, suspects.lights,
                     [&](const LightRun&, std::uint32_t, bool) { return !(any = true); });
  SourceSets sources;
  if (!is_empty(suspects.sources)) sources = suspect_sources(search, hits, &suspects.sources);
  PathSuspects paths;
  if (suspects.paths.any) paths = suspect_paths(search, hits, search.path_ends[tile], &suspects.paths);
  if (!any && is_empty(sources) && !paths.any) return marked;
  const TilePixels pixels = pixels_of(frame.settings, column, row, known_pixels);
  if (pixels.count == 0) return 0;
  // Finds changes of the samples [begin, end) of the search's pixels.
  auto search_samples = [&](TileSearch* t, std::uint32_t begin, std::uint32_t end) {
    for (std::uint32_t sample = begin; sample < end; ++sample) {
      t->hits = search.last.first_hits + std::size_t(sample) * frame.settings.width * frame.settings.height;
      t->offset = kept_sample_offset(frame.settings, sample);
      t->lights = points_of_sample(frame, sample);
      t->last_lights = points_of_sample(frame, sample, search.last.lights, search.last.sample_lights);
      if (seen) find_changed_hits(t, hits.t_max);
      find_receivers(t);
      if (sample < frame.settings.samples_per_pixel) {  // others take the light that these share
        find_other_light(t, sources);
        if (paths.any) find_other_paths(t, sample, hits, paths);
      }
      KnownShadows* known = known_shadows(search, sample, tile);
      for_each_suspect(search, hits, suspects.lights, [&](const LightRun& run, std::uint32_t light, bool has_changed) {
        const bool is_kept = light < search.known_lights;
        KnownShadows none, *of_light = is_kept ? &known[light] : &none;
        // For a changed light, what is known still holds for pixels that it neither reached nor reaches.
        has_changed ? find_lit_by(t, run, light) : find_changed_shadows(t, run, light, hits.room, is_kept, of_light);
        return true;
      });
    }
  };
  const std::uint32_t samples = frame.settings.samples_per_pixel, all = kept_sample_count(frame.settings, frame.mask);
  TileSearch t(search, pixels, marked, *given, counts, stats);
  search_samples(&t, 0, samples);
  *given = t.given;
  if (all == samples) return t.changed;
  const TilePixels at_edges = pixels_of(frame.settings, column, row, edges_of(search, column, row, known_pixels));
  TileSearch added(search, at_edges, t.changed, t.given, counts, stats);
  if (at_edges.count > 0) search_samples(&added, samples, all);
  return added.changed;
}

}  // namespace

const Surface& surface_of(TileSearch* t, std::uint32_t k) {
  if (t->has_surface >> k & 1) return t->surface[k];
  t->has_surface |= std::uint64_t(1) << k;
  const std::uint32_t i = t->receiver[k];
  t->frame.kernels.surface(t->frame, sample_ray(t->frame, t->pixels, i, t->offset),
                           t->hits[index_of(t->frame.settings, t->pixels, i)], &t->surface[k]);
  return t->surface[k];
}

void forget_shadows(const ChangeSearch& search, std::uint32_t tile, std::uint64_t changed) {
  if (!changed) return;
  const std::uint32_t samples = kept_sample_count(search.frame->settings, search.frame->mask);
  for (std::uint32_t sample = 0; sample < samples; ++sample) {
    KnownShadows* known = known_shadows(search, sample, tile);
    for (std::uint32_t light = 0; light < search.known_lights; ++light)
      known[light].known &= ~changed, known[light].idle &= ~changed;
  }
}

Suspects suspects_of(const ChangeSearch& search, std::uint32_t begin, std::uint32_t end) {
  TileHits all;
  Box ends = empty_box();
  for (std::uint32_t tile = begin; tile < end; ++tile) {
    const TileHits& hits = search.tiles[tile];
    all.points = merge(all.points, hits.points);
    all.room = std::max(all.room, hits.room), all.t_max = std::max(all.t_max, hits.t_max);
    if (search.paths) ends = merge(ends, search.path_ends[tile]);
  }
  const std::uint32_t column = begin % search.tile_columns * kChangeTileSide,
                      row = begin / search.tile_columns * kChangeTileSide;
  Suspects suspects = {};
  suspects.seen = sees_change(search, {column, row, (end - begin) * kChangeTileSide, kChangeTileSide}, all.t_max);
  suspects.sources = suspect_sources(search, all, nullptr);
  if (search.paths) suspects.paths = suspect_paths(search, all, ends, nullptr);
  for_each_suspect(search, all, ~std::uint64_t(0), [&](const LightRun&, std::uint32_t light, bool) {
    if (light < kSuspectLights) suspects.lights |= std::uint64_t(1) << light;
    return light < kSuspectLights;  // they come in ascending order
  });
  return suspects;
}

std::uint64_t find_changed_pixels(const ChangeSearch& search, std::uint32_t tile, const Suspects& suspects,
                                  std::uint64_t known, std::uint64_t* given, ChangeCounts* counts, TraceStats* stats) {
  const std::uint64_t changed = find_changes_of(search, tile, suspects, known, given, counts, stats);
  forget_shadows(search, tile, changed);
  return changed;
}

}  // namespace pocketray
