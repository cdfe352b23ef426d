// Virtual lights behind first hits: in mirrors and behind glass, where no neighbours share them.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "base/fmath.h"
#include "effect/setting_list.h"
#include "instant_light.h"
#include "shade/filters.h"
#include "shade/trace_spans.h"
#include "shade/virtual_light.h"
#include "support/generated_scene.h"

using namespace pocketray;

namespace {

// A room with a point light, a wall across it that throws shadows, and a mirror, glass or a veil before the camera,
// which sees only that at first.
enum class Pane { mirror, glass, veil, glass_in_mirror };
struct RoomBehindPane : GeneratedScene {
  explicit RoomBehindPane(Pane pane) {
    Material grey, front;
    grey.diffuse = {0.5f, 0.5f, 0.5f};
    const std::uint32_t material = add_material(this, grey);
    add_box(this, {-1, -1, -1}, {1, 1, 1}, material, true);
    add_box(this, {-0.2f, -1, -0.3f}, {0, 0.5f, 0.3f}, material);
    const bool mirrors = pane == Pane::mirror || pane == Pane::glass_in_mirror;
    front.diffuse = {0, 0, 0}, front.double_sided = true;
    if (mirrors) front.mirror = {0.5f, 0.5f, 0.5f};
    if (pane == Pane::glass) front.transmission = {0.5f, 0.5f, 0.5f}, front.thin = true, front.ior = 1;
    if (pane == Pane::veil) front.alpha_mode = AlphaMode::blend, front.opacity = 0.5f;
    add_quad(this, {-0.6f, -0.6f, 0.8f}, {-0.6f, 0.6f, 0.8f}, {0.6f, 0.6f, 0.8f}, {0.6f, -0.6f, 0.8f},
             add_material(this, front));
    if (pane == Pane::glass_in_mirror) {
      Material tinted = grey;
      tinted.transmission = {0.5f, 0.5f, 0.5f}, tinted.thin = true, tinted.ior = 1;
      add_quad(this, {-1, -1, 0.4f}, {1, -1, 0.4f}, {1, 1, 0.4f}, {-1, 1, 0.4f}, add_material(this, tinted));
    }
    Light light = {};
    light.kind = LightKind::point, light.position = {0.5f, 0.5f, 0.5f};
    light.intensity = {kPiF, kPiF, kPiF};
    lights.push_back(light);
    aim(this, {0, 0, mirrors ? 0.6f : 0.95f}, {0, 0, mirrors ? 0.8f : 0.5f}, 60);
    bind();
  }
};

Settings instant(std::uint32_t lights, float tolerance) {
  Settings settings = instant_settings(lights);
  settings.light_tolerance = tolerance, settings.cut_off_levels = 0;
  return settings;
}

Surface surface_along(const FrameData& frame, const Ray& ray) {
  Hit hit;
  TraceStats stats;
  frame.geometry.accel_info->closest(frame.geometry.accel, ray, nullptr, &hit, &stats);
  REQUIRE(hit.triangle != kNoTriangle);
  Surface s;
  frame.kernels.surface(frame, ray, hit, &s);
  return s;
}

// By a ray to every light.
Vec3 visible_light(const FrameData& frame, const Surface& s) {
  const VirtualLights& lights = *virtual_lights_of(frame.indirect);
  Vec3 sum = {0, 0, 0}, light;
  const Vec3 origin = safe_origin(s, 1);
  TraceStats stats;
  for (std::uint32_t i = 0; i < lights.count; ++i)
    if (arrives(lights.light[i], lights.geometry_max, s, &light) &&
        !frame.geometry.accel_info->occluded(
            frame.geometry.accel, {origin, lights.light[i].position - origin, kVirtualRayEnd}, nullptr, &stats))
      sum += light;
  return s.diffuse * (sum * (1 / kPiF));
}

struct LaterLight {
  Vec3 light;
  std::uint64_t rays;
};
LaterLight later_light(const FrameData& frame, Surface s, float weight) {
  Tracer tracer = make_tracer(frame);
  s.glow = {0, 0, 0};
  add_later_virtual_light(&tracer, {weight, weight / 2, 0}, &s);
  return {s.glow, tracer.rays[static_cast<int>(RayKind::shadow)]};
}

// Directions all over the sphere [Vogel 1979].
Vec3 spread_direction(int i, int count) {
  const double z = 1 - (2 * i + 1.0) / count, sine = std::sqrt(1 - z * z), phi = 2.399963229728653 * i;
  return to_float(Vec3d{sine * det_cos(phi), sine * det_sin(phi), z});
}

}  // namespace

