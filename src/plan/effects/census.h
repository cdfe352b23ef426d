// Counts of the scene content that may call for an effect.
#pragma once
#include "effect/settings.h"
#include "scene/scene.h"

namespace pocketray {

// Number of materials with each property, among those that triangles use.
struct Census {
  std::uint32_t materials = 0, specular = 0, mirror = 0, transmitting = 0, absorbing = 0, masked = 0, blended = 0,
                emissive = 0, unlit = 0, textured = 0, scattering = 0, one_sided = 0, reflecting = 0, diffuse = 0,
                metallic_roughness = 0, bumpy = 0, occluded = 0, with_levels = 0, grained = 0, second_uv = 0,
                second_uv_occlusion = 0,  // of these, only the occlusion texture does
      coated = 0, sheened = 0, glass_mapped = 0, rough_glass = 0, iridescent = 0, leafy = 0;
  std::uint32_t lights[3] = {0, 0, 0}, light_count = 0;  // that shine on anything
  bool has_normals = false, has_colors = false, is_animated = false;
  // Contents that no picture shows, in the scene or left out of it.
  std::uint32_t invisible[kInvisibleCount] = {};
};

// Counts the scene's materials and lights. If emission is forced off, unlit materials scatter like others.
Census take_census(const Scene& scene, const Settings& settings);

}  // namespace pocketray
