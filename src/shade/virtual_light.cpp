// Virtual lights at first hits, with shadows.
#include "base/fmath.h"
#include "effect/effect_probe.h"
#include "shade/interleaved_rays.h"

namespace pocketray {
namespace {

// A shadow ray ends a little before its light, which lies on a surface: by a fraction of its length.
constexpr float kRayEnd = 1 - 0x1p-10f;

struct VirtualSource {
  // Chosen: a quarter of the rays are spared, and ꟻLIP against full transport changes by less than .003.
  static constexpr float kFaint = 0.5f;
  const VirtualLights& lights;
  std::uint32_t count;

  bool arrives(std::uint32_t index, const Surface& s, const Vec3& origin, Vec3* light, Ray* ray) const {
    Vec3 to_light = {0, 0, 0};
    *light = virtual_irradiance(lights, lights.light[index], s.point, s.normal, &to_light);
    if (!(max_component(*light) > 0) || !(dot(s.geometric, to_light) > 0)) return false;
    *ray = {origin, lights.light[index].position - origin, kRayEnd};
    return true;
  }
};

VirtualSource source_of(const FrameData& frame) {
  const VirtualLights& lights = *virtual_lights_of(frame.indirect);
  return {lights, lights.count};
}

std::uint32_t count(const FrameData& frame) { return virtual_lights_of(frame.indirect)->count; }

Vec3 place(const FrameData& frame, std::uint32_t index) {
  return virtual_lights_of(frame.indirect)->light[index].position;
}

std::uint32_t list_rays(const FrameData& frame, const Surface& surface, std::uint32_t place_in_pattern,
                        SourceRay* rays) {
  return has(frame.mask, Effect::shadow) ? list_source_rays(source_of(frame), surface, place_in_pattern, rays) : 0;
}

void gather(const FrameData& frame, const InterleavedPoints& points, TraceStats* stats, std::uint64_t* rays,
            InterleavedLight* light) {
  effect_entered<Effect::instant_radiosity>();
  gather_interleaved(frame, points, source_of(frame), has(frame.mask, Effect::shadow), stats, rays, light);
}

Vec3 irradiance(const FrameData& frame, const Vec3& point, const Vec3& normal, const InterleavedLight& sum,
                bool are_few) {
  const VirtualLights& lights = *virtual_lights_of(frame.indirect);
  CHECK_GT(sum.pixel_count, 0u);
  Vec3 result = sum.lit * (static_cast<float>(kPatternPixels) / static_cast<float>(sum.pixel_count));
  if (are_few) {  // all lights, by the mean visibility of those traced
    result = virtual_irradiance(lights, point, normal);
    for (int c = 0; c < 3; ++c) result[c] *= sum.open[c] > 0 ? sum.lit[c] / sum.open[c] : 1;
  }
  return min(result, Vec3{lights.irradiance_max, lights.irradiance_max, lights.irradiance_max}) * (1 / kPiF);
}

}  // namespace

const InterleavedSource kVirtualLightSource = {
    Effect::instant_radiosity, false, count, place, list_rays, gather, irradiance};

}  // namespace pocketray
