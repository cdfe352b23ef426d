#include "radiosity/reference/room_light.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <thread>

#include "effect/setting_list.h"
#include "radiosity/solve.h"
#include "reference/reference.h"
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
    const Ray ray = camera_ray(frame.camera, static_cast<float>(i % width) + .5f, static_cast<float>(i / width) + .5f);
    Hit hit;
    frame.accel_info->closest(frame.accel, ray, visible_filter(frame), &hit, nullptr);
    if (hit.triangle == kNoTriangle) continue;
    Surface& s = points[i].surface;
    frame.first_surface(frame, ray, hit, &s);
    const Material& m = *s.material;
    points[i].is_matte = !is_zero(s.diffuse) && (is_zero(m.specular) || reflects_surroundings(m)) &&
                         is_zero(m.mirror) && is_zero(m.transmission) && is_zero(m.emission) && !m.unlit &&
                         m.alpha_mode == AlphaMode::opaque && !is_culled(m, s.front);
  }
  return points;
}

// Emission along a ray from a surface, which is not indirect light.
Vec3d emission_along(const FrameData& frame, const Ray& ray) {
  Hit hit;
  frame.accel_info->closest(frame.accel, ray, visible_filter(frame), &hit, nullptr);
  if (hit.triangle == kNoTriangle) return {0, 0, 0};
  const Triangle& t = frame.scene->triangles[hit.triangle];
  const Material& m = frame.scene->materials[t.material()];
  const Vec3& a = frame.positions[t.vertex(0)];
  const bool front = dot(cross(frame.positions[t.vertex(1)] - a, frame.positions[t.vertex(2)] - a), ray.direction) < 0;
  return front || m.double_sided ? to_double(m.emission) : Vec3d{0, 0, 0};
}

struct Sample {
  double light, square;
};
Sample light_at(const Reference& reference, const Surface& s, std::uint32_t side, Rng* rng) {
  const FrameData& frame = *reference.world.frame;
  ReferenceOptions options;
  const Vec3 origin = safe_origin(s, 1);
  Vec3 tangent, bitangent;
  make_basis(s.normal, &tangent, &bitangent);
  const double count = static_cast<double>(side) * side;
  double sum = 0, squares = 0;
  for (std::uint32_t i = 0; i < side * side; ++i) {
    const double u = (i / side + static_cast<double>(next_float(rng))) / side,
                 v = (i % side + static_cast<double>(next_float(rng))) / side;
    const float out = static_cast<float>(std::sqrt(u)), angle = static_cast<float>(2 * kPi * v);
    const Vec3 direction = tangent * (out * std::cos(angle)) + bitangent * (out * std::sin(angle)) +
                           s.normal * static_cast<float>(std::sqrt(1 - u));
    const Vec3d all = sample_radiance(reference, options, to_double(origin), to_double(direction), rng);
    const Vec3d straight = emission_along(frame, {origin, direction, __builtin_inff()});
    const double light = brightness(to_double(s.diffuse) * (all - straight));
    sum += light, squares += light * light;
  }
  return {sum / count, std::max(0.0, squares / count - sum / count * (sum / count)) / count};
}

RoomLight empty_light(std::uint32_t width, std::uint32_t height) {
  RoomLight light;
  light.columns = (width + kRegionSide - 1) / kRegionSide, light.rows = (height + kRegionSide - 1) / kRegionSide;
  light.sum.assign(std::size_t(light.columns) * light.rows, 0);
  return light;
}
std::size_t region_of(const RoomLight& light, std::uint32_t width, std::uint32_t pixel) {
  return std::size_t(pixel / width / kRegionSide) * light.columns + pixel % width / kRegionSide;
}

}  // namespace

RoomLight true_light(const Scene& scene, const Settings& chosen, std::uint32_t direction_count) {
  Settings settings = chosen;
  settings.indirect = IndirectChoice::none;
  const auto test = make_renderer(scene, settings);
  REQUIRE(render_frame(&test->renderer, 0).ok);
  const FrameData& frame = test->renderer.frame;
  std::vector<std::uint8_t> memory(reference_need(frame) + kArenaAlignment);
  Arena arena = make_arena("reference", memory.data(), memory.size());
  const Reference reference = make_reference(frame, &arena);
  const std::vector<MattePoint> points = matte_points(frame);
  const std::uint32_t width = settings.width,
                      side = static_cast<std::uint32_t>(std::sqrt(static_cast<double>(direction_count)) + .5);
  std::vector<Sample> samples(points.size(), {0, 0});
  auto follow = [&](std::uint32_t first, std::uint32_t step) {
    for (std::uint32_t i = first; i < points.size(); i += step) {
      if (!points[i].is_matte) continue;
      Rng rng = make_rng(1, i);
      samples[i] = light_at(reference, points[i].surface, side, &rng);
    }
  };
  std::thread other(follow, 1u, 2u);
  follow(0, 2);
  other.join();
  RoomLight light = empty_light(width, settings.height);
  light.error.assign(light.sum.size(), 0);
  for (std::uint32_t i = 0; i < points.size(); ++i)
    light.sum[region_of(light, width, i)] += samples[i].light,
        light.error[region_of(light, width, i)] += samples[i].square;
  for (double& error : light.error) error = std::sqrt(error);
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
  double all = 0, all_found = 0;
  std::size_t lit = 0;
  for (std::size_t i = 0; i < truth.sum.size(); ++i)
    all += truth.sum[i], all_found += found.sum[i], lit += truth.sum[i] > 0;
  RoomErrors errors;
  if (!(all > 0)) return errors;
  errors.total = all_found / all - 1;
  int count = 0;
  for (std::size_t i = 0; i < truth.sum.size(); ++i) {
    if (!(truth.sum[i] > .25 * all / static_cast<double>(lit))) continue;
    const double error = found.sum[i] / truth.sum[i] - 1;
    if (std::fabs(error) > std::fabs(errors.worst)) {
      errors.worst = error, errors.region = i;
      if (!truth.error.empty()) errors.worst_noise = truth.error[i] / truth.sum[i];
    }
    errors.mean += std::fabs(error), ++count;
    if (!truth.error.empty()) errors.noise += truth.error[i] / truth.sum[i];
  }
  errors.mean /= count, errors.noise /= count;
  return errors;
}

RoomLight stored_light(Scene scene, Settings settings, std::uint32_t patch_count, std::uint32_t threads) {
  RadiositySolution solution;
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
