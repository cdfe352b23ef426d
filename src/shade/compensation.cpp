#include "shade/compensation.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

#include "base/check.h"
#include "shade/filters.h"
#include "shade/lights.h"
#include "shade/virtual_light.h"

namespace pocketray {
namespace {

// With more lights than this, each place in the pattern considers every n-th one.
constexpr std::uint32_t kLightsOfPlace = 16;

// Light that arrives at a point if nothing is in the way.
struct Candidate {
  Vec3 irradiance;
  Ray ray;
  const LightPoint* emitter;  // light whose own flat piece casts no shadow; null: none
  std::uint16_t index;        // of the light
};

// A candidate sampled in proportion to its contribution, and the sum of all contributions.
struct Choice {
  float left;  // random number in [0, 1), rescaled after every candidate
  float most = 0, sum = 0;
  Candidate chosen = {};

  // Keeps the new candidate with probability share = own / sum, and rescales the random number for reuse.
  void add(const Candidate& candidate) {
    const float own = max_component(candidate.irradiance);
    if (!(own > 0)) return;
    sum += own;
    const float share = own / sum;
    if (left < share) {
      chosen = candidate, most = own;
      left /= share;
    } else {
      left = (left - share) / (1 - share);
    }
    left = std::min(left, 1 - 0x1p-24f);
  }
};

// Fractions of the multiples of 1 / ρ and 1 / ρ², ρ³ = ρ + 1: together an even 2D sequence [Roberts 2018].
constexpr std::uint32_t kStepOfLights = 3242174889u, kStepOfVirtualLights = 2447445414u;
float spread_number(std::uint32_t index, std::uint32_t step) {
  return static_cast<float>((index + 1) * step >> 8) * 0x1p-24f;
}

// Rotates `local` to the basis about n of Duff et al. [2017, listing 3].
Vec3 about_normal(const Vec3& n, const Vec3& local) {
  const float sign = std::copysign(1.0f, n.z), a = -1 / (sign + n.z), b = n.x * n.y * a;
  const Vec3 tangent = {1 + sign * n.x * n.x * a, sign * b, -sign * n.x}, bitangent = {b, sign + n.y * n.y * a, -n.y};
  return tangent * local.x + bitangent * local.y + n * local.z;
}

struct CompensationRays {
  const FrameData& frame;
  const VirtualLights& lights;
  TraceStats* stats;
  std::uint64_t* rays;
  std::uint32_t place;  // in the pattern
  CompensationPath* path;

  // Estimates the light of all candidates from the chosen one: zero if it is blocked.
  Vec3 arriving(const Choice& choice, float scale, std::uint16_t* light) const {
    if (!(choice.sum > 0)) return {0, 0, 0};
    if (has(frame.mask, Effect::shadow)) {
      const ShadowContext context = {&frame, choice.chosen.emitter};
      const HitFilter opaque = {frame.filters.accept_opaque, &context, frame.filters.read_point};
      const bool is_filtered = frame.filters.every_shadow || choice.chosen.emitter;
      ++*rays;
      *light = choice.chosen.index;
      if (frame.geometry.first_rays->occluded(frame.geometry.accel, choice.chosen.ray, is_filtered ? &opaque : nullptr,
                                              stats))
        return {0, 0, 0};
    }
    return choice.chosen.irradiance * (choice.sum / choice.most * scale);
  }

  Vec3 from_lights(const Surface& s) const {
    const std::uint32_t stride = (frame.lights.points.count + kLightsOfPlace - 1) / kLightsOfPlace;
    Choice choice = {spread_number(place, kStepOfLights)};
    for (int r = 0; r < frame.lights.run_count; ++r) {
      const LightRun& run = frame.lights.runs[r];
      // The run's first index that is `place` modulo the stride.
      std::uint32_t i = run.begin + (place + stride - run.begin % stride) % stride;
      for (; i < run.end; i += stride) {
        const LightPoint& light = frame.lights.points[i];
        LightSample sample;
        if (!lights_up(frame, s, run, light, &sample) || is_below(s, sample.direction)) continue;
        const Vec3 irradiance = sample.irradiance * dot(s.normal, sample.direction);
        choice.add({irradiance,
                    {safe_origin(s, 1), sample.to_light, sample.t_max},
                    emitter_of(light),
                    static_cast<std::uint16_t>(i)});
      }
    }
    return arriving(choice, static_cast<float>(stride), &path->light);
  }

