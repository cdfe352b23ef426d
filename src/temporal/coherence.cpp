#include "temporal/coherence.h"

#include <algorithm>
#include <cstring>

#include "base/check.h"
#include "shade/edges.h"
#include "shade/interleaved.h"
#include "temporal/tile_search.h"

namespace pocketray {
namespace {

// Effects whose rays continue from the first hit.
constexpr EffectMask kGoingOn =
    bit(Effect::mirror) | bit(Effect::refraction) | bit(Effect::alpha_blend) | bit(Effect::back_face_culling);

constexpr std::uint32_t kSpanRows = 4;  // of tiles; even ragged spans of a whole frame usually fit

bool keeps_tables(EffectMask mask, const CoherencePlan& plan) {
  return plan.tables_only || (mask & kEffectsBuilt & kGoingOn) != 0;
}

template <class T>
bool differ(const T* last, const Array<const T>& now) {
  return now.count > 0 && std::memcmp(static_cast<const void*>(last), now.data, now.bytes()) != 0;
}

bool same_virtual_lights(const VirtualLights& a, const VirtualLights& b) {
  return a.count == b.count && a.geometry_max == b.geometry_max &&
         std::equal(a.light, a.light + a.count, b.light, [](const VirtualLight& x, const VirtualLight& y) {
           return x.position == y.position && x.normal == y.normal && x.intensity == y.intensity && x.place == y.place;
         });
}

// Returns whether pixels depend on others around them.
bool reads_others(EffectMask mask) { return is_interleaved(mask) || has(mask, Effect::edge_sampling); }

std::uint32_t tiles_along(std::uint32_t pixels) { return (pixels + kChangeTileSide - 1) / kChangeTileSide; }

bool keeps_paths(EffectMask mask, const CoherencePlan& plan) {
  return plan.compensated && has(mask, Effect::instant_radiosity);
}

std::uint32_t known_lights(const CoherencePlan& plan) {
  return plan.tables_only ? 0 : std::min(plan.light_points, kKnownLights);
}

std::uint64_t pixel_count(const CoherencePlan& plan) { return std::uint64_t(plan.width) * plan.height; }

}  // namespace

std::size_t coherence_need(const Scene& scene, EffectMask mask, const CoherencePlan& plan) {
  std::uint64_t pixels = pixel_count(plan);
  std::size_t tiles = std::size_t(tiles_along(plan.width)) * tiles_along(plan.height);
  std::size_t bytes = moving_geometry_need(scene, mask);
  bytes = size_sum(bytes, arena_need(pixels * plan.samples * sizeof(Hit)));
  bytes = size_sum(bytes, arena_need<TileHits>(tiles) + arena_need<std::uint64_t>(tiles));
  if (reads_others(mask)) bytes = size_sum(bytes, arena_need<std::uint64_t>(tiles));
  if (has(mask, Effect::instant_radiosity)) bytes = size_sum(bytes, arena_need<VirtualLights>(1));
  if (keeps_paths(mask, plan))
    bytes = size_sum(bytes, size_sum(arena_need(pixels * plan.samples * sizeof(KeptPath)), arena_need<Box>(tiles)));
  bytes = size_sum(bytes, arena_need<KnownShadows>(tiles * plan.samples * known_lights(plan)));
  if (plan.sample_points) bytes = size_sum(bytes, arena_need<LightPoint>(plan.sample_points));
  bytes = size_sum(bytes, arena_need<LightPoint>(plan.light_points) + arena_need<ChangeCounts>(plan.threads));
  bytes = size_sum(bytes, arena_need<LightPolygon>(plan.area_lights));
  bytes = size_sum(bytes, arena_need<Span>(kSpanRows * row_spans_max(plan.width)));
  bytes = size_sum(bytes, 2 * arena_need<std::uint8_t>(plan.height) + recoloring_need(plan.recolorable));
  if (!keeps_tables(mask, plan)) return bytes;
  bytes = size_sum(bytes, arena_need(pixels) + arena_need<MarkingObserver>(plan.threads));
  return size_sum(bytes, ray_tables_need(plan.width, plan.height, plan.table_side));
}

std::size_t coherence_scratch_need(const Scene& scene, EffectMask mask) {
  return moving_geometry_scratch_need(scene, mask);
}

void make_coherence(const FrameData& frame, const CoherencePlan& plan, Arena* keep, Arena* scratch, Coherence* c) {
  CHECK(plan.samples >= 1 && plan.threads >= 1);
  *c = Coherence();
  c->plan = plan;
  c->moving = make_moving_geometry(frame, keep, scratch);
  if (plan.recolorable) c->recoloring = make_recoloring(plan.recolorable, keep);
  c->tile_columns = tiles_along(plan.width), c->tile_rows = tiles_along(plan.height);
  const std::size_t tiles = std::size_t(c->tile_columns) * c->tile_rows;
  c->first_hits = arena_array_zeroed<Hit>(keep, static_cast<std::size_t>(pixel_count(plan)) * plan.samples);
  c->tiles = arena_array<TileHits>(keep, tiles);
  c->changed = arena_array_zeroed<std::uint64_t>(keep, tiles);
  if (reads_others(frame.mask)) c->given = arena_array_zeroed<std::uint64_t>(keep, tiles);
  if (has(frame.mask, Effect::instant_radiosity)) c->virtual_lights = arena_array<VirtualLights>(keep, 1);
  if (keeps_paths(frame.mask, plan)) {
    c->paths = arena_array<KeptPath>(keep, static_cast<std::size_t>(pixel_count(plan)) * plan.samples);
    c->path_ends = arena_array<Box>(keep, tiles);
  }
  c->shadows = arena_array_zeroed<KnownShadows>(keep, tiles * plan.samples * known_lights(plan));
  c->lights = arena_array<LightPoint>(keep, plan.light_points);
  if (plan.sample_points) c->sample_lights = arena_array<LightPoint>(keep, plan.sample_points);
  c->light_polygons = arena_array<LightPolygon>(keep, plan.area_lights);
  c->counts = arena_array_zeroed<ChangeCounts>(keep, plan.threads);
  c->spans = arena_array<Span>(keep, kSpanRows * row_spans_max(plan.width));
  c->row_known = arena_array_zeroed<std::uint8_t>(keep, plan.height);
  c->row_traced = arena_array_zeroed<std::uint8_t>(keep, plan.height);
  if (!keeps_tables(frame.mask, plan)) return;
  c->marked = arena_array_zeroed<std::uint8_t>(keep, static_cast<std::size_t>(pixel_count(plan)));
  c->observers = arena_array<MarkingObserver>(keep, plan.threads);
  c->tables = make_ray_tables(plan.width, plan.height, plan.table_side, keep);
}

bool fits(const Coherence& c, const FrameData& frame) {
  bool has_tables = c.tables.words.count > 0;
  return kept_sample_count(frame.settings, frame.mask) <= c.plan.samples &&
         frame.lights.points.count <= c.plan.light_points && frame.lights.sample_points.count <= c.plan.sample_points &&
         frame.lights.polygons.count <= c.plan.area_lights && (has_tables || !keeps_tables(frame.mask, c.plan)) &&
         (c.given.count > 0 || !reads_others(frame.mask)) &&
         (c.virtual_lights.count > 0 || !has(frame.mask, Effect::instant_radiosity)) &&
         (c.paths.count > 0 || !is_compensated(frame.settings, frame.mask));
}

void recolor(Coherence* c, std::uint32_t material, const Material& was, const Material& is, const Scene& scene) {
  if (c->recoloring.marks.count) mark_material(was, is, scene, material, &c->recoloring);
}

bool follow_frame(Coherence* c, const FrameData& frame, const char** why) {
  CHECK(frame.settings.width == c->plan.width && frame.settings.height == c->plan.height);
  CHECK(why != nullptr);
  follow_geometry(frame, &c->moving);
  c->followed = signature_of(frame);
  *why = difference(c->signature, c->followed);
  if (!*why &&
      (frame.lights.points.count != c->light_count || frame.lights.sample_points.count != c->sample_light_count))
    *why = "lights were added or removed";
  if (!*why && has(frame.mask, Effect::instant_radiosity) &&
      !same_virtual_lights(c->virtual_lights[0], *virtual_lights_of(frame.indirect)))
    *why = "a virtual light changed";
  if (!*why && c->tables.words.count && !is_empty(frame.geometry.accel.bounds) &&
      !contains(c->tables.bounds, frame.geometry.accel.bounds))
    *why = "the scene outgrew the tables' grid";
  take_marks(&c->recoloring);
  if (!*why && c->recoloring.any) *why = follow_recoloring(frame, c->moving, &c->recoloring);
  for (ChangeCounts& counts : c->counts) counts = ChangeCounts();
  std::fill(c->row_traced.begin(), c->row_traced.end(), std::uint8_t(0));
  bool lights_changed = !*why && (differ(c->lights.data, frame.lights.points) ||
                                  differ(c->sample_lights.data, frame.lights.sample_points) ||
                                  differ(c->light_polygons.data, frame.lights.polygons));
  if (lights_changed && (frame.mask & kEffectsBuilt & effects_with(&EffectRow::followed, Followed::as_lights_stand))) {
    *why = "a light changed; light selection is recomputed";
    lights_changed = false;
  }
  const bool is_compensated = pocketray::is_compensated(frame.settings, frame.mask);
  if (!*why && is_compensated && (lights_changed || c->recoloring.any)) {
    *why = "a light or material changed; compensation is recomputed";
    lights_changed = false;
  }
  c->search = {&frame,
               &c->moving,
               c->tables.words.count ? &c->tables : nullptr,
               {c->first_hits.data, c->marked.data, c->lights, c->sample_lights, c->light_polygons},
               c->tiles.data,
               c->tile_columns,
               lights_changed,
               c->shadows,
               known_lights(c->plan),
               c->changed.count,
               is_compensated ? c->paths.data : nullptr,
               c->path_ends.data};
  if (*why) {
    std::fill(c->row_known.begin(), c->row_known.end(), std::uint8_t(0));
    if (c->tables.words.count) reset_tables(frame.geometry.accel.bounds, &c->tables);
    if (c->marked.count) std::memset(c->marked.data, 0, c->marked.bytes());
    std::fill(c->shadows.begin(), c->shadows.end(), KnownShadows());
    forget_frame(c);
    c->following = true;
    return false;
  }
  if (c->tables.words.count) {
    begin_dirty(&c->tables);
    for_each_changed_box(
        c->moving, [](void* tables, const Box& box) { add_dirty(static_cast<RayTables*>(tables), box); }, &c->tables);
    if (c->recoloring.any) add_recolored(frame, c->recoloring, &c->tables);
  }
  // Tiles that are not searched, since others trace their rows, may have changed in any way.
  std::fill(c->given.begin(), c->given.end(), is_unchanged(*c) ? 0 : ~std::uint64_t(0));
  forget_frame(c);  // until the frame is complete
  c->following = true;
  return true;
}

bool is_unchanged(const Coherence& c) { return !c.moving.changed && !c.search.lights_changed && !c.recoloring.any; }

namespace {

// Every pixel of the tile whose block is dirty; after a change of lights, every pixel.
std::uint64_t find_blocks(const Coherence& c, std::uint32_t tile) {
  const std::uint32_t column = tile % c.tile_columns * kChangeTileSide, row = tile / c.tile_columns * kChangeTileSide;
  std::uint64_t found = 0;
  for (std::uint32_t y = 0; y < kChangeTileSide && row + y < c.plan.height; ++y)
    for (std::uint32_t x = 0; x < kChangeTileSide && column + x < c.plan.width; ++x)
      if (c.search.lights_changed || is_dirty(c.tables, block_of(c.tables, column + x, row + y)))
        found |= std::uint64_t(1) << (8 * y + x);
  return found;
}

// Mask of a tile's pixels in known rows, bit 8·y + x, including rows below the picture.
std::uint64_t known_pixels(const Coherence& c, std::uint32_t tile_row) {
  std::uint64_t known = ~std::uint64_t(0);
  for (std::uint32_t y = 0, row = tile_row * kChangeTileSide; y < kChangeTileSide && row < c.plan.height; ++y, ++row)
    if (!c.row_known[row]) known &= ~(std::uint64_t(0xFF) << (8 * y));
  return known;
}

// Mask of the tile's columns within the picture, in each row.
std::uint64_t pixels_in_picture(const Coherence& c, std::uint32_t tile) {
  const std::uint32_t columns = c.plan.width - tile % c.tile_columns * kChangeTileSide;
  return 0x0101010101010101 * (columns < kChangeTileSide ? 0xFFu >> (kChangeTileSide - columns) : 0xFFu);
}

}  // namespace

void find_changes(Coherence* c, std::uint32_t tile_row, std::uint32_t thread, TraceStats* stats) {
  CHECK_LT(thread, c->counts.count);
  CHECK_LT(tile_row, c->tile_rows);
  const std::uint64_t known = known_pixels(*c, tile_row);
  const std::uint32_t row_begin = tile_row * c->tile_columns, row_end = row_begin + c->tile_columns;
  const bool searches = known != 0 && !c->plan.tables_only;
  Suspects suspects = {};
  for (std::uint32_t tile = row_begin; tile < row_end; ++tile) {
    if (searches && (tile - row_begin) % kSuspectTiles == 0)
      suspects = suspects_of(c->search, tile, std::min(tile + kSuspectTiles, row_end));
    const std::uint64_t unknown = ~known & pixels_in_picture(*c, tile);
    std::uint64_t found = 0, given = unknown;
    if (known != 0)
      found = c->plan.tables_only
                  ? find_blocks(*c, tile) & known
                  : find_changed_pixels(c->search, tile, suspects, known, &given, &c->counts[thread], stats);
    if (searches && c->recoloring.any) found |= find_recolored(c->recoloring, c->search, tile, known, &given);
    if (c->given.count) c->given[tile] = given;
    if (!c->plan.tables_only) forget_shadows(c->search, tile, unknown);
    c->changed[tile] = found | unknown;
  }
}

namespace {

// Adds the pixels from `before` columns and rows before pixel `i` of a tile to `after` columns and rows after it.
void add_around(Coherence* c, std::uint32_t tile, std::uint32_t i, std::uint32_t before, std::uint32_t after) {
  const std::uint32_t column = tile % c->tile_columns * kChangeTileSide + i % kChangeTileSide,
                      row = tile / c->tile_columns * kChangeTileSide + i / kChangeTileSide;
  for (std::uint32_t y = row - std::min(row, before); y <= row + after && y < c->plan.height; ++y)
    for (std::uint32_t x = column - std::min(column, before); x <= column + after && x < c->plan.width; ++x)
      c->changed[y / kChangeTileSide * c->tile_columns + x / kChangeTileSide] |=
          std::uint64_t(1) << (y % kChangeTileSide * kChangeTileSide + x % kChangeTileSide);
}

// add_around() for all pixels that may give others something different.
void add_around_given(Coherence* c, std::uint32_t before, std::uint32_t after) {
  for (std::uint32_t tile = 0; tile < c->given.count; ++tile)
    for (std::uint64_t rest = c->given[tile]; rest; rest &= rest - 1)
      add_around(c, tile, static_cast<std::uint32_t>(__builtin_ctzll(rest)), before, after);
}

}  // namespace

void spread_changes(Coherence* c) {
  const EffectMask mask = c->search.frame->mask;
  if (c->given.empty()) return;
  // The pixels that take light from it.
  if (has(mask, Effect::environment_shadow))
    add_around_given(c, FarReach::kAfter, FarReach::kBefore);
  else if (is_interleaved(mask))
    add_around_given(c, NearReach::kAfter, NearReach::kBefore);
  if (!has(mask, Effect::edge_sampling)) return;
  for (std::uint32_t tile = 0; tile < c->given.count; ++tile) c->given[tile] |= c->changed[tile];
  add_around_given(c, 1, 1);
}

void clear_changes(Coherence* c) {
  if (!c->tables.words.count) return;
  if (c->search.lights_changed) {  // every pixel with records is traced again
    reset_tables(c->search.frame->geometry.accel.bounds, &c->tables);
  } else {
    clear_dirty(&c->tables);
  }
  for (std::uint32_t tile = 0; tile < c->changed.count; ++tile) {
    const std::uint32_t column = tile % c->tile_columns * kChangeTileSide,
                        row = tile / c->tile_columns * kChangeTileSide;
    for (std::uint64_t rest = c->changed[tile]; rest; rest &= rest - 1) {
      std::uint32_t i = static_cast<std::uint32_t>(__builtin_ctzll(rest));
      c->marked[std::size_t(row + i / 8) * c->plan.width + column + i % 8] = 0;
    }
  }
}

void start_recording(Coherence* c, FrameData* frame, Array<Tracer> tracers) {
  CHECK_LE(tracers.count, c->plan.threads);
  CHECK_LE(kept_sample_count(frame->settings, frame->mask), c->plan.samples);
  CHECK(frame->geometry.accel_info != &c->observed);  // else it would call itself
  if (!c->plan.tables_only) frame->kept.first_hits = c->first_hits.data;
  if (is_compensated(frame->settings, frame->mask)) frame->kept.compensation_paths = c->paths.data;
  if (c->tables.words.empty()) return;
  for (std::uint32_t i = 0; i < tracers.count; ++i) {
    c->observers[i] = MarkingObserver();
    c->observers[i].accel_info = frame->geometry.accel_info;
    c->observers[i].tables = &c->tables;
    c->observers[i].marked = c->marked.data;
    tracers[i].stats.observer = &c->observers[i];
  }
  c->observed = observed(*frame->geometry.accel_info);
  frame->geometry.accel_info = &c->observed;
  if (c->plan.tables_only) frame->geometry.first_rays = &c->observed, frame->geometry.ray_by_ray = true;
}

void stop_recording(const AccelInfo& accel_info, FrameData* frame, Array<Tracer> tracers) {
  frame->kept.first_hits = nullptr;
  frame->kept.compensation_paths = nullptr;
  frame->geometry.accel_info = &accel_info;
  frame->geometry.first_rays = &accel_info;
  frame->geometry.ray_by_ray = false;
  for (Tracer& tracer : tracers) tracer.stats.observer = nullptr;
}

namespace {

void keep(Coherence* c, const FrameData& frame) {
  CHECK_LE(frame.lights.points.count, c->lights.count);
  c->light_count = frame.lights.points.count;
  std::copy(frame.lights.points.begin(), frame.lights.points.end(), c->lights.begin());
  CHECK_LE(frame.lights.sample_points.count, c->sample_lights.count);
  c->sample_light_count = frame.lights.sample_points.count;
  std::copy(frame.lights.sample_points.begin(), frame.lights.sample_points.end(), c->sample_lights.begin());
  CHECK_LE(frame.lights.polygons.count, c->light_polygons.count);
  std::copy(frame.lights.polygons.begin(), frame.lights.polygons.end(), c->light_polygons.begin());
  if (has(frame.mask, Effect::instant_radiosity)) c->virtual_lights[0] = *virtual_lights_of(frame.indirect);
  c->signature = c->followed;
  c->following = false;
  ++c->kept_count;
}

}  // namespace

void keep_frame(Coherence* c, const FrameData& frame) {
  std::fill(c->row_known.begin(), c->row_known.end(), std::uint8_t(1));
  keep(c, frame);
}

void keep_rows(Coherence* c, const FrameData& frame) {
  CHECK(c->following);
  for (std::uint32_t row = 0; row < c->plan.height; ++row)
    c->row_known[row] = c->row_traced[row] || (c->row_known[row] && count_changes(*c, row) == 0);
  keep(c, frame);
}

void measure_tiles(Coherence* c, const FrameData& frame, std::uint32_t tile_row, bool all) {
  CHECK_LT(tile_row, c->tile_rows);
  const std::uint64_t known = known_pixels(*c, tile_row);
  if (c->plan.tables_only || known == 0) return;
  for (std::uint32_t i = 0; i < c->tile_columns; ++i) {
    const std::uint32_t tile = tile_row * c->tile_columns + i;
    const PixelRect pixels = {i * kChangeTileSide, tile_row * kChangeTileSide, kChangeTileSide, kChangeTileSide};
    if (all || c->changed[tile]) {
      c->tiles[tile] = measure_tile(frame, c->first_hits.data, pixels.column, pixels.row, known);
      if (is_compensated(frame.settings, frame.mask))
        c->path_ends[tile] = measure_path_ends(frame, c->first_hits.data, c->paths.data, pixels, known);
    }
  }
}

}  // namespace pocketray
