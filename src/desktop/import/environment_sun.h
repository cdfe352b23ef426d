// The sun of a picture.
#pragma once
#include <cstdint>
#include <vector>

#include "session/environment_import.h"

namespace pocketray {

// A map of means over texels, with the texels' solid angles and unit directions.
struct EnvironmentMap {
  std::uint32_t side;
  std::vector<Vec3d> radiance, direction;
  std::vector<double> solid_angle;
};

// If at least 1/32 of the map's light comes from a disc of at most a few degrees, dims it to its surroundings and
// adds the rest to the environment's lights and suns.
void take_sun(EnvironmentMap* map, ImportedEnvironment* environment);

}  // namespace pocketray
