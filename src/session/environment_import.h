// Environments that desktop builds read from pictures or compute; scene/environment.h defines the stored form.
// desktop/import/ implements it: device builds have no definition.
#pragma once
#include <string>
#include <vector>

#include "base/status.h"
#include "scene/scene.h"

namespace pocketray {

// An environment for a scene, with the light that belongs to it: its sun.
struct ImportedEnvironment {
  EnvironmentInfo info;
  std::vector<std::uint32_t> texels;
  Vec3 mean;  // radiance
  std::vector<Light> lights;
  std::vector<EnvironmentSun> suns;  // at most one, with its index in `lights`
  std::string file;                  // file that was read; empty: none
  bool is_studio = false;            // lights the scene together with default lights
};

// Reads "sky", "sky:ELEVATION[,TURBIDITY]", "studio" or a file: Radiance RGBE (.hdr), PNG or JPEG, equirectangular,
// with −Z in the middle and +Y on top. PNG and JPEG hold radiance up to 1, in sRGB.
Status read_environment(const std::string& name, ImportedEnvironment* environment);

// A studio: soft boxes above a dark floor and a grey backdrop, used with default lights (plan/plan_scene.h).
constexpr const char* kStudio = "studio";
// Returns whether a scene looks poor without an environment: some triangles are metal, mirror, glass, coated or
// polished. Others look nearly the same under even light.
bool calls_for_studio(const Scene& scene);

}  // namespace pocketray
