// Rough boundaries of glass (Effect::rough_refraction); brdf/rough_refraction.h has their optics.
#pragma once
#include "brdf/rough_refraction.h"
#include "indirect/environment.h"
#include "scene/metallic_roughness.h"
#include "shade/surface.h"

namespace pocketray {

// How far rays through rough boundaries spread: the α of a lobe; 0: not at all.
struct BeamWidth {
  float alpha = 0;
};

// Width of a beam that passes a boundary.
template <class T>
T widened_beam(const Material& m, T alpha, T eta) {
  const T added = scattered_width(m, eta), before = m.thin ? alpha : alpha * eta;
  const T square = before * before + added * added;
  return square < 1 ? std::sqrt(square) : T(1);
}

// Returns whether the ray meets a body from inside.
inline bool leaves_body(const Surface& s) { return !s.material->thin && !s.front; }

// Divides light at a rough boundary between one mirrored ray and those that pass. Outside, the glossy lobe has the rest
// of the reflection. Inside, only the stronger part is followed, with all of the light: a tree of rays would show what
// the facets blur.
template <class Surface, class T>
void divide_at_facets(const Surface& s, const Material& lobes, Vec3T<T>* reflected, Vec3T<T>* passing) {
  if (!leaves_body(s))
    *reflected = *reflected * static_cast<T>(mirror_share(lobes.roughness));
  else if (max_component(*passing) > 0)
    *passing += *reflected, *reflected = {0, 0, 0};
}

// Mean radiance of the environment in a beam.
inline Vec3 environment_in_beam(const Scene& scene, const Vec3& direction, float alpha) {
  constexpr float kLeast = kGlossRoughness[0] * kGlossRoughness[0];
  if (alpha >= kLeast) return environment_gloss(scene, direction, alpha);
  const float share = std::sqrt(alpha) / kGlossRoughness[0];
  return environment_radiance(scene, direction) * (1 - share) + environment_gloss(scene, direction, kLeast) * share;
}

// Distance that a pixel's cone would need to become as much wider as a beam does along t.
inline float widened(const FrameData& frame, const BeamWidth& width, float t) {
  constexpr float kAngle = 3;  // of α: about the width of a box of equal variance
  const float spread = frame.view.cone.spread;
  return width.alpha > 0 && spread > 0 ? t * (width.alpha * kAngle / spread) : 0;
}

}  // namespace pocketray
