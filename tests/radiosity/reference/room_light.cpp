#include "radiosity/reference/room_light.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <ctime>
#include <thread>

#include "desktop/reference/reference.h"
#include "effect/setting_list.h"
#include "session/radiosity_solver.h"
#include "shade/camera.h"
#include "shade/filters.h"
#include "shade/surface.h"

namespace pocketray {
namespace {

double brightness(const Vec3d& light) { return light.x + light.y + light.z; }

// What a pixel sees, if it is matte.
struct MattePoint {
  bool is_matte = false;
  Surface surface;
};

std::vector<MattePoint> matte_points(const FrameData& frame) {
  const std::uint32_t width = frame.settings.width, height = frame.settings.height;
  std::vector<MattePoint> points(std::size_t(width) * height);
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    const Ray ray =
        camera_ray(frame.view.camera, static_cast<float>(i % width) + .5f, static_cast<float>(i / width) + .5f);
    Hit hit;
    frame.geometry.accel_info->closest(frame.geometry.accel, ray, visible_filter(frame), &hit, nullptr);
    if (hit.triangle == kNoTriangle) continue;
    Surface& s = points[i].surface;
    frame.kernels.surface(frame, ray, hit, &s);
    const Material& m = *s.material;
    points[i].is_matte = !is_zero(s.diffuse) && (is_zero(m.specular) || reflects_surroundings(m)) &&
                         is_zero(m.mirror) && is_zero(m.transmission) && is_zero(m.emission) && !m.unlit &&
                         m.alpha_mode == AlphaMode::opaque && !is_culled(m, s.front);
  }
  return points;
}

// A ray that looks through backs of one-sided surfaces.
struct Look {
  const FrameData& frame;
  const Vec3& direction;
};
bool is_front(const FrameData& frame, std::uint32_t triangle, const Vec3& direction) {
  const Triangle& t = frame.scene->triangles[triangle];
  const Vec3& a = frame.geometry.positions[t.vertex(0)];
  return dot(cross(frame.geometry.positions[t.vertex(1)] - a, frame.geometry.positions[t.vertex(2)] - a), direction) <
         0;
}
bool is_seen(const void* context, std::uint32_t triangle, float, float) {
  const Look& look = *static_cast<const Look*>(context);
  const Material& m = look.frame.scene->materials[look.frame.scene->triangles[triangle].material()];
  return !is_culled(m, is_front(look.frame, triangle, look.direction));
}

// Emission along a ray from a surface, which is not indirect light.
Vec3d emission_along(const FrameData& frame, const Ray& ray) {
  Hit hit;
  const Look look = {frame, ray.direction};
  const HitFilter seen = {is_seen, &look, false};
  frame.geometry.accel_info->closest(frame.geometry.accel, ray, &seen, &hit, nullptr);
  if (hit.triangle == kNoTriangle) return {0, 0, 0};
  return to_double(frame.scene->materials[frame.scene->triangles[hit.triangle].material()].emission);
}

// The mean over side² directions.
double light_at(const Reference& reference, const Surface& s, std::uint32_t side, Rng* rng) {
  const FrameData& frame = *reference.world.frame;
  ReferenceOptions options;
  const Vec3 origin = safe_origin(s, 1);
  Vec3 tangent, bitangent;
  make_basis(s.normal, &tangent, &bitangent);
  double sum = 0;
  for (std::uint32_t i = 0; i < side * side; ++i) {
    const double u = (i / side + static_cast<double>(next_float(rng))) / side,
                 v = (i % side + static_cast<double>(next_float(rng))) / side;
    const float out = static_cast<float>(std::sqrt(u)), angle = static_cast<float>(2 * kPi * v);
    const Vec3 direction = tangent * (out * std::cos(angle)) + bitangent * (out * std::sin(angle)) +
                           s.normal * static_cast<float>(std::sqrt(1 - u));
    const Vec3d all = sample_radiance(reference, options, to_double(origin), to_double(direction), rng);
    const Vec3d straight = emission_along(frame, {origin, direction, __builtin_inff()});
    sum += brightness(to_double(s.diffuse) * (all - straight));
  }
  return sum / (static_cast<double>(side) * side);
}

// Sums over rounds, by halves.
struct PixelSamples {
  Rng rng[2];
  double sum[2] = {0, 0};
};

RoomLight empty_light(std::uint32_t width, std::uint32_t height) {
  RoomLight light;
  light.columns = (width + kRegionSide - 1) / kRegionSide, light.rows = (height + kRegionSide - 1) / kRegionSide;
  light.sum.assign(std::size_t(light.columns) * light.rows, 0);
  return light;
}
std::size_t region_of(const RoomLight& light, std::uint32_t width, std::uint32_t pixel) {
  return std::size_t(pixel / width / kRegionSide) * light.columns + pixel % width / kRegionSide;
}

RoomLight light_of_samples(const std::vector<PixelSamples>& samples, const std::vector<std::uint32_t>& rounds,
                           std::uint32_t width, std::uint32_t height) {
  RoomLight light = empty_light(width, height);
  light.error = light.half[0] = light.half[1] = light.sum;
  for (std::uint32_t i = 0; i < samples.size(); ++i) {
    const std::size_t region = region_of(light, width, i);
    const double a = samples[i].sum[0] / rounds[region], b = samples[i].sum[1] / rounds[region];
    light.half[0][region] += a, light.half[1][region] += b, light.sum[region] += .5 * (a + b);
    light.error[region] += .25 * (a - b) * (a - b);
  }
  for (double& error : light.error) error = std::sqrt(error);
  return light;
}

double least_that_counts(const RoomLight& light) {
  double all = 0;
  int lit = 0;
  for (double sum : light.sum) all += sum, lit += sum > 0;
  return lit ? kRegionCounts * all / lit : 0;
}

}  // namespace

