// Contact: faces that lie on one another where a ray meets them, within rounding: glass that touches glass, a glass
// block on a table, a label on a wall, two one-sided surfaces back to back. A ray that passes one of them has to pass
// or meet them all.
#pragma once
#include "shade/surface.h"

namespace pocketray {

struct Face {
  Hit hit;
  std::uint32_t material;
  bool front;  // the ray meets the front (counter-clockwise) side
};

struct Contact {
  Face face[kMediumDepthMax];  // the one that was hit first; one of each material and side, what exceeds that is left
                               // out
  std::uint32_t count;
};

// The faces between the safe origins on both sides of `s`, which `hit` gave. `filter` may be null.
void gather_contact(const FrameData& frame, const Surface& s, const Hit& hit, const HitFilter* filter, Contact* contact,
                    TraceStats* stats);

// Whether a ray may get past a material, by the effects of the mask.
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
