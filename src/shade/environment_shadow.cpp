// The environment's diffuse light at first hits, with shadows: the exact unshadowed irradiance, times the visible share
// of the distant lights. Such a ratio has no noise where nothing or everything is hidden [Heitz et al. 2018, "Combining
// analytic direct illumination and stochastic shadows"].
#include "effect/effect_probe.h"
#include "indirect/environment.h"
#include "shade/interleaved_rays.h"

namespace pocketray {
namespace {

struct DistantSource {
  static constexpr float kFaint = 0;  // under a body overhead, light from near the horizon is not faint
  static constexpr float tolerance = 0;
  const EnvironmentLights& lights;
  std::uint32_t count;

  SteppedIndices<kPatternPixels> of_place(std::uint32_t place) const { return {place, count}; }
  bool arrives(std::uint32_t index, const Surface& s, Vec3* light) const {
    const EnvironmentLight& from = lights.light[index];
    const float cosine = dot(s.normal, from.direction);
    if (!(cosine > 0 && dot(s.geometric, from.direction) > 0)) return false;
    *light = from.irradiance * cosine;
    return true;
  }
  Ray ray(std::uint32_t index, const Surface& s, const Vec3& origin) const {
    return {origin, lights.light[index].direction, __builtin_inff(), s.hit.triangle};
  }
};

DistantSource source_of(const FrameData& frame) {
  CHECK(frame.environment_lights != nullptr);
  CHECK_LE(frame.environment_lights->count, static_cast<std::uint32_t>(kEnvironmentLightMax));
  return {*frame.environment_lights, frame.environment_lights->count};
}

std::uint32_t count(const FrameData& frame) { return frame.environment_lights->count; }

Vec3 place(const FrameData& frame, std::uint32_t index) { return frame.environment_lights->light[index].direction; }

std::uint32_t place_in_pattern(const FrameData&, std::uint32_t index) { return index % kPatternPixels; }

std::uint32_t list_rays(const FrameData& frame, const Surface& surface, std::uint32_t place_in_pattern,
                        SourceRay* rays) {
  return list_source_rays(source_of(frame), surface, place_in_pattern, rays);
}

void gather(const FrameData& frame, const InterleavedPoints& points, TraceStats* stats, std::uint64_t* rays,
            InterleavedLight* light) {
  effect_entered<Effect::environment_shadow>();
  gather_interleaved(frame, points, source_of(frame), true, stats, rays, light);
}

Vec3 irradiance(const FrameData& frame, const Vec3&, const Vec3& normal, const InterleavedLight& sum, bool) {
  CHECK(environment_of(*frame.scene) != nullptr);
  Vec3 result = environment_irradiance(*environment_of(*frame.scene), normal);
  for (int c = 0; c < 3; ++c)
    if (sum.lit[c] < sum.open[c]) result[c] *= sum.lit[c] / sum.open[c];
  return result;
}

}  // namespace

const InterleavedSource kEnvironmentSource = {Effect::environment_shadow, true,      true,   count,     place,
                                              place_in_pattern,           list_rays, gather, irradiance};

}  // namespace pocketray
