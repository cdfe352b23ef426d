#include "temporal/recoloring.h"

#include <algorithm>
#include <cstring>

#include "base/check.h"
#include "shade/edges.h"
#include "shade/interleaved.h"
#include "shade/sample_points.h"
#include "temporal/beam_search.h"
#include "temporal/tile_search.h"

namespace pocketray {
namespace {

// Larger groups are not searched for triangles: their boxes decide.
constexpr std::uint32_t kSearchedMax = 256;

bool differ(const Vec3& a, const Vec3& b) { return std::memcmp(&a, &b, sizeof a) != 0; }

std::uint8_t marks_of(const Recoloring& r, const Triangle& t) { return r.marks[t.material()]; }

Box box_of(const FrameData& frame, const Triangle& t) {
  Box box = empty_box();
  if (!has_valid_vertices(frame.geometry.positions, t)) return box;
  for (std::uint32_t v : t.vertices()) box = merge(box, frame.geometry.positions[v]);
  return box;
}

void set_box(RecoloredGroups* groups, std::uint32_t lane, const Box& box) {
  for (int axis = 0; axis < 3; ++axis)
    groups->bounds[axis][lane] = box.low[axis], groups->bounds[3 + axis][lane] = box.high[axis];
}

// Divides the scene's triangles among groups that have about equally many triangles with changed blocking.
void make_groups(const FrameData& frame, std::uint32_t count, Recoloring* r) {
  const Array<const Triangle>& triangles = frame.scene->triangles;
  const std::uint32_t share = (count + kRecoloredGroups - 1) / kRecoloredGroups;
  std::uint32_t begin = 0, end = 0, found = 0;
  Box box = empty_box();
  auto end_group = [&] {
    if (is_empty(box)) box = no_child_box();
    CHECK_LT(r->group_count, kRecoloredGroups);
    RecoloredGroups* groups = &r->groups[r->group_count / 4];
    const std::uint32_t lane = r->group_count++ % 4;
    set_box(groups, lane, box);
    groups->begin[lane] = begin, groups->end[lane] = end;
    found = 0, box = empty_box();
  };
  for (std::uint32_t i = 0; i < triangles.count; ++i) {
    if (!(marks_of(*r, triangles[i]) & kStoppedMark)) continue;
    if (found++ == 0) begin = i;
    end = i + 1;
    const Box own = box_of(frame, triangles[i]);
    box = merge(box, own), r->bounds = merge(r->bounds, own);
    if (found == share) end_group();
  }
  if (found > 0) end_group();
  if (is_empty(r->bounds)) r->group_count = 0;
  for (std::uint32_t lane = r->group_count; lane % 4 != 0; ++lane)
    set_box(&r->groups[lane / 4], lane % 4, no_child_box());
}

// Returns whether a ray of the beam may meet a triangle of the group whose blocking has changed.
bool meets_triangle(const Recoloring& r, const FrameData& frame, const BeamHull& hull, std::uint32_t begin,
                    std::uint32_t end) {
  std::uint32_t ids[kBvhLeafSize], count = 0;
  TriangleBlock block;
  auto meets = [&] {
    kBlockLeaves.fill(frame.geometry.positions, frame.scene->triangles, ids, count, &block);
    return may_meet(hull, block, (1u << count) - 1) != 0;
  };
  for (std::uint32_t i = begin; i < end; ++i) {
    if (!(marks_of(r, frame.scene->triangles[i]) & kStoppedMark)) continue;
    ids[count++] = i;
    if (count < kBvhLeafSize) continue;
    if (meets()) return true;
    count = 0;
  }
  return count > 0 && meets();
}

// Returns whether a ray of the beam may be blocked where it was not, or no longer.
bool is_stopped_otherwise(const Recoloring& r, const FrameData& frame, const Beam& beam) {
  const BoundedBeam bounded = bounded_beam(beam, r.bounds);
  BeamHull hull;
  bool has_hull = false;
  for (std::uint32_t i = 0; 4 * i < r.group_count; ++i) {
    const RecoloredGroups& groups = r.groups[i];
    for (unsigned met = meets_both(bounded.tested, groups.bounds, groups.bounds); met; met &= met - 1) {
      const int lane = __builtin_ctz(met);
      const std::uint32_t begin = groups.begin[lane], end = groups.end[lane];
      if (!kTestsTriangles || end - begin > kSearchedMax) return true;
      if (!has_hull) hull = make_beam_hull(bounded), has_hull = true;
      if (meets_triangle(r, frame, hull, begin, end)) return true;
    }
  }
  return false;
}

struct TileOfPixels {
  const Recoloring& r;
  const ChangeSearch& search;
  const FrameData& frame;
  std::uint32_t column, row;
  std::uint64_t known;
  std::uint64_t found = 0, given = 0;

