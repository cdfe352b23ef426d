// Glossy lobes. A lobe is one file and one line of brdf_list.h; Material::brdf selects it. Every material has the
// Lambertian lobe, value diffuse/π; it is not listed.
#pragma once
#include "scene/scene.h"

namespace pocketray {

// The share of uniform light that a lobe reflects to the viewer: once, from about the mirrored direction; and scattered
// more than once, from all directions alike.
struct BrdfAlbedo {
  Vec3 once, scattered;
};

// What a lobe knows of the surface at a point.
template <class T>
struct LobeFrameT {
  Vec3T<T> normal;  // unit
  // Perpendicular to the normal; as long as the grain is strong, 0 to 1. Only lobes with a grain read it; in a Surface,
  // it is set with Effect::anisotropy.
  Vec3T<T> grain;
};
using LobeFrame = LobeFrameT<float>;
using LobeFrameD = LobeFrameT<double>;

// All vectors but the grain are unit. Values and densities are in 1/sr. `specular` is the material's at the point,
// tinted by texture and vertex colour; it is at most Material::specular.
struct BrdfInfo {
  const char* name;
  // Both directions point away from the surface, on the side of the normal.
  // The lobe plus what it leaves of `diffuse`, the value of the Lambertian lobe below it.
  Vec3 (*value)(const Material& material, const Vec3& specular, const Vec3& diffuse, const LobeFrame& frame,
                const Vec3& to_viewer, const Vec3& to_light);
  // Least upper bound of the lobe × the light's cosine over all directions and grains; the cut-off relies on it.
  Vec3 (*peak)(const Material& material);
  // The same value in double precision, for the reference.
  Vec3d (*exact_value)(const Material& material, const Vec3d& specular, const Vec3d& diffuse, const LobeFrameD& frame,
                       const Vec3d& to_viewer, const Vec3d& to_light);
  // Samples a direction by importance from numbers uniform in [0, 1); it may point below the surface. The density is
  // over the sphere, positive wherever the value is.
  Vec3d (*sample)(const Material& material, const LobeFrameD& frame, const Vec3d& to_viewer, double u, double v);
  double (*density)(const Material& material, const LobeFrameD& frame, const Vec3d& to_viewer, const Vec3d& to_light);
  // Null: the lobe reflects lights only.
  BrdfAlbedo (*albedo)(const Material& material, const Vec3& specular, float cos_viewer);
  float diffuse_max;  // upper bound of what remains of `diffuse`, as a factor
  // The same lobe with a grain, which stands in where there is one; null: it has none. No material names that lobe.
  const BrdfInfo* with_grain;
};

}  // namespace pocketray
