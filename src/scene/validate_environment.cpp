// Validates the environment: sizes first, then every number.
#include "scene/validate_checks.h"

namespace pocketray {
namespace {

bool is_power_of_two(std::uint32_t n) { return n != 0 && (n & (n - 1)) == 0; }

Status validate_sizes(const Scene& scene, const EnvironmentInfo& info) {
  if (!is_power_of_two(info.side) || info.side > kEnvironmentSideMax)
    return failure("environment_info[0].side is %u: it must be a power of two up to %u", info.side,
                   kEnvironmentSideMax);
  if (!is_power_of_two(info.gloss_side) || info.gloss_side < 4 || info.gloss_side > kEnvironmentSideMax)
    return failure("environment_info[0].gloss_side is %u: it must be a power of two from 4 to %u", info.gloss_side,
                   kEnvironmentSideMax);
  const std::uint32_t count = environment_texel_count(info.side, info.gloss_side);
  if (scene.environment_texels.count != count)
    return failure("%u environment_texels, environment_info[0] has %u", scene.environment_texels.count, count);
  return success();
}

Status validate_suns(const Scene& scene) {
  if (scene.environment_suns.count > 0 && scene.environment_info.empty())
    return failure("%u environment_suns, but no environment_info", scene.environment_suns.count);
  if (scene.environment_suns.empty()) return success();
  if (scene.environment_suns.count != 1)
    return failure("%u environment_suns: there must be one or none", scene.environment_suns.count);
  const EnvironmentSun& sun = scene.environment_suns[0];
  if (sun.light >= scene.lights.count || scene.lights[sun.light].kind != LightKind::directional)
    return failure("environment_suns[0] is light %u: it must be a directional light", sun.light);
  const FieldRange fields[] = {
      {"radius", sun.radius, 0, kSunRadiusMax},
      {"cos_shown", sun.cos_shown, 0, 2},
      {"surroundings", sun.surroundings, 0, kRadianceMax},
  };
  return check_fields("environment_suns", 0, fields);
}

}  // namespace

Status validate_environment(const Scene& scene) {
  RETURN_IF_ERROR(validate_suns(scene));
  if (scene.environment_info.empty() && scene.environment_texels.empty()) return success();
  if (scene.environment_info.count != 1)
    return failure("%u environment_info: there must be one or none", scene.environment_info.count);
  const EnvironmentInfo& info = scene.environment_info[0];
  RETURN_IF_ERROR(validate_sizes(scene, info));
  std::uint32_t scale_bits;
  std::memcpy(&scale_bits, &info.scale, sizeof scale_bits);
  if (!(info.scale >= kEnvironmentScaleMin && info.scale <= kEnvironmentScaleMax) || (scale_bits & 0x7FFFFF) != 0)
    return failure("environment_info[0].scale is %g: it must be a power of two from %g to %g",
                   static_cast<double>(info.scale), static_cast<double>(kEnvironmentScaleMin),
                   static_cast<double>(kEnvironmentScaleMax));
  for (int c = 0; c < 3; ++c)
    if (!(info.radiance_max[c] >= 0 && info.radiance_max[c] <= kRadianceMax))
      return failure("environment_info[0].radiance_max is %g: it must lie in 0 to %g",
                     static_cast<double>(info.radiance_max[c]), static_cast<double>(kRadianceMax));
  for (const Vec3& coefficient : info.irradiance)
    for (int c = 0; c < 3; ++c)
      if (!magnitude_at_most(coefficient[c], kRadianceMax))
        return failure("environment_info[0].irradiance is not a number or beyond %g",
                       static_cast<double>(kRadianceMax));
  for (std::uint32_t i = 0; i < scene.environment_texels.count; ++i) {
    const Vec3 radiance = environment_texel(scene.environment_texels[i]) * info.scale;
    for (int c = 0; c < 3; ++c)
      if (radiance[c] > info.radiance_max[c])
        return failure("environment_texels[%u] exceeds environment_info[0].radiance_max", i);
  }
  return success();
}

}  // namespace pocketray
