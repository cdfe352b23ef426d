// Reconstructs illumination between the vertices of a mesh from the values there [Bastos92].
#pragma once
#include "scene/radiosity.h"

namespace pocketray {

// Weights of the two values and the two tangents of a Hermite curve at t: T·M_H, eqs. (2) to (4).
struct HermiteWeights {
  float value[2], tangent[2];
};
inline HermiteWeights hermite_weights(float t) {
  float t2 = t * t, t3 = t2 * t;
  return {{2 * t3 - 3 * t2 + 1, 3 * t2 - 2 * t3}, {t3 - 2 * t2 + t, t3 - t2}};
}

// A patch's corners: B_st and its tangents at (s, t) = (0, 0), (1, 0), (0, 1), (1, 1); G_H of eq. (5).
struct PatchCorners {
  const RadiosityNode *b00, *b10, *b01, *b11;
};

// Constant over the whole patch: the mean of its corners.
inline Vec3 constant_patch(const PatchCorners& c) {
  return ((c.b00->value + c.b10->value) + (c.b01->value + c.b11->value)) * 0.25f;
}
inline Vec3 bilinear_patch(const PatchCorners& c, float s, float t) {
  return (c.b00->value * (1 - s) + c.b10->value * s) * (1 - t) + (c.b01->value * (1 - s) + c.b11->value * s) * t;
}
// S·M_H·G_H·M_Hᵀ·Tᵀ, eq. (1).
inline Vec3 bicubic_patch(const PatchCorners& c, float s, float t) {
  const HermiteWeights a = hermite_weights(s), b = hermite_weights(t);
  auto row = [&](const RadiosityNode& n0, const RadiosityNode& n1, int corner) {  // along s, at t = corner
    Vec3 value = n0.value * a.value[0] + n1.value * a.value[1] + n0.ds * a.tangent[0] + n1.ds * a.tangent[1];
    Vec3 tangent = n0.dt * a.value[0] + n1.dt * a.value[1] + n0.dst * a.tangent[0] + n1.dst * a.tangent[1];
    return value * b.value[corner] + tangent * b.tangent[corner];
  };
  return row(*c.b00, *c.b10, 0) + row(*c.b01, *c.b11, 1);
}

}  // namespace pocketray
