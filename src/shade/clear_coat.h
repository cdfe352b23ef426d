// The clear coat of a surface (Effect::clear_coat); brdf/clear_coat.h has its optics. It takes its share of all that
// leaves the base: Surface::diffuse and Surface::glow hold what is left. Light reaches the coat where it reaches the
// base, above the horizon of the base's normal.
#pragma once
#include "brdf/clear_coat.h"
#include "shade/surface.h"

namespace pocketray {

// Sets Surface::coat, for the normal at the vertices. All else of the surface but its glow is known.
void find_coat(const FrameData& frame, const Ray& ray, const Vec3& normal, Surface* s);

// Puts the coat over the glow and the diffuse lobe, and adds what it reflects of the surroundings, of which `open` is
// not occluded.
void add_coat(const FrameData& frame, const Ray& ray, float open, Surface* s);

// The coat's lobe × the light's cosine at the coat; 0 without a lobe.
float coat_reflection(const Surface& s, const Vec3& to_viewer, const Vec3& to_light);

// The value of the base's lobes under the coat; `diffuse` is that of the diffuse lobe under it.
inline Vec3 value_under_coat(const BrdfInfo& lobe, const Material& m, const Vec3& specular, const Vec3& diffuse,
                             const Surface& s, const Vec3& to_viewer, const Vec3& to_light) {
  const float passes = s.coat.passes;
  if (!(passes > 0)) return {0, 0, 0};
  return lobe.value(m, specular, diffuse * (1 / passes), s, to_viewer, to_light) * passes;
}

// Whether lights shine in the coat.
inline bool shines_by_coat(const FrameData& frame, const Surface& s) {
  return has(frame.mask, Effect::clear_coat) && s.coat.lobe > 0;
}

}  // namespace pocketray
