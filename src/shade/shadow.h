// Shadow rays, and the light that transparent surfaces transmit.
#pragma once
#include <algorithm>

#include "base/fmath.h"
#include "effect/effect_probe.h"
#include "shade/contact.h"
#include "shade/dielectric.h"
#include "shade/filters.h"
#include "shade/instances.h"
#include "shade/lights.h"
#include "shade/media.h"
#include "shade/point_groups.h"
#include "shade/sample_points.h"
#include "shade/surface.h"
#include "shade/texture.h"
#include "shade/tile_shadows.h"
#include "shade/tracer.h"
#include "shade/transmission.h"

namespace pocketray {

// The effects to simulate.
template <EffectMask mask>
constexpr EffectMask plan_of(const FrameData& frame) {
  constexpr EffectMask held = held_contacts(mask);
  if constexpr (held == 0) return mask;
  return (mask & ~held) | (frame.mask & held);
}

// Effects on which transmitted light depends; the instance of coats looks up textures of glass.
constexpr EffectMask kPassageEffects =
    bit(Effect::refraction) | bit(Effect::absorption) | bit(Effect::alpha_blend) | bit(Effect::clear_coat);

// Returns whether to skip a contribution of at most `bound`: the total skipped of a sample stays below half the
// narrowest display level, so no pixel changes by more than one level.
inline bool leave_out_light(Tracer* tracer, float bound) {
  if (!(bound <= tracer->skip_max)) return false;
  tracer->budget -= bound;
  tracer->skip_max = std::min(tracer->skip_max, tracer->budget);
  return true;
}
// As above, for light that a ray would have tested.
inline bool leave_out(Tracer* tracer, float bound) {
  const bool left_out = leave_out_light(tracer, bound);
  tracer->rays_left_out += left_out;
  return left_out;
}

// Transmittance of a contact for an unrefracted ray: Fresnel once, from the body that ends to the one that begins (air
// if none), times the tints of all bodies entered. `s` is the surface that the ray meets.
template <EffectMask mask>
inline Vec3 interface_transmittance(const FrameData& frame, const Ray& ray, const Surface& s, const Contact& contact,
                                    float cos_i) {
  Vec3 tint = {1, 1, 1};
  float from = 1, to = 1;
  bool any = false;
  for (std::uint32_t i = 0; i < contact.count; ++i) {
    const Face& face = contact.face[i];
    const Material& m = frame.scene->materials[face.material];
    if (is_zero(m.transmission)) continue;
    effect_entered<Effect::refraction>();
    any = true;
    if (face.front || m.thin) {
      if constexpr (has(mask, Effect::clear_coat))
        tint *= transmission_of(frame, ray, face, s);
      else
        tint *= m.transmission;
    }
    (face.front || m.thin ? to : from) = m.ior;
  }
  if (!any) return tint;
  float cos_t;
  return tint * (1 - fresnel(cos_i, from / to, &cos_t));
}

// Σ absorption × distance through bodies, from the sums at their entries and exits and the absorption still `open` at
// the end of the ray, which may be at infinity. If the sums overflow, their difference is unknown: nothing passes.
inline float optical_depth(float begin, float end, float open, float distance) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  if (!(begin < kInfinity && end < kInfinity)) return kInfinity;
  return open > 0 ? (end - begin) + open * distance : end - begin;
}

// Transmittance of the transparent surfaces between the point and the light, without refraction, in order along the
// ray: products of floats do not commute in the last bit, and every accelerator must give equal results.
template <EffectMask mask>
Vec3 clear_transmittance(Tracer* tracer, Ray ray, const ShadowContext& context, bool at_first_hit) {
  const FrameData& frame = *tracer->frame;
  const EffectMask plan = plan_of<mask>(frame);
  HitFilter filter = {frame.filters.accept_clear, &context, frame.filters.read_point};
  Vec3 result = {1, 1, 1};
  Vec3 absorbed_begin = {0, 0, 0}, absorbed_end = {0, 0, 0};  // Σ absorption × distance at entries and exits
  Vec3 open = {0, 0, 0};                                      // absorption of the bodies entered and not yet left
  int open_count =
      0;  // number of these bodies: `open` alone keeps a rounding error, which would make an infinite ray opaque
  float unit = length(ray.direction), passed = 0;
  for (std::uint32_t layer = 0; layer < kTransparentLayerMax; ++layer) {
    Hit hit;
    ++tracer->rays[static_cast<int>(RayKind::shadow)];
    const AccelTraversal& rays = at_first_hit && layer == 0 ? *frame.geometry.first_rays : *frame.geometry.accel_info;
    rays.closest(frame.geometry.accel, ray, &filter, &hit, &tracer->stats);
    if (hit.triangle == kNoTriangle) {
      if (has(plan, Effect::absorption)) {
        float end = (passed + ray.t_max) * unit;
        if (open_count <= 0) open = {0, 0, 0};
        Vec3 inside;
        for (int c = 0; c < 3; ++c) inside[c] = optical_depth(absorbed_begin[c], absorbed_end[c], open[c], end);
        result *= transmittance(inside, 1.0f);
      }
      return result;
    }
    Surface s;
    Hit place = hit;
    place.t = 0;  // not along a path from the eye: shadows read the textures' largest level
    frame.kernels.surface(frame, ray, place, &s);
    Contact contact;
    gather_contact(frame, s, hit, &filter, &contact, &tracer->stats);
    if (has(plan, Effect::refraction)) {
      result *= interface_transmittance<mask>(frame, ray, s, contact, std::fabs(dot(s.normal, ray.direction)) / unit);
      if (has(plan, Effect::absorption)) {
        float distance = (passed + hit.t) * unit;
        for (std::uint32_t i = 0; i < contact.count; ++i) {
          const Material& m = frame.scene->materials[contact.face[i].material];
          if (is_zero(m.transmission) || m.thin || is_zero(m.absorption)) continue;
          effect_entered<Effect::absorption>();
          bool enters = contact.face[i].front;
          (enters ? absorbed_begin : absorbed_end) += m.absorption * distance;
          open = enters ? open + m.absorption : open - m.absorption;
          open_count += enters ? 1 : -1;
        }
      }
    }
    if (has(plan, Effect::alpha_blend)) {
      for (std::uint32_t i = 0; i < contact.count; ++i) {
        const Face& face = contact.face[i];
        const Material& m = frame.scene->materials[face.material];
        if (m.alpha_mode != AlphaMode::blend) continue;
        float alpha = hit_alpha<Effect::alpha_blend>(frame, m, face.hit.triangle, face.hit.u, face.hit.v);
        result = result * (1 - alpha);
      }
    }
    if (!(max_component(result) > 0)) return {0, 0, 0};
    passed += hit.t;
    ray.origin = safe_origin(s, -1);
    ray.t_max -= hit.t;
    if (!(ray.t_max > 0)) return result;
  }
  return {0, 0, 0};
}

