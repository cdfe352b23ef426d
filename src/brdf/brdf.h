// Glossy lobes. A lobe is one file and one line of brdf_list.h; Material::brdf picks it. The Lambertian lobe is in
// every material and is not listed: its value is diffuse/π.
#pragma once
#include "scene/scene.h"

namespace pocketray {

// All vectors are unit. Values and densities are in 1/sr.
struct BrdfInfo {
  const char* name;
  // For directions towards the viewer and the light, both on the side of the normal.
  Vec3 (*value)(const Material& material, const Vec3& normal, const Vec3& to_viewer, const Vec3& to_light);
  // Least upper bound of the value over all directions: what the cut-off relies on.
  Vec3 (*peak)(const Material& material);
  // The value once more in double precision, for the reference.
  Vec3d (*exact_value)(const Material& material, const Vec3d& normal, const Vec3d& to_viewer, const Vec3d& to_light);
  // A direction by the lobe's shape, from numbers uniform in [0, 1); it may lead under the surface. And its density
  // over the sphere, positive wherever the value is.
  Vec3d (*sample)(const Material& material, const Vec3d& normal, const Vec3d& to_viewer, double u, double v);
  double (*density)(const Material& material, const Vec3d& normal, const Vec3d& to_viewer, const Vec3d& to_light);
};

}  // namespace pocketray