RoomLight true_light(const Scene& scene, const Settings& chosen, const TruthOptions& options) {
  Settings settings = chosen;
  settings.indirect = IndirectChoice::none;
  const auto test = make_renderer(scene, settings);
  REQUIRE(render_frame(&test->renderer, 0).ok);
  const FrameData& frame = test->renderer.frame;
  std::vector<std::uint8_t> memory(reference_need(frame) + kArenaAlignment);
  Arena arena = make_arena("reference", memory.data(), memory.size());
  const Reference reference = make_reference(frame, &arena);
  const std::vector<MattePoint> points = matte_points(frame);
  const std::uint32_t width = settings.width, height = settings.height,
                      side = static_cast<std::uint32_t>(std::sqrt(static_cast<double>(options.directions)) + .5);
  std::vector<PixelSamples> samples(points.size());
  for (std::uint32_t i = 0; i < samples.size(); ++i)
    for (std::uint32_t half = 0; half < 2; ++half) samples[i].rng[half] = make_rng(1 + half, i);
  RoomLight light = empty_light(width, height);
  std::vector<std::uint32_t> rounds(light.sum.size(), 0);
  std::vector<char> goes_on(light.sum.size(), 1);
  for (std::uint32_t round = 0; round < options.rounds_max; ++round) {
    std::atomic<std::uint32_t> next{0};
    auto follow = [&] {
      for (std::uint32_t i = next++; i < points.size(); i = next++)
        if (points[i].is_matte && goes_on[region_of(light, width, i)])
          for (int half = 0; half < 2; ++half)
            samples[i].sum[half] += light_at(reference, points[i].surface, side, &samples[i].rng[half]);
    };
    std::thread other(follow);
    follow();
    other.join();
    for (std::size_t r = 0; r < rounds.size(); ++r) rounds[r] += goes_on[r] != 0;
    light = light_of_samples(samples, rounds, width, height);
    const double least = least_that_counts(light);
    for (std::size_t r = 0; r < rounds.size(); ++r)
      goes_on[r] = goes_on[r] && light.sum[r] > .5 * least && light.error[r] > options.noise_max * light.sum[r];
  }
  return light;
}

RoomLight rendered_light(const Scene& scene, const Settings& settings) {
  Settings without = settings;
  without.indirect = IndirectChoice::none;
  const auto test = make_renderer(scene, without);
  REQUIRE(render_frame(&test->renderer, 0).ok);
  const std::vector<MattePoint> points = matte_points(test->renderer.frame);
  const Picture with = render_picture(scene, settings), direct = render_picture(scene, without);
  RoomLight light = empty_light(settings.width, settings.height);
  for (std::uint32_t i = 0; i < points.size(); ++i)
    if (points[i].is_matte)
      light.sum[region_of(light, settings.width, i)] += brightness(to_double(with[i]) - to_double(direct[i]));
  return light;
}

RoomErrors compare_light(const RoomLight& found, const RoomLight& truth) {
  REQUIRE(found.sum.size() == truth.sum.size());
  const bool sampled = !truth.error.empty();
  double all = 0, all_found = 0, most = 0;
  for (std::size_t i = 0; i < truth.sum.size(); ++i) all += truth.sum[i], all_found += found.sum[i];
  RoomErrors errors;
  if (!(all > 0)) return errors;
  errors.total = all_found / all - 1;
  const double least = least_that_counts(truth);
  int count = 0;
  for (std::size_t i = 0; i < truth.sum.size(); ++i) {
    if (!(truth.sum[i] > least)) continue;
    const double chosen = found.sum[i] - (sampled ? truth.half[0] : truth.sum)[i],
                 error = (found.sum[i] - (sampled ? truth.half[1] : truth.sum)[i]) / truth.sum[i];
    if (std::fabs(chosen) / truth.sum[i] > most) {
      most = std::fabs(chosen) / truth.sum[i], errors.worst = error, errors.region = i;
      if (sampled) errors.worst_noise = std::sqrt(2.0) * truth.error[i] / truth.sum[i];
    }
    errors.mean += chosen > 0 ? error : -error, ++count;
    if (sampled) errors.noise += truth.error[i] / truth.sum[i];
  }
  errors.mean /= count, errors.noise /= count;
  return errors;
}

RoomLight stored_light(Scene scene, Settings settings, std::uint32_t patch_count, std::uint32_t threads,
                       StoredCost* cost) {
  RadiositySolution solution;
  const std::clock_t begin = std::clock();
  {
    Settings small;
    small.width = small.height = 4, small.indirect = IndirectChoice::none;
    const auto test = make_renderer(scene, small);
    RadiosityOptions options;
    options.patch_count = patch_count, options.threads = threads;
    const Status status = solve_radiosity(
        test->renderer.frame, options, [](double) { return true; }, &solution);
    REQUIRE_MESSAGE(status.ok, status.message);
  }
  if (cost != nullptr)
    *cost = {solution.patch_count, solution.bytes(), static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC};
  solution.view(&scene);
  settings.indirect = indirect_choice(Effect::radiosity);
  return rendered_light(scene, settings);
}

RoomLight instant_light(const Scene& scene, Settings settings, std::uint32_t light_count) {
  settings.indirect = indirect_choice(Effect::instant_radiosity), settings.virtual_lights = light_count;
  return rendered_light(scene, settings);
}

Settings room_settings(std::uint32_t width, std::uint32_t height) {
  Settings settings;
  settings.width = width, settings.height = height;
  settings.cut_off_levels = 0;
  return settings;
}

}  // namespace pocketray
