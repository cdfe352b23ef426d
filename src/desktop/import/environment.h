// Environments from pictures and procedural skies; scene/environment.h defines the stored form.
#pragma once
#include <functional>
#include <vector>

#include "session/environment_import.h"

namespace pocketray {

// A picture of linear radiance, rows from the top.
struct RadiancePicture {
  std::uint32_t width = 0, height = 0;
  std::vector<Vec3> pixels;
};

// Decodes a Radiance picture [Ward 1991, "Real pixels", Graphics Gems II ch. II.5]. Its bytes are hostile.
Status decode_radiance(const std::vector<std::uint8_t>& bytes, RadiancePicture* picture);

// Samples a function of direction on `side` × `side` texels, with grid × grid points in each; `side` is a power of two.
// Negative radiance and NaN become 0. Fails if it is too bright to store.
Status make_environment(std::uint32_t side, std::uint32_t grid, const std::function<Vec3d(const Vec3d&)>& radiance,
                        ImportedEnvironment* environment);
constexpr std::uint32_t kGlossSide = 64;
// make_environment(), but a small disc with enough of the light becomes a directional light: the environment's sun.
Status make_sunny_environment(std::uint32_t side, std::uint32_t grid,
                              const std::function<Vec3d(const Vec3d&)>& radiance, ImportedEnvironment* environment);

// The clear sky of [Preetham et al. 1999, "A practical analytic model for daylight", sec. 3 and app. A], in units of 30
// kcd/m², so that a white surface in the sun is about display white. Below the horizon is uniform ground.
struct Sky {
  double elevation = 45, turbidity = 3;  // degrees; haze, 2 (clear) to 10
};
// Excludes the sun's disc, which is a directional light.
Vec3d sky_radiance(const Sky& sky, const Vec3d& direction);
Light sun_of(const Sky& sky);

// The environment named kStudio.
Vec3d studio_radiance(const Vec3d& direction);

}  // namespace pocketray