  std::uint64_t bit(std::uint32_t x, std::uint32_t y) const {
    return std::uint64_t(1) << (kChangeTileSide * (y - row) + (x - column));
  }
};

// Calls visit(x, y, sample, hit, bit) for the first hits of the tile's known pixels that are not found yet.
template <class Visit>
void for_each_hit(const TileOfPixels& tile, Visit visit) {
  const Settings& settings = tile.frame.settings;
  const std::uint32_t right = std::min(tile.column + kChangeTileSide, settings.width),
                      bottom = std::min(tile.row + kChangeTileSide, settings.height);
  const std::uint32_t samples = kept_sample_count(settings, tile.frame.mask);
  for (std::uint32_t sample = 0; sample < samples; ++sample)
    for (std::uint32_t y = tile.row; y < bottom; ++y)
      for (std::uint32_t x = tile.column; x < right; ++x) {
        const std::uint64_t bit = tile.bit(x, y);
        if (!(tile.known & ~tile.found & bit)) continue;
        if (sample >= settings.samples_per_pixel && !is_edge(settings, tile.search.last.first_hits, x, y)) continue;
        const std::size_t line = std::size_t(sample) * settings.height + y;
        visit(x, y, sample, tile.search.last.first_hits[line * settings.width + x], bit);
      }
}

Surface surface_at(const FrameData& frame, std::uint32_t x, std::uint32_t y, std::uint32_t sample, const Hit& hit) {
  const Vec2 offset = kept_sample_offset(frame.settings, sample);
  Surface s;
  frame.kernels.surface(
      frame, camera_ray(frame.view.camera, static_cast<float>(x) + offset.x, static_cast<float>(y) + offset.y), hit,
      &s);
  return s;
}

// Finds pixels that show a changed material.
void find_shown(TileOfPixels* tile) {
  for_each_hit(*tile, [&](std::uint32_t, std::uint32_t, std::uint32_t, const Hit& hit, std::uint64_t bit) {
    if (hit.triangle == kNoTriangle) return;
    const std::uint8_t marks = marks_of(tile->r, tile->frame.scene->triangles[hit.triangle]);
    if (marks & kGivenMark) tile->given |= bit;
    if (marks & kShownMark) tile->found |= bit;
  });
}

// Finds pixels whose camera rays pass different holes before they hit something.
void find_seen_through(TileOfPixels* tile, float t_max) {
  const CameraRays& camera = tile->frame.view.camera;
  const PixelRect all = {tile->column, tile->row, kChangeTileSide, kChangeTileSide};
  if (!is_stopped_otherwise(tile->r, tile->frame, camera_beam(camera, all, t_max))) return;
  for_each_hit(*tile, [&](std::uint32_t x, std::uint32_t y, std::uint32_t, const Hit& hit, std::uint64_t bit) {
    const float t = hit.triangle == kNoTriangle ? __builtin_inff() : hit.t;
    if (is_stopped_otherwise(tile->r, tile->frame, camera_beam(camera, {x, y, 1, 1}, t)))
      tile->found |= bit, tile->given |= bit;
  });
}

// Finds pixels whose shadow rays are blocked differently.
void find_shaded(TileOfPixels* tile, const TileHits& hits) {
  const FrameData& frame = tile->frame;
  if (!has(frame.mask, Effect::shadow)) return;
  for (int i = 0; i < frame.lights.run_count; ++i) {
    const LightRun& run = frame.lights.runs[i];
    for (std::uint32_t k = run.begin; k < run.end; ++k) {
      if (!is_stopped_otherwise(tile->r, frame, shadow_beam(frame, run, k, hits.points, hits.room))) continue;
      for_each_hit(*tile,
                   [&](std::uint32_t x, std::uint32_t y, std::uint32_t sample, const Hit& hit, std::uint64_t bit) {
                     if (hit.triangle == kNoTriangle) return;
                     const Vec3 point = point_of(frame, hit);
                     const LightPoint& light = points_of_sample(frame, sample)[k];
                     if (!is_stopped_otherwise(tile->r, frame, shadow_beam(run, light, {point, point}, hits.room)))
                       return;
                     LightSample light_sample;
                     if (lights_up(frame, surface_at(frame, x, y, sample, hit), run, light, &light_sample))
                       tile->found |= bit;
                   });
    }
  }
}

// Finds pixels whose rays to interleaved sources are blocked differently: they pass different light to neighbours.
void find_opened(TileOfPixels* tile, const TileHits& hits, const InterleavedSource& source) {
  const FrameData& frame = tile->frame;
  if (!has(frame.mask, source.effect)) return;
  tile->found &= tile->given;  // the others' rays are checked
  SourceRay ray[kSourcesOfPixelMax];
  const std::uint32_t count = source.count(frame);
  for (std::uint32_t k = 0; k < count; ++k) {
    const Vec3 place = source.place(frame, k);
    auto is_stopped_from = [&](const Box& points) {
      return is_stopped_otherwise(tile->r, frame, source_beam(source, place, points, hits.room));
    };
    if (!is_stopped_from(hits.points)) continue;
    for_each_hit(*tile, [&](std::uint32_t x, std::uint32_t y, std::uint32_t sample, const Hit& hit, std::uint64_t bit) {
      const std::uint32_t pixel_place = source_place(x, y);
      if (hit.triangle == kNoTriangle || place_of(pixel_place) != source.place_in_pattern(frame, k)) return;
      const Vec3 point = point_of(frame, hit);
      if (!is_stopped_from({point, point})) return;
      const SourceRay* end = ray + source.list_rays(frame, surface_at(frame, x, y, sample, hit), pixel_place, ray);
      if (std::any_of(static_cast<const SourceRay*>(ray), end, [&](const SourceRay& r) { return r.source == k; }))
        tile->found |= bit, tile->given |= bit;
    });
  }
}

}  // namespace

std::size_t recoloring_need(std::uint32_t material_count) {
  if (material_count == 0) return 0;
  return 2 * arena_need<std::uint8_t>(material_count) + arena_need<RecoloredGroups>(kRecoloredGroups / 4);
}

Recoloring make_recoloring(std::uint32_t material_count, Arena* keep) {
  Recoloring r;
  r.next = arena_array_zeroed<std::uint8_t>(keep, material_count);
  r.marks = arena_array_zeroed<std::uint8_t>(keep, material_count);
  r.groups = arena_array_zeroed<RecoloredGroups>(keep, kRecoloredGroups / 4);
  return r;
}

void mark_material(const Material& was, const Material& is, const Scene& scene, std::uint32_t index, Recoloring* r) {
  if (std::memcmp(static_cast<const void*>(&was), &is, sizeof is) == 0) return;
  const bool is_textured_anew = was.diffuse_texture.texture != is.diffuse_texture.texture;
  const bool is_tinted = scene.colors.count || is.diffuse_texture.texture != kNone;
  const bool has_other_holes = is_textured_anew && is.alpha_mode == AlphaMode::mask;
  const bool turns_opaque = is.alpha_mode != AlphaMode::blend && is_zero(was.transmission) != is_zero(is.transmission);
  CHECK_LT(index, r->next.count);
  std::uint8_t marks = kShownMark;
  if (is_textured_anew || (is_tinted ? differ(was.diffuse, is.diffuse) : is_zero(was.diffuse) != is_zero(is.diffuse)))
    marks |= kGivenMark;
  if (has_other_holes || turns_opaque) marks |= kStoppedMark;
  if (differ(was.absorption, is.absorption)) marks |= kInsideMark;
  r->next[index] |= marks;
  r->any_next = true;
}

void take_marks(Recoloring* r) {
  r->any = r->any_next;
  if (!r->any) return;
  std::copy(r->next.begin(), r->next.end(), r->marks.begin());
  std::fill(r->next.begin(), r->next.end(), std::uint8_t(0));
  r->any_next = false;
}

const char* follow_recoloring(const FrameData& frame, const MovingGeometry& moving, Recoloring* r) {
  const Scene& scene = *frame.scene;
  CHECK_EQ(scene.materials.count, r->marks.count);
  for (std::uint32_t i = 0; i < frame.view.eye_media.depth; ++i)
    if (r->marks[frame.view.eye_media.material[i]] & kInsideMark) return "the body around the camera was recoloured";
  r->group_count = 0, r->bounds = empty_box();
  r->has_holes = false;
  bool passes = false;
  for (std::uint32_t i = 0; i < scene.materials.count; ++i) {
    if (!(r->marks[i] & kStoppedMark)) continue;
    passes = true;
    r->has_holes |= scene.materials[i].alpha_mode == AlphaMode::mask;
  }
  if (!passes) return nullptr;
  std::uint32_t count = 0;
  for (std::uint32_t i = 0; i < scene.triangles.count; ++i) {
    if (!(marks_of(*r, scene.triangles[i]) & kStoppedMark)) continue;
    ++count;
    if (!moving.changed) continue;
    // Its blocking in its last position is not known.
    const std::uint32_t place = moving_index(moving, i);
    if (place != kNoTriangle && moving.triangle_changed[place]) return "a recoloured surface moved";
  }
  make_groups(frame, count, r);
  return nullptr;
}

void add_recolored(const FrameData& frame, const Recoloring& r, RayTables* tables) {
  for (const Triangle& t : frame.scene->triangles)
    if (marks_of(r, t)) add_dirty(tables, box_of(frame, t));
}

std::uint64_t find_recolored(const Recoloring& r, const ChangeSearch& search, std::uint32_t tile, std::uint64_t known,
                             std::uint64_t* given) {
  CHECK(r.any);
  TileOfPixels t = {r,
                    search,
                    *search.frame,
                    tile % search.tile_columns * kChangeTileSide,
                    tile / search.tile_columns * kChangeTileSide,
                    known};
  find_shown(&t);
  std::uint64_t found = t.found;
  if (r.group_count > 0) {
    const TileHits& hits = search.tiles[tile];
    if (r.has_holes) find_seen_through(&t, hits.t_max);
    if (!is_empty(hits.points)) {
      find_shaded(&t, hits);
      found |= t.found;
      for (const InterleavedSource* source : kInterleavedSources) {
        find_opened(&t, hits, *source);
        found |= t.found;
      }
    }
    found |= t.found;
  }
  *given |= t.given;
  forget_shadows(search, tile, found);
  return found;
}

}  // namespace pocketray
