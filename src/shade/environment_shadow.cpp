// The environment's diffuse light at first hits, with shadows: the exact unshadowed irradiance, times the visible share
// of the distant lights. Such a ratio has no noise where nothing or everything is hidden [Heitz et al. 2018, "Combining
// analytic direct illumination and stochastic shadows"].
#include <algorithm>

#include "effect/effect_probe.h"
#include "indirect/environment.h"
#include "shade/interleaved_rays.h"
#include "shade/tracer.h"

namespace pocketray {
namespace {

// A place in the pattern takes every 16th group of lights. Which light of a group differs between patterns and, so that
// errors do not add up, between groups.
struct VariedIndices {
  std::uint32_t place, shift, variants, last, count = 0;
  VariedIndices(std::uint32_t source_place, const EnvironmentLights& lights)
      : place(place_of(source_place)),
        shift(((source_place >> kPlaceBits) * lights.variants >> kVariantBits) + 3 * place),
        variants(lights.variants),
        last(lights.count - 1) {
    const std::uint32_t groups = (lights.count + variants - 1) / variants;
    if (place < groups) count = (groups - place - 1) / kPatternPixels + 1;
  }
  std::uint32_t operator[](std::uint32_t k) const {
    return std::min((place + kPatternPixels * k) * variants + ((shift + 5 * k) & (variants - 1)), last);
  }
};

struct DistantSource {
  static constexpr float kFaint = 0;  // under a body overhead, light from near the horizon is not faint
  static constexpr float tolerance = 0;
  const EnvironmentLights& lights;

  VariedIndices of_place(std::uint32_t source_place) const { return {source_place, lights}; }
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
  CHECK_LE(frame.environment_lights->count, kEnvironmentLightRoom);
  return {*frame.environment_lights};
}

std::uint32_t count(const FrameData& frame) { return frame.environment_lights->count; }

Vec3 place(const FrameData& frame, std::uint32_t index) { return frame.environment_lights->light[index].direction; }

std::uint32_t place_in_pattern(const FrameData& frame, std::uint32_t index) {
  return index / frame.environment_lights->variants % kPatternPixels;
}

std::uint32_t group(const FrameData& frame) { return frame.environment_lights->variants; }

std::uint32_t list_rays(const FrameData& frame, const Surface& surface, std::uint32_t source_place, SourceRay* rays) {
  return list_source_rays(source_of(frame), surface, source_place, rays);
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

// Rays of a secondary hit whose light reaches the pixel whole: a share of a pattern's. Chosen: as an image in a mirror
// is a part of the picture, and rarely a sharp one.
constexpr std::uint32_t kLaterShare = 4, kLaterMax = kEnvironmentLightMax / kLaterShare;

// Lights at equal steps, from a place within the first step on.
struct SpreadIndices {
  std::uint32_t count, all;
  float place;  // in [0, 1)
  std::uint32_t operator[](std::uint32_t k) const {
    const float at = (static_cast<float>(k) + place) * (static_cast<float>(all) / static_cast<float>(count));
    return std::min(static_cast<std::uint32_t>(at), all - 1);
  }
};

void add_later(Tracer* tracer, const Vec3& weight, Surface* surface) {
  effect_entered<Effect::environment_shadow>();
  const FrameData& frame = *tracer->frame;
  if (is_zero(surface->diffuse) || !environment_lights_diffuse(frame.mask)) return;
  const DistantSource source = source_of(frame);
  InterleavedLight sum;
  if (source.lights.count > 0) {
    const float share = std::min(max_component(weight), 1.0f) / static_cast<float>(kLaterShare);
    const auto count = static_cast<std::uint32_t>(share * static_cast<float>(source.lights.wanted)) + 1;
    SentLights<kLaterMax> found;
    find_sources(source, *surface,
                 SpreadIndices{std::min({count, kLaterMax, source.lights.count}), source.lights.count,
                               random_place(surface->hit)},
                 &found);
    const ShadowContext context = {&frame, nullptr};
    const HitFilter opaque = {frame.filters.accept_opaque, &context, frame.filters.read_point};
    sum.open = found.open;
    sum.lit = arriving_light(source, *surface, found, [&](const Ray& ray) {
      ++tracer->rays[static_cast<int>(RayKind::shadow)];
      return frame.geometry.accel_info->occluded(frame.geometry.accel, ray,
                                                 frame.filters.every_shadow ? &opaque : nullptr, &tracer->stats);
    });
  }
  surface->glow += surface->diffuse * irradiance(frame, surface->point, surface->normal, sum, false);
}

}  // namespace

const InterleavedSource kEnvironmentSource = {Effect::environment_shadow, true,      count,  group,      place,
                                              place_in_pattern,           list_rays, gather, irradiance, add_later};

}  // namespace pocketray
