#pragma once
#include "scene/scene.h"

namespace pocketray {

// Returns the material's diffuse transmission, or null.
inline const DiffuseTransmission* diffuse_transmission_of(const Scene& scene, std::uint32_t material) {
  return scene.diffuse_transmissions.count && scene.diffuse_transmissions[material].strength > 0
             ? &scene.diffuse_transmissions[material]
             : nullptr;
}

}  // namespace pocketray
