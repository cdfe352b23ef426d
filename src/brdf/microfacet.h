// Shared by lobes of microfacets: their width, viewers below the horizon, and the grain.
#pragma once
#include "brdf/brdf.h"
#include "brdf/directions.h"

namespace pocketray {

constexpr float kAlphaMin = 1e-3f;  // a smoother lobe is a mirror; keeps distributions finite

template <class T>
T alpha_of(const Material& material) {
  return static_cast<T>(material.roughness > kAlphaMin ? material.roughness : kAlphaMin);
}

// Interpolated normals put some visible points below their horizon: the viewer is mirrored at it.
template <class T>
Vec3T<T> above_horizon(const Vec3T<T>& normal, const Vec3T<T>& to_viewer) {
  T cosine = dot(normal, to_viewer);
  return cosine < 0 ? to_viewer - normal * (2 * cosine) : to_viewer;
}

// Widths along and across the grain [Burley 2012; glTF's KHR_materials_anisotropy]: for roughness α and strength s,
// α + (1 − α) s² along it and α across.
template <class T>
struct GrainAxes {
  Vec3T<T> tangent, bitangent;  // along and across
  T along, across;              // α
};

template <class T>
GrainAxes<T> grain_axes(const LobeFrameT<T>& frame, T alpha) {
  GrainAxes<T> axes;
  axes.along = axes.across = alpha;
  T square = dot(frame.grain, frame.grain);
  if (!(square > 0)) {
    make_basis(frame.normal, &axes.tangent, &axes.bitangent);
    return axes;
  }
  axes.tangent = frame.grain / std::sqrt(square);
  axes.bitangent = cross(frame.normal, axes.tangent);
  axes.along += (1 - alpha) * (square < 1 ? square : 1);
  return axes;
}

// The material with the isotropic lobe of equal area, α = √(αx αy), for data that exists only for isotropic lobes.
inline Material evened(const Material& m, const LobeFrame& frame) {
  const GrainAxes<float> axes = grain_axes(frame, m.roughness);
  Material even = m;
  even.roughness = std::sqrt(axes.along * axes.across);
  return even;
}

}  // namespace pocketray
