#include "desktop/import/environment_sun.h"

#include <algorithm>
#include <cmath>

#include "base/check.h"
#include "base/fmath.h"
#include "base/limits.h"

namespace pocketray {
namespace {

// Chosen: the sun's disc spans half a degree; lenses and coarse pixels widen it to a few.
constexpr double kReach = radians(4), kSurroundings = radians(8);
constexpr double kShareMin = 1.0 / 32;  // of the light from all directions. Chosen: fainter suns cast no visible shadow

double luminance(const Vec3d& c) { return 0.2126 * c.x + 0.7152 * c.y + 0.0722 * c.z; }

// Mean luminance between two angles around a direction; 0 if no texel lies there.
double mean_around(const EnvironmentMap& map, const Vec3d& axis, double cos_inner, double cos_outer) {
  double sum = 0, all = 0;
  for (std::size_t i = 0; i < map.radiance.size(); ++i) {
    const double cosine = dot(map.direction[i], axis);
    if (cosine >= cos_inner || cosine < cos_outer) continue;
    sum += luminance(map.radiance[i]) * map.solid_angle[i], all += map.solid_angle[i];
  }
  return all > 0 ? sum / all : 0;
}

// Light of texels within an angle around a direction, as far as they exceed a luminance.
struct Excess {
  Vec3d irradiance = {0, 0, 0}, axis = {0, 0, 0};  // the axis is weighted by luminance
  double luminance = 0;
};

double excess_share(const Vec3d& radiance, double level) {
  const double own = luminance(radiance);
  return own > level ? 1 - level / own : 0;
}

Excess excess_around(const EnvironmentMap& map, const Vec3d& axis, double cos_reach, double level) {
  Excess sum;
  for (std::size_t i = 0; i < map.radiance.size(); ++i) {
    if (dot(map.direction[i], axis) < cos_reach) continue;
    const Vec3d part = map.radiance[i] * (excess_share(map.radiance[i], level) * map.solid_angle[i]);
    sum.irradiance += part, sum.luminance += luminance(part), sum.axis += map.direction[i] * luminance(part);
  }
  return sum;
}

// Radius of a uniform disc whose light lies as far from the axis, in the mean of squares, as the excess.
double radius_of(const EnvironmentMap& map, const Vec3d& axis, double cos_reach, double level) {
  double sum = 0, all = 0;
  for (std::size_t i = 0; i < map.radiance.size(); ++i) {
    if (dot(map.direction[i], axis) < cos_reach) continue;
    const double part = luminance(map.radiance[i]) * excess_share(map.radiance[i], level) * map.solid_angle[i];
    const Vec3d off = map.direction[i] - axis;
    sum += part * dot(off, off), all += part;
  }
  return all > 0 ? std::sqrt(2 * sum / all) : 0;
}

}  // namespace

void take_sun(EnvironmentMap* map, ImportedEnvironment* environment) {
  CHECK(map != nullptr && environment != nullptr && !map->radiance.empty());
  double total = 0, most = 0;
  std::size_t brightest = 0;
  for (std::size_t i = 0; i < map->radiance.size(); ++i) {
    const double own = luminance(map->radiance[i]);
    total += own * map->solid_angle[i];
    if (own > most) most = own, brightest = i;
  }
  const double texel = std::sqrt(4 * kPi / static_cast<double>(map->radiance.size()));
  const double reach = std::max(kReach, 2 * texel), around = std::max(kSurroundings, 4 * texel);
  const double cos_reach = det_cos(reach), cos_around = det_cos(around);
  Vec3d axis = map->direction[brightest];
  Excess excess;
  double level = 0;
  for (int i = 0; i < 2; ++i) {  // around the brightest texel, then around the middle of the light there
    level = mean_around(*map, axis, cos_reach, cos_around);
    excess = excess_around(*map, axis, cos_reach, level);
    if (!(excess.luminance >= kShareMin * total) || !(excess.luminance > 0)) return;
    if (i == 0) axis = normalize(excess.axis);
  }
  EnvironmentSun sun;
  sun.light = static_cast<std::uint32_t>(environment->lights.size());
  sun.radius =
      static_cast<float>(std::min(radius_of(*map, axis, cos_reach, level), static_cast<double>(kSunRadiusMax)));
  sun.cos_shown = static_cast<float>(cos_reach);
  sun.surroundings = static_cast<float>(level);
  Light light;
  light.kind = LightKind::directional;
  light.direction = to_float(-axis);
  light.intensity = to_float(excess.irradiance);
  environment->lights.push_back(light);
  environment->suns.push_back(sun);
  for (std::size_t i = 0; i < map->radiance.size(); ++i)
    if (dot(map->direction[i], axis) >= cos_reach)
      map->radiance[i] = map->radiance[i] * (1 - excess_share(map->radiance[i], level));
}

}  // namespace pocketray
