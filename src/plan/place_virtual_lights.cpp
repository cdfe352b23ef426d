#include "plan/place_virtual_lights.h"

#include <cmath>

#include "base/check.h"
#include "base/fmath.h"
#include "brdf/directions.h"
#include "plan/plan_lights.h"
#include "shade/filters.h"
#include "shade/lights.h"
#include "shade/material_maps.h"
#include "shade/surface.h"

namespace pocketray {
namespace {

// Chosen: paths end at random, and among surfaces of reflectance 0.8 one in fourteen would go further. Their light is
// lost; more bounces would need more of kPrimes.
constexpr std::uint32_t kBounceMax = 12;
constexpr std::uint32_t kNumbersPerBounce = 3;
constexpr std::uint32_t kWalksMeasured = 256;
constexpr EffectMask kLights =
    bit(Effect::point_light) | bit(Effect::spot_light) | bit(Effect::directional_light) | bit(Effect::area_light);
// Three numbers at the light, three per bounce: multiples of the square roots of primes, modulo one. They are evenly
// spread [Weyl 1916] from the first one on, unlike Halton's sequence in large bases.
constexpr double kPrimes[kNumbersPerBounce * (kBounceMax + 1)] = {
    2,  3,  5,  7,  11, 13,  17,  19,  23,  29,  31,  37,  41,  43,  47,  53,  59,  61,  67, 71,
    73, 79, 83, 89, 97, 101, 103, 107, 109, 113, 127, 131, 137, 139, 149, 151, 157, 163, 167};

// Bound of the geometry term, relative to that of a patch of a light's share of the surfaces, which gives at most π
// times its radiance where it lies. Measured: with a quarter, ꟻLIP against full transport falls on cornell, cube and
// seesaw, the mean by at most .014. With compensation it keeps falling down to 1/32; below, light is lost, since what
// the compensation's rays hit is not compensated itself; see tests/indirect/FIGURES.md.
constexpr double kBound = 0.25, kCompensatedBound = 0.0625;

// Position of a walk's bounce in the pattern. Successive walks, and bounces of one, cycle through its four quarters.
std::uint32_t place_in_pattern(std::uint32_t walk, std::uint32_t bounce) {
  return (4 * walk + walk / 4 + 5 * bounce) % kVirtualLightPlaces;
}

struct Walk {
  std::uint32_t index, used = 0;
  double next() {
    CHECK_LT(used, sizeof kPrimes / sizeof kPrimes[0]);
    double multiple = index * std::sqrt(kPrimes[used++]);
    return multiple - std::floor(multiple);
  }
};

struct Particle {
  Ray ray;
  Vec3d flux;
  float range = 0;  // of the light, on the way from it; 0: no limit
};

// Reference box for placing lights. It must not follow every movement of the scene, which would change all of the
// light, so it changes in steps of 1/16 to 1/32 of its longest edge.
struct Surroundings {
  Vec3d low, high;
};

Surroundings surroundings_of(const Box& bounds) {
  Surroundings s = {to_double(bounds.low), to_double(bounds.high)};
  const double longest = max_component(s.high - s.low);
  if (!(longest > 0)) return s;
  int exponent;
  std::frexp(longest, &exponent);
  const double step = std::ldexp(1, exponent - 5);
  for (double Vec3d::*axis : {&Vec3d::x, &Vec3d::y, &Vec3d::z}) {
    s.low.*axis = std::floor(s.low.*axis / step) * step;
    s.high.*axis = std::ceil(s.high.*axis / step) * step;
  }
  return s;
}

Vec3d uniform_direction(const Vec3d& axis, double height, double u, double v) {  // height: 1 − cosine of the cone
  double below = height * u, sine = std::sqrt(below * (2 - below)), phi = 2 * kPi * v;
  Vec3d tangent, bitangent;
  make_basis(axis, &tangent, &bitangent);
  return tangent * (sine * det_cos(phi)) + bitangent * (sine * det_sin(phi)) + axis * (1 - below);
}

// Flux of a light point of a run, over all directions.
Vec3d flux_of(const FrameData& frame, const LightRun& run, const LightPoint& light) {
  Vec3d intensity = to_double(light.intensity);
  if (light.material != kNone) return intensity * (kPi * (light.two_sided ? 2 : 1));
  if (run.sample == find_light_sampler(Effect::directional_light)) {
    const Surroundings s = surroundings_of(frame.geometry.accel.bounds);
    const Vec3d size = s.high - s.low;
    return intensity * (kPi * 0.25 * dot(size, size));
  }
  bool spot = run.sample == find_light_sampler(Effect::spot_light);
  return intensity * (2 * kPi * (spot ? 1 - static_cast<double>(light.cos_outer) : 2));
}

// Returns a particle that leaves a light with its flux.
Particle emit(const FrameData& frame, const LightRun& run, const LightPoint& light, Walk* walk) {
  Particle p = {{light.position, {0, 0, 0}, __builtin_inff()}, flux_of(frame, run, light), light.range};
  double u = walk->next(), v = walk->next();
  Vec3d axis = to_double(light.direction);
  if (light.material != kNone) {
    if (light.two_sided) {
      if (u < 0.5) axis = -axis;
      u = u < 0.5 ? 2 * u : 2 * u - 1;
    }
    p.ray.direction = to_float(power_cosine_direction(axis, 1, u, v));
    // Moved off the emitter by far more than rounding.
    p.ray.origin += to_float(axis) * (max_component(abs(light.position)) * 0x1p-18f);
  } else if (run.sample == find_light_sampler(Effect::directional_light)) {
    const Surroundings s = surroundings_of(frame.geometry.accel.bounds);
    Vec3d tangent, bitangent;
    double radius = 0.5 * length(s.high - s.low), r = radius * std::sqrt(u), phi = 2 * kPi * v;
    axis = normalize(axis);
    make_basis(axis, &tangent, &bitangent);
    p.ray.origin = to_float((s.low + s.high) * 0.5 - axis * (2 * radius) + tangent * (r * det_cos(phi)) +
                            bitangent * (r * det_sin(phi)));
    p.ray.direction = to_float(axis);
  } else if (run.sample == find_light_sampler(Effect::spot_light)) {
    double inner = static_cast<double>(light.cos_inner), outer = static_cast<double>(light.cos_outer);
    double below = (1 - outer) * u, cosine = 1 - below;
    double fade = cosine >= inner ? 1 : (cosine - outer) / (inner - outer);
    p.flux = p.flux * (fade * fade);
    p.ray.direction = to_float(uniform_direction(normalize(axis), 1 - outer, u, v));
  } else {
    p.ray.direction = to_float(uniform_direction({0, 0, 1}, 2, u, v));
  }
  return p;
}

// Falloff of a light with a range, as in lights.cpp.
double window_at(float range, float distance) {
  if (!(range > 0)) return 1;
  double q = static_cast<double>(distance) / static_cast<double>(range), window = 1 - q * q * q * q;
  return window > 0 ? window : 0;
}

// Scatters the particle at a surface; returns false if it is absorbed.
bool scatter(const FrameData& frame, const Surface& s, Walk* walk, Particle* p) {
  Material mapped;
  const Material& m = lobes_at(frame, s, &mapped);
  Vec3d diffuse = to_double(s.diffuse), mirror = to_double(reflectance_at(s, m.mirror, m.mirror_tinted));
  Vec3d glass = to_double(m.transmission);
  double d = max_component(diffuse), r = max_component(mirror), g = max_component(glass), total = d + r + g;
  double choice = walk->next() * (total > 1 ? total : 1), scale = total > 1 ? total : 1;
  double u = walk->next(), v = walk->next();
  if (!(choice < total)) return false;
  if (choice < d) {
    p->flux *= diffuse * (scale / d);
    p->ray = {safe_origin(s, 1), to_float(power_cosine_direction(to_double(s.geometric), 1, u, v)), __builtin_inff()};
  } else if (choice < d + r) {
    p->flux *= mirror * (scale / r);
    Vec3 way = p->ray.direction - s.normal * (2 * dot(p->ray.direction, s.normal));
    if (!(dot(way, s.geometric) > 0)) return false;
    p->ray = {safe_origin(s, 1), normalize(way), __builtin_inff()};
  } else {  // straight on, like shadow rays
    p->flux *= glass * (scale / g);
    p->ray.origin = safe_origin(s, -1);
  }
  return true;
}

// Follows a particle and leaves a light at each diffuse surface while there is room.
void follow(const FrameData& frame, Particle particle, Walk* walk, VirtualLights* lights) {
  TraceStats stats;
  for (std::uint32_t bounce = 0; bounce < kBounceMax; ++bounce) {
    Hit hit;
    frame.geometry.accel_info->closest(frame.geometry.accel, particle.ray, visible_filter(frame), &hit, &stats);
    if (hit.triangle == kNoTriangle) return;
    Surface s;
    frame.kernels.surface(frame, particle.ray, hit, &s);
    particle.flux = particle.flux * window_at(bounce == 0 ? particle.range : 0, hit.t);
    if (!is_zero(s.diffuse) && lights->count < kVirtualLightRoom) {
      Vec3d intensity = particle.flux * to_double(s.diffuse) * (1 / kPi);
      lights->light[lights->count++] = {safe_origin(s, 1), s.geometric, to_float(intensity), hit.triangle,
                                        place_in_pattern(walk->index, bounce)};
    }
    if (!scatter(frame, s, walk, &particle)) return;
  }
}

// Interleaves the bits of three coordinates, ten each.
std::uint32_t morton_code(const Surroundings& s, const Vec3& p) {
  const Vec3d from = to_double(p) - s.low, size = s.high - s.low;
  std::uint32_t code = 0, axis = 0;
  for (double at : {from.x / size.x, from.y / size.y, from.z / size.z}) {
    auto cell = static_cast<std::uint32_t>(at > 0 ? (at < 1 ? at * 1023 : 1023) : 0);
    for (std::uint32_t b = 0; b < 10; ++b) code |= (cell >> b & 1) << (3 * b + axis);
    ++axis;
  }
  return code;
}

// Sorts lights so that neighbours in space are adjacent, by insertion, which is stable.
void sort_lights(const FrameData& frame, VirtualLights* lights) {
  const Surroundings surroundings = surroundings_of(frame.geometry.accel.bounds);
  CHECK_LE(lights->count, kVirtualLightRoom);
  std::uint32_t code[kVirtualLightRoom];
  for (std::uint32_t i = 0; i < lights->count; ++i) {
    VirtualLight light = lights->light[i];
    std::uint32_t own = morton_code(surroundings, light.position), at = i;
    for (; at > 0 && code[at - 1] > own; --at) code[at] = code[at - 1], lights->light[at] = lights->light[at - 1];
    code[at] = own, lights->light[at] = light;
  }
}

// Lists the lights of each place, in order. Excess lights of a place move to the next.
void list_places(VirtualLights* lights) {
  std::uint32_t counts[kVirtualLightPlaces] = {};
  for (std::uint32_t i = 0; i < lights->count; ++i) {
    std::uint32_t& place = lights->light[i].place;
    while (counts[place] == kVirtualLightsOfPlaceMax) place = (place + 1) % kVirtualLightPlaces;
    ++counts[place];
  }
  std::uint16_t next[kVirtualLightPlaces];
  for (std::uint32_t p = 0; p < kVirtualLightPlaces; ++p) {
    next[p] = lights->first_of_place[p];
    lights->first_of_place[p + 1] = static_cast<std::uint16_t>(next[p] + counts[p]);
  }
  for (std::uint32_t i = 0; i < lights->count; ++i)
    lights->of_place[next[lights->light[i].place]++] = static_cast<std::uint16_t>(i);
}

double surface_area(const FrameData& frame) {
  double area = 0;
  for (const Triangle& t : frame.scene->triangles) {
    if (is_zero(frame.scene->materials[t.material()].diffuse)) continue;
    Vec3d a = to_double(frame.geometry.positions[t.vertex(0)]);
    area += 0.5 * length(cross(to_double(frame.geometry.positions[t.vertex(1)]) - a,
                               to_double(frame.geometry.positions[t.vertex(2)]) - a));
  }
  return area;
}

// Picks a light point with probability proportional to its flux, u in [0, 1).
bool pick(const FrameData& frame, double total, double u, const LightRun** run, const LightPoint** light,
          double* probability) {
  double left = u * total;
  for (int r = 0; r < frame.lights.run_count; ++r)
    for (std::uint32_t i = frame.lights.runs[r].begin; i < frame.lights.runs[r].end; ++i) {
      double share = max_component(flux_of(frame, frame.lights.runs[r], frame.lights.points[i]));
      if (!(share > 0)) continue;
      *run = &frame.lights.runs[r], *light = &frame.lights.points[i], *probability = share / total;
      if (left < share) return true;
      left -= share;
    }
  return total > 0;  // rounding: the last one
}

// Total flux of all lights.
double total_flux(const FrameData& frame) {
  double total = 0;
  for (int r = 0; r < frame.lights.run_count; ++r)
    for (std::uint32_t i = frame.lights.runs[r].begin; i < frame.lights.runs[r].end; ++i)
      total += max_component(flux_of(frame, frame.lights.runs[r], frame.lights.points[i]));
  return total;
}

// Sends walk `index` from a light. Returns false if no light shines.
bool send(const FrameData& frame, double total, std::uint32_t index, VirtualLights* lights) {
  Walk walk = {index + 1};
  const LightRun* run = nullptr;
  const LightPoint* light = nullptr;
  double probability = 1;
  if (!pick(frame, total, walk.next(), &run, &light, &probability) || !light) return false;
  Particle particle = emit(frame, *run, *light, &walk);
  particle.flux = particle.flux / probability;
  follow(frame, particle, &walk, lights);
  return true;
}

}  // namespace

void measure_walks(const FrameData& frame, Array<const Light> scene_lights, Array<LightPoint> points) {
  VirtualLights* lights = virtual_lights_of(frame.indirect);
  CHECK(lights != nullptr);
  FrameData plain = frame;  // independent of settings
  plain.settings = Settings();
  plain.settings.points_per_area_light = 1;
  plain.mask = frame.mask & kLights;
  plain.kernels.surface = find_surface_function(0);
  plain.filters.visible = HitFilter();
  place_lights(scene_lights, frame.scene->materials, points, &plain);
  const double total = total_flux(plain);
  lights->lights_per_walk = 0;
  std::uint32_t found = 0;
  for (std::uint32_t i = 0; i < kWalksMeasured; ++i) {
    lights->count = 0;
    if (!send(plain, total, i, lights)) break;
    found += lights->count;
  }
  lights->count = 0;
  lights->lights_per_walk = static_cast<double>(found) / kWalksMeasured;
  lights->area = surface_area(frame);
}

void place_virtual_lights(FrameData* frame) {
  CHECK(frame != nullptr && frame->kernels.surface != nullptr);
  VirtualLights* lights = virtual_lights_of(frame->indirect);
  CHECK(lights != nullptr && lights->area >= 0);
  const double wanted = frame->settings.virtual_lights, per_walk = lights->lights_per_walk;
  CHECK_LE(wanted, kVirtualLightMax);
  const double walk_max = 2 * wanted;  // a walk that hits nothing leaves no light
  const double walks = per_walk * walk_max > wanted ? std::ceil(wanted / per_walk) : walk_max;
  const double total = total_flux(*frame);
  lights->count = 0;
  std::uint32_t walk_count = 0;
  while (walk_count < walks && send(*frame, total, walk_count, lights)) ++walk_count;
  const float scale = walk_count ? static_cast<float>(1.0 / walk_count) : 0;
  // The expected number, which is steady, unless the lights have come to reach far more surfaces than at first.
  const double usual = walk_count * per_walk, count = lights->count > 2 * usual ? lights->count : usual;
  const double patch = lights->area > 0 ? kPi * count / lights->area : 0;
  const bool is_compensated = frame->settings.compensation == Compensation::rays;
  lights->geometry_max = static_cast<float>(kBound * patch);
  lights->first_geometry_max = static_cast<float>((is_compensated ? kCompensatedBound : kBound) * patch);
  CHECK_LE(lights->first_geometry_max, lights->geometry_max);
  float sum = 0;
  for (std::uint32_t i = 0; i < lights->count; ++i) {
    VirtualLight& light = lights->light[i];
    light.intensity = light.intensity * scale;
    sum += max_component(light.intensity);
  }
  lights->irradiance_max = sum * lights->geometry_max;
  sort_lights(*frame, lights);
  list_places(lights);
}

}  // namespace pocketray