// Goal: surfaces behind first hits lie in the shadows of virtual lights. Method: points all over a room with a wall
// across it, against a ray to every light; the mean, and the mean error, by the tolerance; without shadows, where the
// plan has none.
TEST_CASE("later_virtual_lights_cast_shadows") {
  constexpr int kPoints = 400;
  RoomBehindPane room(Pane::mirror);
  for (float tolerance : {0.0f, 0.0625f}) {
    CAPTURE(tolerance);
    std::unique_ptr<TestRenderer> t = rendered(room.scene, instant(128, tolerance));
    const FrameData& frame = t->renderer.frame;
    const VirtualLights& lights = *virtual_lights_of(frame.indirect);
    FrameData unshadowed = frame;
    unshadowed.mask &= ~bit(Effect::shadow);
    double sum = 0, right = 0, open = 0, error = 0;
    for (int i = 0; i < kPoints; ++i) {
      const Surface s = surface_along(frame, {{-0.6f, -0.1f, 0}, spread_direction(i, kPoints), __builtin_inff()});
      if (is_zero(s.diffuse)) continue;
      const float found = later_light(frame, s, 1).light.y, expected = visible_light(frame, s).y;
      sum += static_cast<double>(found), right += static_cast<double>(expected);
      error += static_cast<double>(std::fabs(found - expected));
      const Vec3 all = InstantRadiosity::radiance({*frame.scene, &lights, s.point, s.normal, s.diffuse});
      open += static_cast<double>(all.y);
      const LaterLight bare = later_light(unshadowed, s, 1);
      CHECK((bare.light == all && bare.rays == 0));
    }
    CHECK(right < 0.8 * open);
    CHECK(sum == doctest::Approx(right).epsilon(0.01));
    CHECK(error < (tolerance > 0 ? 0.11 : 0.03) * right);
  }
}

// Goal: the number of rays is bounded by the tolerance, however many lights there are, and falls with the weight of the
// path: what they tell matters less.
TEST_CASE("later_virtual_lights_take_fewer_rays_where_they_matter_less") {
  constexpr int kPoints = 100;
  RoomBehindPane room(Pane::mirror);
  std::unique_ptr<TestRenderer> t = rendered(room.scene, instant(512, 0.0625f));
  const FrameData& frame = t->renderer.frame;
  REQUIRE(virtual_lights_of(frame.indirect)->count > 400);
  std::uint64_t sum[3] = {};
  for (int i = 0; i < kPoints; ++i) {
    const Surface s = surface_along(frame, {{-0.6f, -0.1f, 0}, spread_direction(i, kPoints), __builtin_inff()});
    const float weights[] = {1, 0.25f, 0x1p-6f};
    for (int k = 0; k < 3; ++k) {
      const std::uint64_t rays = later_light(frame, s, weights[k]).rays;
      CHECK(rays <= static_cast<std::uint64_t>(16 * weights[k]) + 1);
      sum[k] += rays;
    }
  }
  CHECK(sum[0] > 10 * kPoints);
  CHECK(sum[1] > 3 * kPoints);
  CHECK(sum[2] > kPoints / 2);
}

namespace {

// In place of add_later_virtual_light(): a light of its own, and a look at what it is asked for.
float weight_max;
void add_one(Tracer*, const Vec3& weight, Surface* surface) {
  surface->glow += Vec3{1, 1, 1};
  weight_max = std::max(weight_max, max_component(weight));
}

}  // namespace

// Goal: what is seen in a mirror, through glass and through a veil takes the light once, at its weight, as the veil
// does itself and glass seen in a mirror. Method: another light in its place, of which a known share reaches each
// pixel.
TEST_CASE("later_light_is_that_of_surfaces_behind_first_hits") {
  const struct {
    Pane pane;
    double share;
  } cases[] = {{Pane::mirror, 0.5}, {Pane::glass, 0.5}, {Pane::veil, 0.5 + 0.5}, {Pane::glass_in_mirror, 0.5 + 0.25}};
  for (const auto& c : cases) {
    CAPTURE(static_cast<int>(c.pane));
    RoomBehindPane room(c.pane);
    std::unique_ptr<TestRenderer> t = rendered(room.scene, instant(16, 0));
    Renderer& renderer = t->renderer;
    const Array<Vec3> image = renderer.image;
    const Span row = {14, 0, 40};
    std::vector<Vec3> pictures[2];
    for (int k = 0; k < 2; ++k) {
      renderer.frame.kernels.add_later_light = k ? add_one : nullptr;
      weight_max = 0;
      Tracer tracer = make_tracer(renderer.frame);
      trace_spans(&tracer, &row, 1, Aov::none, image.data);
      pictures[k].assign(image.begin() + 14 * 40 + 4, image.begin() + 14 * 40 + 36);
    }
    CHECK(weight_max == doctest::Approx(0.5));
    for (std::size_t i = 0; i < pictures[0].size(); ++i)
      CHECK(pictures[1][i].y - pictures[0][i].y == doctest::Approx(c.share).epsilon(1e-4));
  }
}
