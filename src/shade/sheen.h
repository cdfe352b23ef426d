// The sheen of a surface (Effect::sheen); brdf/sheen.h has its optics. It lies over the base and under a clear coat.
#pragma once
#include "brdf/sheen.h"
#include "shade/surface.h"

namespace pocketray {

// Sets Surface::sheen but for `base`; returns the fraction of the base's light that passes. Adds the sheen's albedo,
// divided by that fraction, to Surface::diffuse: the surface's own light is then attenuated as a whole. Every other
// field but glow and coat must be set.
float find_sheen(const FrameData& frame, const Ray& ray, Surface* s);

// Value of the sheen times the light's cosine.
inline Vec3 sheen_reflection(const Surface& s, const Vec3& to_viewer, const Vec3& to_light) {
  if (is_zero(s.sheen.color)) return {0, 0, 0};
  return s.sheen.color * (sheen_value(s.sheen.roughness, s.normal, to_viewer, to_light) * dot(s.normal, to_light));
}

}  // namespace pocketray
