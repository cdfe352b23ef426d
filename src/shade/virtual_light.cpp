// Virtual lights with shadows: interleaved at first hits, traced in full at secondary hits.
#include "shade/virtual_light.h"

#include "base/fmath.h"
#include "effect/effect_probe.h"
#include "shade/compensation.h"
#include "shade/interleaved_rays.h"

namespace pocketray {
namespace {

static_assert(kVirtualLightPlaces == kPatternPixels, "each has a place in the pattern");

struct ListedIndices {
  const std::uint16_t* index;
  std::uint32_t count;
  std::uint32_t operator[](std::uint32_t k) const { return index[k]; }
};

struct VirtualSource {
  // Chosen: without a tolerance, saves a quarter of the rays, and ꟻLIP against full transport changes by less than
  // .003.
  static constexpr float kFaint = 0.5f;
  const VirtualLights& lights;
  float geometry_max;
  float tolerance;

  ListedIndices of_place(std::uint32_t source_place) const {
    const std::uint32_t place = place_of(source_place);
    const std::uint16_t* first = &lights.first_of_place[place];
    return {lights.of_place + first[0], static_cast<std::uint32_t>(first[1] - first[0])};
  }
  [[gnu::always_inline]] bool arrives(std::uint32_t index, const Surface& s, Vec3* light) const {
    return pocketray::arrives(lights.light[index], geometry_max, s, light);
  }
  Ray ray(std::uint32_t index, const Surface& s, const Vec3& origin) const {
    return ray_to(lights.light[index], s, origin);
  }
};

// A pixel has a sixteenth of the lights, so a group may hold sixteen times the tolerance of their light: one ray or two
// by default. See tests/indirect/FIGURES.md.
VirtualSource source_of(const FrameData& frame) {
  const VirtualLights& lights = *virtual_lights_of(frame.indirect);
  return {lights, lights.first_geometry_max, frame.settings.light_tolerance * kPatternPixels};
}

std::uint32_t count(const FrameData& frame) { return virtual_lights_of(frame.indirect)->count; }

Vec3 place(const FrameData& frame, std::uint32_t index) {
  return virtual_lights_of(frame.indirect)->light[index].position;
}

std::uint32_t place_in_pattern(const FrameData& frame, std::uint32_t index) {
  return virtual_lights_of(frame.indirect)->light[index].place;
}

std::uint32_t group(const FrameData&) { return 1; }

std::uint32_t list_rays(const FrameData& frame, const Surface& surface, std::uint32_t source_place, SourceRay* rays) {
  return has(frame.mask, Effect::shadow) ? list_source_rays(source_of(frame), surface, source_place, rays) : 0;
}

void gather(const FrameData& frame, const InterleavedPoints& points, TraceStats* stats, std::uint64_t* rays,
            InterleavedLight* light) {
  effect_entered<Effect::instant_radiosity>();
  gather_interleaved(frame, points, source_of(frame), has(frame.mask, Effect::shadow), stats, rays, light);
  if (frame.settings.compensation == Compensation::rays) add_compensation(frame, points, stats, rays, light);
}

Vec3 irradiance(const FrameData& frame, const Vec3& point, const Vec3& normal, const InterleavedLight& sum,
                bool are_few) {
  const VirtualLights& lights = *virtual_lights_of(frame.indirect);
  CHECK_GT(sum.pixel_count, 0.0f);
  Vec3 result = sum.lit * (static_cast<float>(kPatternPixels) / sum.pixel_count);
  if (are_few) {  // all lights, by the mean visibility of the traced ones, and compensated like them
    result = virtual_irradiance(lights, lights.first_geometry_max, point, normal);
    for (int c = 0; c < 3; ++c) result[c] *= sum.open[c] > 0 ? sum.lit[c] / sum.open[c] : 1;
  }
  return min(result, Vec3{lights.irradiance_max, lights.irradiance_max, lights.irradiance_max}) * (1 / kPiF);
}

}  // namespace

void add_later_virtual_light(Tracer* tracer, const Vec3& weight, Surface* surface) {
  effect_entered<Effect::instant_radiosity>();
  const FrameData& frame = *tracer->frame;
  const VirtualLights& lights = *virtual_lights_of(frame.indirect);
  const Surface& s = *surface;
  if (!has(frame.mask, Effect::shadow)) {
    surface->glow += InstantRadiosity::radiance({*frame.scene, &lights, s.point, s.normal, s.diffuse});
    return;
  }
  SentLights<kVirtualLightRoom> found;
  // Measured in cornell's mirror, 64 lights: ꟻLIP against all rays is .040, with half the tolerance .028, without
  // shadows .096.
  const float tolerance = frame.settings.light_tolerance / max_component(weight);
  const VirtualSource source = {lights, lights.geometry_max, tolerance};
  find_sources(source, s, SteppedIndices<1>(0, lights.count), &found);
  const ShadowContext context = {&frame, nullptr};
  const HitFilter opaque = {frame.filters.accept_opaque, &context, frame.filters.read_point};
  const Vec3 lit = arriving_light(source, s, found, [&](const Ray& ray) {
    ++tracer->rays[static_cast<int>(RayKind::shadow)];
    return frame.geometry.accel_info->occluded(frame.geometry.accel, ray,
                                               frame.filters.every_shadow ? &opaque : nullptr, &tracer->stats);
  });
  surface->glow += s.diffuse * (lit * (1 / kPiF));
}

const InterleavedSource kVirtualLightSource = {
    Effect::instant_radiosity, false,     count,  group,      place,
    place_in_pattern,          list_rays, gather, irradiance, add_later_virtual_light};

}  // namespace pocketray
