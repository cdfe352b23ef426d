#include "desktop/radiosity/rays.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <thread>

#include "base/check.h"
#include "base/fmath.h"
#include "base/rng.h"
#include "indirect/environment.h"
#include "shade/lights.h"
#include "shade/surface.h"

namespace pocketray {
namespace {

constexpr double kDoubt = 1.5;  // standard errors of a share of random rays; those here err less

Vec3 origin_of(const Receiver& from) { return to_float(from.point + from.normal * from.lift); }

// A ray that looks through backs of one-sided surfaces, as a viewer does who looks along `direction`.
struct Look {
  const SceneRays* rays;
  Vec3 direction;
  Backs backs;
};
bool is_seen(const void* context, std::uint32_t triangle, float u, float v) {
  const Look& look = *static_cast<const Look*>(context);
  const FrameData& frame = look.rays->frame;
  const Triangle& t = frame.scene->triangles[triangle];
  const Material& m = frame.scene->materials[t.material()];
  const std::vector<char>* bodies = look.rays->bodies;
  const bool is_body = bodies == nullptr || (*bodies)[triangle];
  if (!m.double_sided && (look.backs == Backs::hide_nothing || !is_body)) {
    const Vec3& a = frame.geometry.positions[t.vertex(0)];
    const Vec3 outward = cross(frame.geometry.positions[t.vertex(1)] - a, frame.geometry.positions[t.vertex(2)] - a);
    if (is_culled(m, dot(outward, look.direction) <= 0)) return false;
  }
  const HitFilter* filter = look.rays->filter();
  return !filter || filter->accept(filter->context, triangle, u, v);
}

// Returns whether a viewer looking along the ray, or against it, sees from one end to the other.
bool is_clear(const SceneRays& rays, const Ray& ray, const Vec3& direction, Backs backs) {
  const Look look = {&rays, direction, backs};
  const HitFilter seen = {is_seen, &look, rays.frame.filters.read_point};
  TraceStats stats;
  return !rays.frame.geometry.accel_info->occluded(rays.frame.geometry.accel, ray,
                                                   backs == Backs::hide ? rays.filter() : &seen, &stats);
}

}  // namespace

bool is_visible(const SceneRays& rays, const Receiver& from, const Vec3d& to, Backs backs) {
  const Vec3 origin = origin_of(from), way = to_float(to) - origin;
  return is_clear(rays, {origin, way, 1}, way, backs);
}

Vec3d sky_radiance(const Scene& scene, const Vec3& direction) {
  if (!environment_of(scene)) return to_double(scene.info.background);
  return to_double(environment_gloss(scene, direction, kGlossRoughness[0] * kGlossRoughness[0]));
}

Outlook look_around(const SceneRays& rays, const Receiver& from, std::uint32_t count, std::uint32_t seed) {
  const std::uint32_t side = static_cast<std::uint32_t>(std::sqrt(static_cast<double>(count)) + 0.5);
  CHECK_EQ(side * side, count);
  CHECK(rays.bodies == nullptr || rays.bodies->size() == rays.frame.scene->triangles.count);
  Rng rng = make_rng(seed);
  Vec3 tangent, bitangent;
  const Vec3 normal = to_float(from.normal), origin = origin_of(from);
  make_basis(normal, &tangent, &bitangent);
  Outlook outlook;
  for (std::uint32_t i = 0; i < count; ++i) {
    const double square = (i / side + static_cast<double>(next_float(&rng))) / side;
    const double angle = 2 * kPi * (i % side + static_cast<double>(next_float(&rng))) / side;
    const double out = std::sqrt(square);
    const Vec3 direction = tangent * static_cast<float>(out * det_cos(angle)) +
                           bitangent * static_cast<float>(out * det_sin(angle)) +
                           normal * static_cast<float>(std::sqrt(1 - square));
    TraceStats stats;
    Hit hit;
    const Look look = {&rays, direction, Backs::of_bodies_hide};
    const HitFilter seen = {is_seen, &look, rays.frame.filters.read_point};
    rays.frame.geometry.accel_info->closest(rays.frame.geometry.accel, {origin, direction, __builtin_inff()},
                                            rays.has_sheets ? &seen : rays.filter(), &hit, &stats);
    if (hit.triangle == kNoTriangle) {
      outlook.open += 1.0 / count;
      outlook.sky += sky_radiance(*rays.frame.scene, direction) / static_cast<double>(count);
      continue;
    }
    const Triangle& t = rays.frame.scene->triangles[hit.triangle];
    const Vec3& a = rays.frame.geometry.positions[t.vertex(0)];
    const Vec3 outward =
        cross(rays.frame.geometry.positions[t.vertex(1)] - a, rays.frame.geometry.positions[t.vertex(2)] - a);
    const Material& m = rays.frame.scene->materials[t.material()];
    // Backs of lamps and of sheets are other fronts.
    const bool is_body = rays.bodies == nullptr || (*rays.bodies)[hit.triangle];
    const bool has_two_fronts = m.double_sided && (!is_zero(m.emission) || !is_body);
    (dot(outward, direction) <= 0 || has_two_fronts ? outlook.front : outlook.back) += 1.0 / count;
  }
  return outlook;
}

double credible_sum(double sum, double closed, std::uint32_t count) {
  CHECK_GE(count, 1u);
  CHECK(closed >= 0);
  const double least = closed < 0.5 ? 1.0 / count : 0;  // what is small may lie between all rays
  const double error = kDoubt * std::sqrt(std::max(least, closed * (1 - closed)) / count);
  return std::min(std::max(sum, closed - error), closed + error);
}

VisibleShare visible_share(const SceneRays& rays, const Receiver& from, const Patch& patch, double factor,
                           std::uint32_t seed, Backs backs) {
  CHECK(factor > 0);
  const bool all = factor > 0.01;
  const Vec3 origin = origin_of(from);
  int here = 0, there = 0, tried = 0;
  for (int i = 0; i < (all ? kPatchSamples : 1); ++i) {
    const PatchSample& sample = patch.samples[all ? i : static_cast<int>(seed % kPatchSamples)];
    const Vec3d to = sample.point + sample.normal * patch.lift;
    ++tried;
    const Vec3 way = to_float(to) - origin;
    const bool seen = is_clear(rays, {origin, way, 1}, way, Backs::hide), through = !seen && backs != Backs::hide;
    here += seen || (through && is_clear(rays, {origin, way, 1}, way, backs));
    there += seen || (through && is_clear(rays, {origin, way, 1}, -way, backs));
  }
  return {static_cast<double>(here) / tried, static_cast<double>(there) / tried};
}

Vec3d light_irradiance(const SceneRays& rays, const Receiver& at) {
  Vec3d sum = {0, 0, 0};
  const FrameData& frame = rays.frame;
  const Vec3 origin = origin_of(at), normal = to_float(at.normal);
  for (int r = 0; r < frame.lights.run_count; ++r) {
    const LightRun& run = frame.lights.runs[r];
    if (run.sample == find_light_sampler(Effect::area_light)) continue;  // emitting patches
    for (std::uint32_t i = run.begin; i < run.end; ++i) {
      LightSample sample;
      if (!run.sample(frame.lights.points[i], origin, &sample)) continue;
      const float cosine = dot(normal, sample.direction);
      TraceStats stats;
      if (!(cosine > 0) || frame.geometry.accel_info->occluded(
                               frame.geometry.accel, {origin, sample.to_light, sample.t_max}, rays.filter(), &stats))
        continue;
      sum += to_double(sample.irradiance) * static_cast<double>(cosine);
    }
  }
  return sum;
}

void for_each_on_threads(std::uint32_t count, std::uint32_t threads, void (*work)(void* user, std::uint32_t i),
                         void* user) {
  CHECK_GE(threads, 1u);
  std::atomic<std::uint32_t> next{0};
  auto run = [&] {
    for (std::uint32_t i = next++; i < count; i = next++) work(user, i);
  };
  std::vector<std::thread> others;
  for (std::uint32_t i = 1; i < threads; ++i) others.emplace_back(run);
  run();
  for (std::thread& thread : others) thread.join();
}

}  // namespace pocketray