inline Ray shadow_ray(const FrameData& frame, const Surface& s, const LightSample& sample) {
  const bool below = is_below(s, sample.direction);
  if (below) return {curved_origin(frame, s), sample.to_light, sample.t_max};
  return {safe_origin(s, 1), sample.to_light, sample.t_max, s.hit.triangle};
}

constexpr EffectMask kClearEffects = bit(Effect::refraction) | bit(Effect::alpha_blend);
// True if light may pass surfaces.
template <EffectMask mask>
inline bool passes_clear_surfaces(const FrameData& frame) {
  return (mask & kClearEffects) != 0 && (plan_of<mask>(frame) & kClearEffects) != 0;
}

// shadow() by tracing: the tile knows no result or, with `passes`, only that nothing opaque is in the way.
template <EffectMask mask>
[[gnu::noinline]] Vec3 traced_shadow(Tracer* tracer, const Surface& s, const LightRun& run, std::uint32_t light,
                                     const LightSample* known, bool at_first_hit, bool passes) {
  const FrameData& frame = *tracer->frame;
  const LightPoint* emitter = emitter_of(tracer->light_points[light]);
  bool blocked = false;
  if (!passes && emitter && is_grouped(*tracer)) {
    --tracer->rays[static_cast<int>(RayKind::shadow)];  // is_point_blocked() counts its own rays
    blocked = is_point_blocked(tracer, s, light, at_first_hit);
    passes = true;
  }
  if (blocked) return {0, 0, 0};
  if (passes && !passes_clear_surfaces<mask>(frame)) return {1, 1, 1};
  LightSample sample;
  if (!known) run.sample(tracer->light_points[light], s.point, &sample), known = &sample;
  const Ray ray = shadow_ray(frame, s, *known);
  ShadowContext context = {&frame, emitter};
  HitFilter opaque = {frame.filters.accept_opaque, &context, frame.filters.read_point};
  bool filtered = frame.filters.every_shadow || emitter;
  if (!passes) {
    const AccelTraversal& rays = at_first_hit ? *frame.geometry.first_rays : *frame.geometry.accel_info;
    blocked = rays.occluded(frame.geometry.accel, ray, filtered ? &opaque : nullptr, &tracer->stats);
  }
  if (blocked) return {0, 0, 0};
  if constexpr ((mask & kClearEffects) != 0) {
    if (passes_clear_surfaces<mask>(frame)) return clear_transmittance<mask>(tracer, ray, context, at_first_hit);
  }
  return {1, 1, 1};
}

// Fraction of the light of point `light` (in the run) that arrives: zero or one, or between if something
// transparent is in the way. `sample` is the light's sample at the surface, or null.
template <EffectMask mask>
[[gnu::always_inline]] inline Vec3 shadow(Tracer* tracer, const Surface& s, const LightRun& run, std::uint32_t light,
                                          const LightSample* sample, bool at_first_hit) {
  effect_entered<Effect::shadow>();
  ++tracer->rays[static_cast<int>(RayKind::shadow)];
  bool blocked;
  const bool known = at_first_hit && is_known(*tracer, light, &blocked);
  if (known && (blocked || !passes_clear_surfaces<mask & kPassageEffects>(*tracer->frame)))
    return blocked ? Vec3{0, 0, 0} : Vec3{1, 1, 1};
  return traced_shadow<mask & kPassageEffects>(tracer, s, run, light, sample, at_first_hit, known);
}

}  // namespace pocketray
