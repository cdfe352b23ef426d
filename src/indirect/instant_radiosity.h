// Instant radiosity [Keller 1997]: light between surfaces from virtual point lights, placed by walks from the lights
// before each frame (plan/place_virtual_lights.h). First hits are lit with shadows, interleaved over blocks of pixels
// (shade/interleaved.h); in mirrors and behind glass, groups of lights share a shadow ray (shade/virtual_light.h).
#pragma once
#include "effect/effect_probe.h"
#include "indirect/indirect.h"

namespace pocketray {

// A point of a diffuse surface that sends intensity × cosine to the side of its normal. It belongs to the pixels at one
// place of the pattern in shade/interleaved.h, chosen by its walk and bounce, so that it stays there when other lights
// change.
struct VirtualLight {
  Vec3 position, normal, intensity;
  std::uint32_t triangle, place;
};
constexpr std::uint32_t kVirtualLightRoom = kVirtualLightMax + kVirtualLightMax / 4;  // paths differ in length
constexpr std::uint32_t kVirtualLightPlaces = 16,
                        kVirtualLightsOfPlaceMax = 2 * kVirtualLightRoom / kVirtualLightPlaces;
struct VirtualLights {
  VirtualLight light[kVirtualLightRoom];
  std::uint32_t count = 0;
  // Indices of the lights by place: those at a place begin at first_of_place[place].
  std::uint16_t of_place[kVirtualLightRoom], first_of_place[kVirtualLightPlaces + 1] = {};
  double lights_per_walk = 0, area = -1;  // of the scene, from measure_walks(); area −1: not measured yet
  // Bound of the geometry term, cos cos / distance²: without it, surfaces at a light would be infinitely bright
  // [Keller97, sec. 4]. It removes light near edges, less the more lights there are: HARDCASES row 41.
  float geometry_max = 0;
  float first_geometry_max = 0;  // bound at first hits: lower if compensation makes up for it
  float irradiance_max = 0;      // sum over all lights
};

// Unshadowed irradiance from a light on a surface, with the geometry term bounded; *to_light is set unless the result
// is zero.
inline Vec3 virtual_irradiance(const VirtualLight& light, float geometry_max, const Vec3& point, const Vec3& normal,
                               Vec3* to_light) {
  Vec3 way = light.position - point;
  float square = dot(way, way), cos_surface = dot(normal, way), cos_light = -dot(light.normal, way);
  if (!(square > 0) || !(cos_surface > 0) || !(cos_light > 0)) return {0, 0, 0};
  float geometry = (cos_surface / square) * (cos_light / square);
  *to_light = way;
  return light.intensity * (geometry < geometry_max ? geometry : geometry_max);
}
// Sum of the irradiances from all lights.
Vec3 virtual_irradiance(const VirtualLights& lights, float geometry_max, const Vec3& point, const Vec3& normal);

struct InstantRadiosity {
  static constexpr const char* kName = "instant-radiosity";
  static constexpr EffectMask kEffects = bit(Effect::instant_radiosity);
  static constexpr IndirectReference kReference = IndirectReference::nothing;
  static constexpr const char *kPresent = "light between surfaces", *kAbsent = "no light to send between surfaces";
  static IndirectUse use(const Scene& scene);
  static IndirectNeed need(const Scene&, const Quality&) { return {arena_need<VirtualLights>(1), 0}; }
  static const void* prepare(const Scene&, const Quality&, Arena* keep, Arena* scratch);
  static Vec3 radiance(const IndirectPoint& at);
  static Vec3d exact(const Scene&, const Vec3d&) { return {0, 0, 0}; }
  static float bound(const Scene&, const Material&) { return 0; }  // see radiance_bound(), which knows the lights
};

}  // namespace pocketray
