// Finds changed light and shadows on unchanged first hits.
#include <algorithm>

#include "accel/accel_list.h"
#include "base/check.h"
#include "temporal/shadow_rays.h"

namespace pocketray {
namespace {

constexpr float kInfinity = __builtin_inff();

}  // namespace

Beam shadow_beam(const LightRun& run, const LightPoint& light, const Box& points, float room) {
  const Box from = {points.low - Vec3{room, room, room}, points.high + Vec3{room, room, room}};
  if (run.sample == find_light_sampler(Effect::directional_light))
    return beam_along(from, {-light.direction, -light.direction}, kInfinity);
  // A ray that starts beside its point ends as far beside the light.
  return {from.low, from.high, light.position - points.low, light.position - points.high, 1};
}

Beam shadow_beam(const FrameData& frame, const LightRun& run, std::uint32_t light, const Box& points, float room) {
  const Lights& lights = frame.lights;
  Beam beam = shadow_beam(run, lights.points[light], points, room);
  for (std::uint32_t k = light; k < lights.sample_points.count; k += lights.points.count) {
    const Beam other = shadow_beam(run, lights.sample_points[k], points, room);
    beam.low_slope = min(beam.low_slope, other.low_slope), beam.high_slope = max(beam.high_slope, other.high_slope);
  }
  return beam;
}

namespace {

// Finds in groups the receivers whose shadow ray to the light may meet a change, except those that need no test.
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

// Lists the shadow rays of the receivers to the light; receivers that cast none are idle.
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
            {below ? curved_origin(t->frame, surface) : safe_origin(surface, 1), sample.to_light, sample.t_max,
             below ? kNoTriangle : surface.hit.triangle});
  }
}

}  // namespace

bool may_shade(const ChangeSearch& search, const TileHits& hits, const LightRun& run, std::uint32_t light) {
  return meets_change(*search.moving, shadow_beam(*search.frame, run, light, hits.points, hits.room));
}

void find_lit_by(TileSearch* t, const LightRun& run, std::uint32_t light) {
  const LightPoint &is = t->lights[light], &was = t->last_lights[light];
  for (std::uint32_t k = 0; k < t->receiver_count; ++k) {
    if (t->changed & bit_of(t->pixels, t->receiver[k])) continue;
    const Surface& s = surface_of(t, k);
    LightSample sample;
    if (lights_up(t->frame, s, run, was, &sample) || lights_up(t->frame, s, run, is, &sample))
      t->changed |= bit_of(t->pixels, t->receiver[k]);
  }
}

void find_changed_shadows(TileSearch* t, const LightRun& run, std::uint32_t light, float room, bool is_kept,
                          KnownShadows* known) {
  const FrameData& frame = t->frame;
  const MovingGeometry& m = *t->search.moving;
  ShadowRays s;
  list_shadow_rays(t, run, t->lights[light], room, known, &s);
  if (s.rays.count == 0) return;
  ShadowContext shadow = {&frame, emitter_of(t->lights[light])};
  bool filtered = frame.filters.every_shadow || shadow.emitter != nullptr;
  bool clear = frame.filters.accept_clear != nullptr;  // a transparent surface tints: anything in the way counts
  const ShadowFilters filters(m, {filtered ? frame.filters.accept_opaque : nullptr, &shadow});
  const HitFilter* filter = filtered && !clear ? &filters.moving : nullptr;

  std::uint64_t fresh = 0, was = 0;
  for (std::uint32_t i = 0; i < s.rays.count; ++i) {
    if (known->known & s.pixel[i])
      was |= std::uint64_t((known->blocked & s.pixel[i]) != 0) << i;
    else
      fresh |= std::uint64_t(1) << i;
  }
  auto idle_of = [&](std::uint64_t which) {
    t->counts->static_rays += static_cast<std::uint64_t>(__builtin_popcountll(which));
    return blocked_by_scene(frame, s, which, &filters.other, t->stats);
  };
  const std::uint64_t all = ~std::uint64_t(0) >> (kPacketMax - s.rays.count);
  std::uint64_t idle = is_kept ? idle_of(fresh) : 0;
  was |= blocked_by_moving(m.last, s, fresh & ~idle, filter, t->stats);
  const std::uint64_t is = blocked_by_moving(m.now, s, all & ~idle, filter, t->stats);
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

}  // namespace pocketray
