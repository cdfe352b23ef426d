#include "shade/lights.h"

#include <limits>

#include "base/check.h"
#include "base/limits.h"
#include "effect/effect_probe.h"

namespace pocketray {
namespace {

constexpr float kInverseSquareMax = std::numeric_limits<float>::max() / 2;  // stays finite times a cosine just above 1

// Limits a light's irradiance to kRadianceMax, even at a point on the light itself, so that shading stays finite.
Vec3 bounded(const Vec3& irradiance) { return min(irradiance, Vec3{kRadianceMax, kRadianceMax, kRadianceMax}); }

// Sets direction and inverse square distance of a light. Returns false if the point is on the light or out of range.
bool reach(const LightPoint& light, const Vec3& point, LightSample* s, float* inverse_square) {
  s->to_light = light.position - point;
  float square = dot(s->to_light, s->to_light);
  if (!(square > 0)) return false;
  float distance = std::sqrt(square);
  s->direction = s->to_light / distance;
  s->t_max = 1;
  float inverse = 1 / square;
  *inverse_square = inverse < kInverseSquareMax ? inverse : kInverseSquareMax;
  if (light.range > 0) {
    // The smooth falloff recommended by KHR_lights_punctual: max(min(1 − (d/range)⁴, 1), 0) / d².
    float q = square / (light.range * light.range);
    float window = 1 - q * q;
    if (!(window > 0)) return false;
    *inverse_square *= window;
  }
  return true;
}

bool sample_point_light(const LightPoint& light, const Vec3& point, LightSample* s) {
  effect_entered<Effect::point_light>();
  float inverse_square;
  if (!reach(light, point, s, &inverse_square)) return false;
  s->irradiance = bounded(light.intensity * inverse_square);
  return true;
}

bool sample_spot_light(const LightPoint& light, const Vec3& point, LightSample* s) {
  effect_entered<Effect::spot_light>();
  float inverse_square;
  if (!reach(light, point, s, &inverse_square)) return false;
  float cos_angle = -dot(s->direction, light.direction);
  if (cos_angle <= light.cos_outer) return false;
  // KHR_lights_punctual, "Inner and Outer Cone Angles": linear in the cosine, then squared.
  float f = cos_angle >= light.cos_inner ? 1 : (cos_angle - light.cos_outer) / (light.cos_inner - light.cos_outer);
  s->irradiance = bounded(light.intensity * (inverse_square * (f * f)));
  return true;
}

bool sample_directional_light(const LightPoint& light, const Vec3&, LightSample* s) {
  effect_entered<Effect::directional_light>();
  s->to_light = s->direction = -light.direction;
  s->t_max = std::numeric_limits<float>::infinity();
  s->irradiance = light.intensity;
  return true;
}

// One of the points that represent an area light [Aranha07] sec. 3.1: a Lambertian emitter of a part of its area.
bool sample_area_light(const LightPoint& light, const Vec3& point, LightSample* s) {
  effect_entered<Effect::area_light>();
  float inverse_square;
  if (!reach(light, point, s, &inverse_square)) return false;
  float cos_light = -dot(s->direction, light.direction);
  if (light.two_sided) cos_light = std::fabs(cos_light);
  if (!(cos_light > 0)) return false;
  s->irradiance = bounded(light.intensity * (cos_light * inverse_square));
  return true;
}

}  // namespace

bool is_in_plane_of(const FrameData& frame, const LightPoint& light, std::uint32_t triangle) {
  CHECK(light.material != kNone);
  for (std::uint32_t v : frame.scene->triangles[triangle].vertices())
    if (!is_in_plane(light, frame.geometry.positions[v])) return false;
  return true;
}

bool is_unlit_by_own(const FrameData& frame, const Surface& s, const LightPoint& light) {
  return has_stored_light(frame) || is_beside(frame, light, s.hit.triangle);
}

bool lights_up_own(const FrameData& frame, const Surface& s, const LightRun& run, const LightPoint& light,
                   LightSample* sample) {
  if (is_unlit_by_own(frame, s, light)) return false;
  if (!run.sample(light, s.point, sample) || !(dot(s.normal, sample->direction) > 0)) return false;
  sample->irradiance = min(sample->irradiance, s.material->emission * kPiF);
  return true;
}

LightSampler find_light_sampler(Effect kind) {
  switch (kind) {
    case Effect::point_light:
      return sample_point_light;
    case Effect::spot_light:
      return sample_spot_light;
    case Effect::directional_light:
      return sample_directional_light;
    default:
      CHECK(kind == Effect::area_light);
      return sample_area_light;
  }
}

}  // namespace pocketray
