// Environments for tests, without import/.
#pragma once
#include <vector>

#include "scene/scene.h"

namespace pocketray {

struct TestEnvironment {
  EnvironmentInfo info;
  std::vector<std::uint32_t> texels;

  // radiance(direction, level) in the middle of each texel; level −1 is the map that rays see. The irradiance is the
  // constant one.
  template <class Radiance>
  TestEnvironment(std::uint32_t side, std::uint32_t gloss_side, const Vec3& irradiance, Radiance radiance) {
    info.side = side, info.gloss_side = gloss_side, info.radiance_max = {0, 0, 0};
    for (Vec3& coefficient : info.irradiance) coefficient = {0, 0, 0};
    info.irradiance[0] = irradiance;
    for (int level = -1; level < kGlossLevelCount; ++level) {
      const std::uint32_t n = level < 0 ? side : gloss_level_side(gloss_side, level);
      for (std::uint32_t i = 0; i < n * n; ++i) {
        const Vec3d p = from_octahedral(2 * (i % n + 0.5) / n - 1, 2 * (i / n + 0.5) / n - 1);
        texels.push_back(to_environment_texel(radiance(normalize(p), level)));
        info.radiance_max = max(info.radiance_max, environment_texel(texels.back()));
      }
    }
    info.radiance_max = max(info.radiance_max, irradiance);
  }
  void give(Scene* scene) const {
    scene->environment_info = {&info, 1};
    scene->environment_texels = {texels.data(), static_cast<std::uint32_t>(texels.size())};
  }
};

// The same radiance from everywhere.
inline TestEnvironment even_environment(const Vec3& radiance) {
  return TestEnvironment(8, 4, radiance, [&](const Vec3d&, int) { return to_double(radiance); });
}

}  // namespace pocketray
