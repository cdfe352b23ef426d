// The clear coat of a surface (Effect::clear_coat); brdf/clear_coat.h has its optics. It attenuates all light leaving
// the base: Surface::diffuse and Surface::glow hold the attenuated values. Light reaches the coat wherever it reaches
// the base, above the horizon of the base's normal.
#pragma once
#include "brdf/clear_coat.h"
#include "shade/surface.h"

namespace pocketray {

// Sets Surface::coat from the normal at the vertices. Every other field of the surface but glow must be set.
void find_coat(const FrameData& frame, const Ray& ray, const Vec3& normal, Surface* s);

// Attenuates the glow and the diffuse lobe by the coat, and adds the surroundings that the coat reflects; `open` is
// their unoccluded fraction.
void add_coat(const FrameData& frame, const Ray& ray, float open, Surface* s);

// Value of the coat's lobe times the cosine of the light at the coat; 0 without a lobe.
float coat_reflection(const Surface& s, const Vec3& to_viewer, const Vec3& to_light);

// Value of the base's lobes under coat and sheen; `diffuse` is the value of the diffuse lobe under them.
inline Vec3 value_under_coat(const BrdfInfo& lobe, const Material& m, const Vec3& specular, const Vec3& diffuse,
                             const Surface& s, const Vec3& to_viewer, const Vec3& to_light) {
  const float passes = s.coat.passes;
  if (!(passes > 0)) return {0, 0, 0};
  return lobe.value(m, specular, diffuse * (1 / passes), s, to_viewer, to_light) * passes;
}

// Returns whether the coat reflects lights.
inline bool shines_by_coat(const FrameData& frame, const Surface& s) {
  return has(frame.mask, Effect::clear_coat) && s.coat.lobe > 0;
}

}  // namespace pocketray
