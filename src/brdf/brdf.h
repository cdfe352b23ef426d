// Glossy lobes. A lobe is one file and one line of brdf_list.h; Material::brdf selects it. Every material has the
// Lambertian lobe, value diffuse/π; it is not listed.
#pragma once
#include "scene/scene.h"

namespace pocketray {

// Share of uniform light that a lobe reflects to the viewer: light reflected once, from around the mirrored direction;
// and light scattered more than once, from all directions alike.
struct BrdfAlbedo {
  Vec3 once, scattered;
};

// The surface at a point, as lobes see it.
template <class T>
struct LobeFrameT {
  Vec3T<T> normal;  // unit
  // Perpendicular to the normal; its length is the grain's strength, 0 to 1. Only lobes with a grain read it; in a
  // Surface, it is set with Effect::anisotropy.
  Vec3T<T> grain;
};
using LobeFrame = LobeFrameT<float>;
using LobeFrameD = LobeFrameT<double>;

// A lobe in two parts, see linear_lobe.h: a sharp part, which times the light's cosine is `albedo` times a distribution
// of directions (a power of the z axis' cosine after transformation by M⁻¹, whose rows are given); and the rest.
template <class T>
struct LobePartsT {
  Vec3T<T> x, y, z;
  Vec3T<T> albedo;
  Vec3T<T> diffuse, scattered;  // of the rest
  T roughness;                  // set if scattered is not 0
};
using LobeParts = LobePartsT<float>;
using LobePartsD = LobePartsT<double>;

// Arguments are as in BrdfInfo.
struct LinearForm {
  std::uint32_t power;  // of the cosine, odd
  // Returns false if the lobe cannot be divided for that material or viewer.
  bool (*divide)(const Material& material, const Vec3& specular, const Vec3& diffuse, const LobeFrame& frame,
                 const Vec3& to_viewer, LobeParts* parts);
  bool (*divide_exactly)(const Material& material, const Vec3d& specular, const Vec3d& diffuse, const LobeFrameD& frame,
                         const Vec3d& to_viewer, LobePartsD* parts);
  // Value of the rest for light at a cosine; null: it is LobeParts::diffuse.
  Vec3 (*rest)(const LobeParts& parts, float cos_light);
  Vec3d (*exact_rest)(const LobePartsD& parts, double cos_light);
};

// All vectors but the grain are unit vectors. Values and densities are in 1/sr. `specular` is the material's
// reflectance at the point, tinted by texture and vertex colour; it is at most Material::specular.
struct BrdfInfo {
  const char* name;
  // Both directions point away from the surface, on the side of the normal.
  // The lobe plus what it leaves of `diffuse`, the value of the Lambertian lobe below it.
  Vec3 (*value)(const Material& material, const Vec3& specular, const Vec3& diffuse, const LobeFrame& frame,
                const Vec3& to_viewer, const Vec3& to_light);
  // Least upper bound of the lobe × the light's cosine over all directions and grains; the cut-off relies on it.
  Vec3 (*peak)(const Material& material);
  // value() in double precision, for the reference.
  Vec3d (*exact_value)(const Material& material, const Vec3d& specular, const Vec3d& diffuse, const LobeFrameD& frame,
                       const Vec3d& to_viewer, const Vec3d& to_light);
  // Importance-samples a direction from numbers uniform in [0, 1); it may point below the surface. The density is over
  // the sphere, positive wherever the value is.
  Vec3d (*sample)(const Material& material, const LobeFrameD& frame, const Vec3d& to_viewer, double u, double v);
  double (*density)(const Material& material, const LobeFrameD& frame, const Vec3d& to_viewer, const Vec3d& to_light);
  // Null: the lobe reflects lights only.
  BrdfAlbedo (*albedo)(const Material& material, const Vec3& specular, float cos_viewer);
  float diffuse_max;  // upper bound of what remains of `diffuse`, as a factor
  // This lobe with a grain, which replaces it where there is one; null: it has none. No material names that lobe.
  const BrdfInfo* with_grain;
  const LinearForm* linear = nullptr;  // null: it has none
};

}  // namespace pocketray
