// Glossy lobes. A lobe is one file and one line of brdf_list.h; Material::brdf picks it. The Lambertian lobe is in
// every material and is not listed: its value is diffuse/π.
#pragma once
#include "scene/scene.h"

namespace pocketray {

struct BrdfInfo {
  const char* name;
  // Value in 1/sr for unit vectors towards the viewer and the light, both on the side of the unit normal.
  Vec3 (*value)(const Material& material, const Vec3& normal, const Vec3& to_viewer, const Vec3& to_light);
  // Least upper bound of the value over all directions: what the cut-off relies on.
  Vec3 (*peak)(const Material& material);
};

}  // namespace pocketray
