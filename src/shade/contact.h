// Contact: faces that coincide, within rounding, where a ray meets them: glass against glass, a glass block on a table,
// a label on a wall, two one-sided surfaces back to back. A ray that passes one of them must pass or meet them all.
#pragma once
#include "shade/surface.h"

namespace pocketray {

struct Face {
  Hit hit;
  std::uint32_t material;
  bool front;  // the ray meets the front (counter-clockwise) side
};

struct Contact {
  Face face[kMediumDepthMax];  // first hit first; one per material and side, excess faces are dropped
  std::uint32_t count;
};

// Gathers the faces between the safe origins on both sides of `s`, the surface at `hit`. `filter` may be null.
void gather_contact(const FrameData& frame, const Surface& s, const Hit& hit, const HitFilter* filter, Contact* contact,
                    TraceStats* stats);

// Returns whether a ray may pass through a material, given the effects of the mask.
inline bool transmits(const Material& m, EffectMask mask) {
  return has(mask, Effect::refraction) && !is_zero(m.transmission);
}
inline bool blends(const Material& m, EffectMask mask) {
  return has(mask, Effect::alpha_blend) && m.alpha_mode == AlphaMode::blend;
}
inline bool culls(const Material& m, bool front, EffectMask mask) {
  return has(mask, Effect::back_face_culling) && is_culled(m, front);
}

}  // namespace pocketray
