// A surface that receives light, and what its lobes reflect.
#pragma once
#include "brdf/brdf_list.h"
#include "shade/clear_coat.h"
#include "shade/shadow.h"
#include "shade/sheen.h"
#include "shade/tracer.h"

namespace pocketray {

// A surface that receives light, and the direction to its viewer.
struct LitSurface {
  const Surface& surface;
  const Material& material;  // with the lobes evaluated at the point
  const Vec3& to_viewer;
  const Vec3& weight;  // the throughput of the path so far
  Vec3 diffuse;        // value of the diffuse lobe
  bool at_first_hit;
};

// Value of the diffuse lobe. A sheen's share of Surface::diffuse is for light from everywhere.
template <EffectMask mask>
inline Vec3 diffuse_value(const Surface& s) {
  if constexpr (has(mask, Effect::clear_coat)) return s.sheen.base * (1 / kPiF);
  return s.diffuse * (1 / kPiF);
}

// Value of the coat's lobe and the sheen, each times its cosine of the light.
inline Vec3 layer_reflection(const Surface& s, const Vec3& to_viewer, const Vec3& to_light) {
  const float coat = coat_reflection(s, to_viewer, to_light);
  return Vec3{coat, coat, coat} + sheen_reflection(s, to_viewer, to_light);
}

// The effects on which direct light depends.
constexpr EffectMask kDirectEffects = bit(Effect::shadow) | bit(Effect::specular) | bit(Effect::metallic_roughness) |
                                      bit(Effect::clear_coat) | kPassageEffects;

// Sum of all lobes for light from a direction.
template <EffectMask mask>
inline Vec3 lobe_value(const FrameData& frame, const LitSurface& to, const Vec3& direction) {
  const Material& m = to.material;
  if constexpr (has(mask, Effect::specular)) {
    if (!is_zero(m.specular)) {
      effect_entered<Effect::specular>();
      Vec3 specular = reflectance_at(to.surface, m.specular, m.specular_tinted);
      const BrdfInfo* lobe = kBrdfList[m.brdf];
      if constexpr (has(mask, Effect::metallic_roughness)) lobe = &lobe_at(frame, to.surface, m);
      if constexpr (has(mask, Effect::clear_coat))
        return value_under_coat(*lobe, m, specular, to.diffuse, to.surface, to.to_viewer, direction);
      return lobe->value(m, specular, to.diffuse, to.surface, to.to_viewer, direction);
    }
  }
  return to.diffuse;
}

// Reflected radiance for light of that irradiance (measured on a surface facing it).
template <EffectMask mask>
inline Vec3 reflected_light(const FrameData& frame, const LitSurface& to, const Vec3& direction, const Vec3& irradiance,
                            float cosine) {
  const Vec3 light_out = lobe_value<mask>(frame, to, direction) * irradiance * cosine;
  if constexpr (has(mask, Effect::clear_coat))
    return light_out + irradiance * layer_reflection(to.surface, to.to_viewer, direction);
  return light_out;
}

// True if the surface has a matte lobe alone.
template <EffectMask mask>
inline bool is_matte(const LitSurface& to) {
  if (has(mask, Effect::specular) && !is_zero(to.material.specular)) return false;
  if constexpr (has(mask, Effect::clear_coat)) return !(to.surface.coat.lobe > 0) && is_zero(to.surface.sheen.color);
  return true;
}

// Returns whether to skip light that reaches the viewer with at most this radiance, because there is none or because it
// cannot change a displayed level. Without shadows it saves no ray, but the picture must be that with them.
template <EffectMask mask>
inline bool is_negligible(Tracer* tracer, const LitSurface& to, const Vec3& light_out) {
  const float bound = max_component(light_out * to.weight);
  if (!(bound > 0)) return true;
  return has(mask, Effect::shadow) ? leave_out(tracer, bound) : leave_out_light(tracer, bound);
}

}  // namespace pocketray
