#include "temporal/tile_changes.h"

#include <algorithm>
#include <cstring>

#include "accel/accel_list.h"
#include "base/check.h"
#include "shade/camera.h"
#include "shade/filters.h"
#include "shade/interleaved.h"
#include "shade/lights.h"
#include "shade/trace_spans.h"

namespace pocketray {
namespace {

constexpr float kInfinity = __builtin_inff();

// The point of a hit.
Vec3 point_of(const FrameData& frame, const Hit& hit) {
  const Triangle& t = frame.scene->triangles[hit.triangle];
  return frame.positions[t.vertex(0)] * (1 - hit.u - hit.v) + frame.positions[t.vertex(1)] * hit.u +
         frame.positions[t.vertex(2)] * hit.v;
}

// The pixels of a tile, in Morton order: neighbours adjacent.
struct TilePixels {
  std::uint32_t column, row;  // of the first
  std::uint32_t count = 0;
  std::uint8_t x[kPacketMax], y[kPacketMax];
};

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

std::uint64_t bit_of(const TilePixels& p, std::uint32_t i) { return std::uint64_t(1) << (8 * p.y[i] + p.x[i]); }

std::size_t index_of(const Settings& settings, const TilePixels& p, std::uint32_t i) {
  return std::size_t(p.row + p.y[i]) * settings.width + p.column + p.x[i];
}

Ray sample_ray(const FrameData& frame, const TilePixels& p, std::uint32_t i, const Vec2& offset) {
  return camera_ray(frame.camera, static_cast<float>(p.column + p.x[i]) + offset.x,
                    static_cast<float>(p.row + p.y[i]) + offset.y);
}

// A shadow ray's filter, for triangles of the moving geometry.
struct MovingFilter {
  const MovingGeometry* moving;
  HitFilter inner;
};
bool accept_moving(const void* context, std::uint32_t triangle, float u, float v) {
  const auto& f = *static_cast<const MovingFilter*>(context);
  return f.inner.accept(f.inner.context, f.moving->ids[triangle], u, v);
}
// The same for all other triangles of the scene.
bool accept_static(const void* context, std::uint32_t triangle, float u, float v) {
  const auto& f = *static_cast<const MovingFilter*>(context);
  if (moving_index(*f.moving, triangle) != kNoTriangle) return false;
  return !f.inner.accept || f.inner.accept(f.inner.context, triangle, u, v);
}

struct TileSearch {
  const ChangeSearch& search;
  const FrameData& frame;
  const TilePixels& pixels;
  std::uint64_t changed;
  std::uint64_t given;  // pixels that may give other light to those about them
  ChangeCounts* counts;
  TraceStats* stats;
  const Hit* hits = nullptr;  // of the sample
  Vec2 offset = {0, 0};
  std::uint32_t receiver_count = 0;   // first hits that may receive light
  std::uint8_t receiver[kPacketMax];  // their pixels
  Vec3 point[kPacketMax];             // of each receiver
  std::uint64_t has_surface = 0;      // of each receiver
  Surface surface[kPacketMax];        // of each receiver
};

// The beam of all camera rays of the tile, up to its farthest hit.
Beam camera_beam(const CameraRays& c, std::uint32_t column, std::uint32_t row, const TileHits& hits) {
  Box origins = empty_box(), directions = empty_box();
  for (int corner = 0; corner < 4; ++corner) {
    float x = static_cast<float>(column + (corner & 1 ? kChangeTileSide : 0));
    float y = static_cast<float>(row + (corner & 2 ? kChangeTileSide : 0));
    float sx = 2 * x / c.width - 1, sy = 1 - 2 * y / c.height;
    Vec3 aside = c.right * sx + c.up * sy;
    origins = merge(origins, c.orthographic ? c.eye + aside : c.eye);
    directions = merge(directions, c.orthographic ? c.forward : c.forward + aside);
  }
  // These directions are as long as camera_ray()'s, or longer.
  return beam_along(origins, directions, hits.t_max);
}

// Whether the ray's first hit, which was `last`, is another one now that its nearest moving triangle is `moving`.
bool hits_otherwise(const MovingGeometry& m, const Hit& last, const Hit& moving) {
  std::uint32_t id = moving.triangle == kNoTriangle ? kNoTriangle : m.ids[moving.triangle];
  std::uint32_t was = last.triangle == kNoTriangle ? kNoTriangle : moving_index(m, last.triangle);
  if (was != kNoTriangle)
    return m.triangle_changed[was] || id != last.triangle || moving.t != last.t || moving.u != last.u ||
           moving.v != last.v;
  if (id == kNoTriangle) return false;
  return last.triangle == kNoTriangle || moving.t < last.t || (moving.t == last.t && id < last.triangle);
}

void find_changed_hits(TileSearch* t) {
  const TilePixels& p = t->pixels;
  Hit found[kPacketMax];
  if (t->frame.camera.orthographic) {
    for (std::uint32_t i = 0; i < p.count; ++i)
      kBvhAccel.closest(t->search.moving->now, sample_ray(t->frame, p, i, t->offset), nullptr, &found[i], t->stats);
  } else {
    RayPacket packet;
    packet.origin = t->frame.camera.eye, packet.t_max = kInfinity, packet.count = p.count;
    for (std::uint32_t i = 0; i < p.count; ++i) {
      Vec3 direction = sample_ray(t->frame, p, i, t->offset).direction;
      for (int axis = 0; axis < 3; ++axis) packet.direction[axis][i] = direction[axis];
    }
    kBvhAccel.closest_packet(t->search.moving->now, packet, nullptr, found, t->stats);
  }
  t->counts->moving_rays += p.count;
  for (std::uint32_t i = 0; i < p.count; ++i)
    if (hits_otherwise(*t->search.moving, t->hits[index_of(t->frame.settings, p, i)], found[i]))
      t->changed |= bit_of(p, i);
}

bool scatters(const Material& m) { return !is_zero(m.diffuse) || !is_zero(m.specular); }

// The pixels whose first hits are the last frame's and may receive light.
void find_receivers(TileSearch* t) {
  t->receiver_count = 0;
  t->has_surface = 0;
  for (std::uint32_t i = 0; i < t->pixels.count; ++i) {
    const Hit& hit = t->hits[index_of(t->frame.settings, t->pixels, i)];
    if (hit.triangle == kNoTriangle || t->changed & bit_of(t->pixels, i)) continue;
    if (!scatters(t->frame.scene->materials[t->frame.scene->triangles[hit.triangle].material()])) continue;
    t->point[t->receiver_count] = point_of(t->frame, hit);
    t->receiver[t->receiver_count++] = static_cast<std::uint8_t>(i);
  }
}

const Surface& surface_of(TileSearch* t, std::uint32_t k) {
  if (t->has_surface >> k & 1) return t->surface[k];
  t->has_surface |= std::uint64_t(1) << k;
  const std::uint32_t i = t->receiver[k];
  t->frame.surface(t->frame, sample_ray(t->frame, t->pixels, i, t->offset),
                   t->hits[index_of(t->frame.settings, t->pixels, i)], &t->surface[k]);
  return t->surface[k];
}

// Pixels that the light reached, or would reach, if nothing were in the way, before or after it changed.
void find_lit_by(TileSearch* t, const LightRun& run, std::uint32_t light) {
  const LightPoint &is = t->frame.lights[light], &was = t->search.last.lights[light];
  for (std::uint32_t k = 0; k < t->receiver_count; ++k) {
    if (t->changed & bit_of(t->pixels, t->receiver[k])) continue;
    const Surface& s = surface_of(t, k);
    LightSample sample;
    if (lights_up(t->frame, s, run, was, &sample) || lights_up(t->frame, s, run, is, &sample))
      t->changed |= bit_of(t->pixels, t->receiver[k]);
  }
}

// All shadow rays from the points to the light.
Beam shadow_beam(const LightRun& run, const LightPoint& light, const Box& points, float room) {
  const Box from = {points.low - Vec3{room, room, room}, points.high + Vec3{room, room, room}};
  if (run.sample == find_light_sampler(Effect::directional_light))
    return beam_along(from, {-light.direction, -light.direction}, kInfinity);
  // A ray that starts beside its point ends as far beside the light.
  return {from.low, from.high, light.position - points.low, light.position - points.high, 1};
}

// The receivers whose shadow ray to the light may meet a change, found in groups; without those that need no look.
std::uint64_t find_suspects(const TileSearch& t, const LightRun& run, const LightPoint& light, float room,
                            std::uint64_t idle) {
  constexpr std::uint32_t kGroup = 16;  // a quarter of a whole tile; smaller groups cost more than they save
  std::uint64_t suspects = 0;
  for (std::uint32_t begin = 0; begin < t.receiver_count; begin += kGroup) {
    const std::uint32_t end = std::min(begin + kGroup, t.receiver_count);
    Box points = empty_box();
    std::uint64_t group = 0;
    for (std::uint32_t k = begin; k < end; ++k) {
      if ((t.changed | idle) & bit_of(t.pixels, t.receiver[k])) continue;
      group |= std::uint64_t(1) << k;
      points = merge(points, t.point[k]);
    }
    if (group && meets_change(*t.search.moving, shadow_beam(run, light, points, room))) suspects |= group;
  }
  return suspects;
}

struct ShadowRays {
  SegmentPacket rays;
  std::uint64_t pixel[kPacketMax];  // of each, as a bit of the tile
};

// Which of the rays `which` something blocks; bit i is ray i.
std::uint64_t blocked_among(const AccelTraversal& traversal, const Accel& accel, const ShadowRays& s,
                            std::uint64_t which, const HitFilter* filter, TraceStats* stats) {
  if (which == 0) return 0;
  SegmentPacket some;
  std::uint8_t place[kPacketMax];
  some.count = 0;
  for (std::uint64_t rest = which; rest; rest &= rest - 1) {
    place[some.count] = static_cast<std::uint8_t>(__builtin_ctzll(rest));
    set_ray(&some, some.count, ray_of(s.rays, place[some.count]));
    ++some.count;
  }
  std::uint64_t found = traversal.occluded_packet(accel, some, filter, stats), blocked = 0;
  for (std::uint32_t i = 0; i < some.count; ++i) blocked |= (found >> i & 1) << place[i];
  return blocked;
}

// The shadow rays of the receivers to the light; those that cast none are idle.
void list_shadow_rays(TileSearch* t, const LightRun& run, const LightPoint& light, float room, KnownShadows* known,
                      ShadowRays* s) {
  s->rays.count = 0;
  for (std::uint64_t rest = find_suspects(*t, run, light, room, known->idle); rest; rest &= rest - 1) {
    const std::uint32_t k = static_cast<std::uint32_t>(__builtin_ctzll(rest));
    const Surface& surface = surface_of(t, k);
    const std::uint64_t bit = bit_of(t->pixels, t->receiver[k]);
    LightSample sample;
    if (!lights_up(t->frame, surface, run, light, &sample)) {
      known->idle |= bit;
      continue;
    }
    bool below = !(dot(surface.geometric, sample.direction) > 0);  // as in direct_light()
    s->pixel[s->rays.count] = bit;
    set_ray(&s->rays, s->rays.count++,
            {below ? curved_origin(t->frame, surface) : safe_origin(surface, 1), sample.to_light, sample.t_max});
  }
}

// Pixels whose shadow ray to the light is blocked where it was not, or no longer. If what is found is kept, whether
// something static blocks a ray is found at the first look, otherwise only where it matters.
void find_changed_shadows(TileSearch* t, const LightRun& run, std::uint32_t light, float room, bool is_kept,
                          KnownShadows* known) {
  const FrameData& frame = t->frame;
  const MovingGeometry& m = *t->search.moving;
  ShadowRays s;
  list_shadow_rays(t, run, frame.lights[light], room, known, &s);
  if (s.rays.count == 0) return;
  ShadowContext shadow = {&frame, frame.lights[light].material};
  bool filtered = frame.filter_every_shadow || shadow.emitter != kNone;
  bool clear = frame.accept_clear != nullptr;  // a transparent surface tints: anything in the way counts
  MovingFilter context = {&m, {filtered ? frame.accept_opaque : nullptr, &shadow}};
  HitFilter opaque = {accept_moving, &context}, other = {accept_static, &context};
  const HitFilter* filter = filtered && !clear ? &opaque : nullptr;

  std::uint64_t fresh = 0, was = 0;
  for (std::uint32_t i = 0; i < s.rays.count; ++i) {
    if (known->known & s.pixel[i])
      was |= std::uint64_t((known->blocked & s.pixel[i]) != 0) << i;
    else
      fresh |= std::uint64_t(1) << i;
  }
  auto idle_of = [&](std::uint64_t which) {
    t->counts->static_rays += static_cast<std::uint64_t>(__builtin_popcountll(which));
    return blocked_among(*frame.first_rays, frame.accel, s, which, &other, t->stats);
  };
  const std::uint64_t all = ~std::uint64_t(0) >> (kPacketMax - s.rays.count);
  std::uint64_t idle = is_kept ? idle_of(fresh) : 0;
  was |= blocked_among(kBvhAccel, m.last, s, fresh & ~idle, filter, t->stats);
  const std::uint64_t is = blocked_among(kBvhAccel, m.now, s, all & ~idle, filter, t->stats);
  t->counts->moving_rays += static_cast<std::uint64_t>(__builtin_popcountll(fresh & ~idle)) +
                            static_cast<std::uint64_t>(__builtin_popcountll(all & ~idle));
  std::uint64_t changed = clear ? was | is : was ^ is;
  if (!is_kept) changed &= ~idle_of(changed);
  for (std::uint32_t i = 0; i < s.rays.count; ++i) {
    if (idle >> i & 1) known->idle |= s.pixel[i];
    known->known |= s.pixel[i];
    known->blocked = (is >> i & 1) ? known->blocked | s.pixel[i] : known->blocked & ~s.pixel[i];
    if (changed >> i & 1) t->changed |= s.pixel[i];
  }
}

// All shadow rays from the points towards a distant light.
Beam distant_beam(const EnvironmentLight& light, const TileHits& hits) {
  const Vec3 room = {hits.room, hits.room, hits.room};
  return beam_along({hits.points.low - room, hits.points.high + room}, {light.direction, light.direction}, kInfinity);
}

// Calls visit(index, light) for each distant light of the environment towards which the tile has a ray that can meet a
// change. Stops when it returns false.
template <class Visit>
void for_each_distant_suspect(const ChangeSearch& search, const TileHits& hits, Visit visit) {
  const FrameData& frame = *search.frame;
  if (!has(frame.mask, Effect::environment_shadow) || is_empty(hits.points) || !search.moving->changed) return;
  const EnvironmentLights& lights = *frame.environment_lights;
  for (std::uint32_t i = 0; i < lights.count; ++i)
    if (meets_change(*search.moving, distant_beam(lights.light[i], hits)) && !visit(i, lights.light[i])) return;
}

// Pixels of which a ray towards the environment is blocked where it was not, or no longer.
void find_changed_openness(TileSearch* t, ShadowRays* s) {
  if (s->rays.count == 0) return;
  const FrameData& frame = t->frame;
  const MovingGeometry& m = *t->search.moving;
  ShadowContext shadow = {&frame, kNone};
  MovingFilter context = {&m, {frame.filter_every_shadow ? frame.accept_opaque : nullptr, &shadow}};
  HitFilter opaque = {accept_moving, &context}, other = {accept_static, &context};
  const HitFilter* filter = frame.filter_every_shadow ? &opaque : nullptr;
  const std::uint64_t all = ~std::uint64_t(0) >> (kPacketMax - s->rays.count);
  const std::uint64_t changed = blocked_among(kBvhAccel, m.last, *s, all, filter, t->stats) ^
                                blocked_among(kBvhAccel, m.now, *s, all, filter, t->stats);
  const std::uint64_t hidden = blocked_among(*frame.first_rays, frame.accel, *s, changed, &other, t->stats);
  t->counts->moving_rays += 2 * s->rays.count;
  t->counts->static_rays += static_cast<std::uint64_t>(__builtin_popcountll(changed));
  for (std::uint32_t i = 0; i < s->rays.count; ++i)
    if ((changed & ~hidden) >> i & 1) t->given |= s->pixel[i];
  s->rays.count = 0;
}

// Adds the pixels that may give other light to `given`: without a first hit of the last frame, or by their rays.
void find_other_light(TileSearch* t, const TileHits& hits) {
  if (!has(t->frame.mask, Effect::environment_shadow)) return;
  t->given |= t->changed;  // no receivers: their rays are not looked at
  ShadowRays s;
  s.rays.count = 0;
  for_each_distant_suspect(t->search, hits, [&](std::uint32_t index, const EnvironmentLight& light) {
    for (std::uint32_t k = 0; k < t->receiver_count; ++k) {
      const std::uint32_t i = t->receiver[k];
      if (morton_place(t->pixels.x[i] % kPatternSide, t->pixels.y[i] % kPatternSide) != index % kPatternPixels)
        continue;
      if (t->given & bit_of(t->pixels, i)) continue;
      const Surface& surface = surface_of(t, k);
      if (is_zero(surface.diffuse) || !arrives(light, surface)) continue;
      s.pixel[s.rays.count] = bit_of(t->pixels, i);
      set_ray(&s.rays, s.rays.count++, {safe_origin(surface, 1), light.direction, kInfinity});
      if (s.rays.count == kPacketMax) find_changed_openness(t, &s);
    }
    return true;
  });
  find_changed_openness(t, &s);
  t->changed |= t->given;
}

bool has_light_changed(const ChangeSearch& search, const LightRun& run, std::uint32_t light) {
  const FrameData& frame = *search.frame;
  if (!search.lights_changed) return false;
  if (std::memcmp(&search.last.lights[light], &frame.lights[light], sizeof(LightPoint)) != 0) return true;
  if (!run.polygons) return false;
  const std::uint32_t lamp = (light - run.begin) / frame.settings.points_per_area_light;
  return std::memcmp(&search.last.light_polygons[lamp], &run.polygons[lamp], sizeof(LightPolygon)) != 0;
}

// Calls visit(run, light, has_changed) for each light that has changed, or to which the tile has a ray that can meet a
// change. Stops when it returns false.
template <class Visit>
void for_each_suspect(const ChangeSearch& search, const TileHits& hits, Visit visit) {
  const FrameData& frame = *search.frame;
  if (is_empty(hits.points)) return;
  const bool casts = has(frame.mask, Effect::shadow) && search.moving->changed;
  for (int r = 0; r < frame.light_run_count; ++r) {
    const LightRun& run = frame.light_runs[r];
    for (std::uint32_t i = run.begin; i < run.end; ++i) {
      const LightPoint& light = frame.lights[i];
      const bool has_changed = has_light_changed(search, run, i);
      if (!has_changed) {
        if (!casts) continue;
        if (!meets_change(*search.moving, shadow_beam(run, light, hits.points, hits.room))) continue;
      }
      if (!visit(run, i, has_changed)) return;
    }
  }
}

// Pixels with rays in the tables that may have met a change.
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

std::uint64_t find_changes_of(const ChangeSearch& search, std::uint32_t tile, std::uint64_t known_pixels,
                              std::uint64_t* given, ChangeCounts* counts, TraceStats* stats) {
  const FrameData& frame = *search.frame;
  const TileHits& hits = search.tiles[tile];
  const std::uint32_t column = tile % search.tile_columns * kChangeTileSide,
                      row = tile / search.tile_columns * kChangeTileSide;
  const std::uint64_t marked = find_marked(search, column, row) & known_pixels;
  const bool seen =
      search.moving->changed && meets_change(*search.moving, camera_beam(frame.camera, column, row, hits));
  bool any = seen;
  if (!any) for_each_suspect(search, hits, [&](const LightRun&, std::uint32_t, bool) { return !(any = true); });
  if (!any)
    for_each_distant_suspect(search, hits, [&](std::uint32_t, const EnvironmentLight&) { return !(any = true); });
  if (!any) return marked;
  const TilePixels pixels = pixels_of(frame.settings, column, row, known_pixels);
  if (pixels.count == 0) return 0;
  TileSearch t = {search, frame, pixels, marked, *given, counts, stats};
  for (std::uint32_t sample = 0; sample < frame.settings.samples_per_pixel; ++sample) {
    t.hits = search.last.first_hits + std::size_t(sample) * frame.settings.width * frame.settings.height;
    t.offset = sample_offset(sample, frame.settings.samples_per_pixel);
    if (seen) find_changed_hits(&t);
    find_receivers(&t);
    find_other_light(&t, hits);
    KnownShadows* known = known_shadows(search, sample, tile);
    for_each_suspect(search, hits, [&](const LightRun& run, std::uint32_t light, bool has_changed) {
      const bool is_kept = light < search.known_lights;
      KnownShadows none, *of_light = is_kept ? &known[light] : &none;
      // A light that changed: what is known holds for the pixels that it did not reach, and does not now.
      has_changed ? find_lit_by(&t, run, light) : find_changed_shadows(&t, run, light, hits.room, is_kept, of_light);
      return true;
    });
  }
  *given = t.given;
  return t.changed;
}

}  // namespace

void forget_shadows(const ChangeSearch& search, std::uint32_t tile, std::uint64_t changed) {
  if (!changed) return;
  for (std::uint32_t sample = 0; sample < search.frame->settings.samples_per_pixel; ++sample) {
    KnownShadows* known = known_shadows(search, sample, tile);
    for (std::uint32_t light = 0; light < search.known_lights; ++light)
      known[light].known &= ~changed, known[light].idle &= ~changed;
  }
}

std::uint64_t find_changed_pixels(const ChangeSearch& search, std::uint32_t tile, std::uint64_t known,
                                  std::uint64_t* given, ChangeCounts* counts, TraceStats* stats) {
  const std::uint64_t changed = find_changes_of(search, tile, known, given, counts, stats);
  forget_shadows(search, tile, changed);
  return changed;
}

}  // namespace pocketray
