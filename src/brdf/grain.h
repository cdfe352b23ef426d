// Widths of a lobe along and across the grain [Burley 2012; glTF's KHR_materials_anisotropy]: for roughness α and
// strength s, α + (1 − α) s² along it and α across.
#pragma once
#include "brdf/brdf.h"
#include "brdf/directions.h"

namespace pocketray {

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

}  // namespace pocketray