  Vec3 from_virtual_lights(const Surface& s) const {
    const Vec3 origin = safe_origin(s, 1);
    Choice choice = {spread_number(place, kStepOfVirtualLights)};
    // Every sixteenth in spatial order represents all of them better than the lights of one place do.
    for (std::uint32_t i = place; i < lights.count; i += kPatternPixels) {
      Candidate candidate = {{0, 0, 0}, {}, nullptr, static_cast<std::uint16_t>(i)};
      if (!arrives(lights.light[i], lights.geometry_max, s, &candidate.irradiance)) continue;
      candidate.ray = ray_to(lights.light[i], s, origin);
      choice.add(candidate);
    }
    return arriving(choice, static_cast<float>(kPatternPixels), &path->virtual_light);
  }

  // π times the light from a direction, weighted by the share that the virtual lights lack.
  Vec3 from(const Surface& receiver, const Vec3& direction) const {
    const float cos_receiver = dot(receiver.normal, direction);
    if (!(cos_receiver > 0) || is_below(receiver, direction)) return {0, 0, 0};
    const float geometry_max = lights.first_geometry_max;
    const Ray ray = {safe_origin(receiver, 1), direction, std::sqrt(cos_receiver / geometry_max)};
    Hit hit;
    ++*rays;
    frame.geometry.first_rays->closest(frame.geometry.accel, ray, visible_filter(frame), &hit, stats);
    path->end = ray.origin + direction * (hit.triangle == kNoTriangle ? ray.t_max : hit.t);
    if (hit.triangle == kNoTriangle) return {0, 0, 0};
    Surface s;
    frame.kernels.surface(frame, ray, hit, &s);
    const float cosines = cos_receiver * -dot(s.geometric, direction), bounded = geometry_max * hit.t * hit.t;
    if (is_zero(s.diffuse) || !(cosines > bounded)) return {0, 0, 0};
    return s.diffuse * (from_lights(s) + from_virtual_lights(s)) * (1 - bounded / cosines);
  }
};

}  // namespace

void store(const CompensationPath& path, KeptPath* kept) {
  std::uint32_t words[4];
  std::memcpy(words, &path, sizeof words);
  for (int i = 0; i < 4; ++i) kept->words[i].store(words[i], std::memory_order_relaxed);
}

CompensationPath load(const KeptPath& kept) {
  std::uint32_t words[4];
  for (int i = 0; i < 4; ++i) words[i] = kept.words[i].load(std::memory_order_relaxed);
  CompensationPath path;
  std::memcpy(static_cast<void*>(&path), words, sizeof words);
  return path;
}

Vec3 compensation_direction(std::uint32_t place_in_pattern) {
  CHECK_LT(place_in_pattern, kPatternPixels);
  // (0, 2)-sequence [Sobol 1967]: reversed bits, and bits transformed by Pascal's triangle.
  const std::uint32_t b0 = place_in_pattern & 1, b1 = place_in_pattern >> 1 & 1, b2 = place_in_pattern >> 2 & 1,
                      b3 = place_in_pattern >> 3;
  const std::uint32_t ring = b0 * 8 + b1 * 4 + b2 * 2 + b3, sector = b0 * 8 ^ b1 * 12 ^ b2 * 10 ^ b3 * 15;
  constexpr float kCosine[] = {0.98078528f, 0.83146961f, 0.55557023f, 0.19509032f};  // odd multiples of π / 16
  float x = kCosine[sector & 3], y = kCosine[3 - (sector & 3)];
  if (sector & 4) x = -std::exchange(y, x);
  if (sector & 8) x = -x, y = -y;
  const float square = (static_cast<float>(ring) + 0.5f) / kPatternPixels, sine = std::sqrt(square);
  return {sine * x, sine * y, std::sqrt(1 - square)};
}

void add_compensation(const FrameData& frame, const InterleavedPoints& points, TraceStats* stats, std::uint64_t* rays,
                      InterleavedLight* light) {
  CHECK_LE(points.count, kPacketMax);
  const VirtualLights& lights = *virtual_lights_of(frame.indirect);
  const bool is_lacking = lights.first_geometry_max > 0;
  if (!is_lacking && !points.pixel) return;
  for (std::uint32_t i = 0; i < points.count; ++i) {
    const Surface& s = *points.surface[i];
    CompensationPath path = {s.point, kNoPathLight, kNoPathLight};
    if (is_lacking && !is_zero(s.diffuse)) {
      const std::uint32_t place = place_of(points.place[i]);
      const Vec3 light_lacking = CompensationRays{frame, lights, stats, rays, place, &path}.from(
          s, about_normal(s.normal, compensation_direction(place)));
      light[i].lit += light_lacking * (1.0f / kPatternPixels);
    }
    if (points.pixel) store(path, &frame.kept.compensation_paths[points.pixel[i]]);
  }
}

}  // namespace pocketray
