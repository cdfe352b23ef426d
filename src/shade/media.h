// The stack of transparent bodies that contain a ray.
#pragma once
#include "base/fmath.h"
#include "shade/contact.h"

namespace pocketray {

inline float medium_ior(const Scene& scene, const MediumStack& stack) {
  return stack.depth ? scene.materials[stack.material[stack.depth - 1]].ior : 1.0f;
}
// A body entered when the stack is full is not tracked: its exit then finds no entry, and the stack stays balanced.
inline void enter_medium(MediumStack* stack, std::uint32_t material) {
  if (stack->depth < kMediumDepthMax) stack->material[stack->depth++] = material;
}
// Removes the innermost entry of that material, wherever it is: bodies may overlap.
inline void exit_medium(MediumStack* stack, std::uint32_t material) {
  for (std::uint32_t i = stack->depth; i-- > 0;) {
    if (stack->material[i] != material) continue;
    for (; i + 1 < stack->depth; ++i) stack->material[i] = stack->material[i + 1];
    --stack->depth;
    return;
  }
}
// Updates the stack for a ray that crosses a contact: it leaves bodies before it enters others.
void cross_contact(const Scene& scene, const Contact& contact, MediumStack* stack);
// Transmittance along a distance (Beer–Lambert).
inline Vec3 transmittance(const Vec3& absorption, float distance) {
  auto one = [distance](float a) {
    return a > 0 ? static_cast<float>(det_exp(-static_cast<double>(a) * distance)) : 1.0f;
  };
  return {one(absorption.x), one(absorption.y), one(absorption.z)};
}

// Returns the bodies that contain the point `eye`, found by following a ray from it to infinity.
MediumStack media_at(const FrameData& frame, const Vec3& eye, const Vec3& direction);

}  // namespace pocketray
