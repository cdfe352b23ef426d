// Adaptive shadow tests of area lights: exact where straight edges cast the shadows, and the same however rays are
// traced.
#include "shade/point_groups.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <set>

#include "shade/shade_helpers.h"
#include "support/effort.h"

using namespace pocketray;

namespace {

TracedPicture trace(const Scene& scene, Settings settings, AreaShadows choice, const AccelInfo* accel = nullptr,
                    bool in_tiles = true) {
  settings.area_shadows = choice;
  return trace_picture(scene, settings, accel, in_tiles);
}

bool same(const Picture& a, const Picture& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(Vec3)) == 0;
}

Settings settings_of(std::uint32_t points, std::uint32_t width = 24, std::uint32_t height = 20) {
  Settings settings;
  settings.width = width, settings.height = height;
  settings.points_per_area_light = points;
  settings.cut_off_levels = 0;
  return settings;
}

Material lamp() {
  Material m = matte(0);
  m.emission = {8, 8, 8};
  return m;
}

// A floor under a lamp turned by an angle, and between them half a plane that ends in a straight edge.
std::unique_ptr<GeneratedScene> half_plane_scene(Rng* rng) {
  auto s = std::make_unique<GeneratedScene>();
  const std::uint32_t floor = add_material(s.get(), matte(0.7f)), light = add_material(s.get(), lamp());
  add_sheet(s.get(), 0, floor);
  auto turned = [](float angle, float x, float y, float z) {
    const float c = std::cos(angle), n = std::sin(angle);
    return Vec3{c * x - n * y, n * x + c * y, z};
  };
  const float angle = 6 * next_float(rng), a = 0.3f + next_float(rng), b = 0.3f + next_float(rng);
  auto corner = [&](float x, float y) { return turned(angle, x, y, 3); };
  add_quad(s.get(), corner(-a, b), corner(a, b), corner(a, -b), corner(-a, -b), light);
  const float edge = 6 * next_float(rng), x = next_float(rng) - 0.5f;
  auto far = [&](float u, float v) { return turned(edge, u, v, 1.5f); };
  add_quad(s.get(), far(x, -40), far(60, -40), far(60, 40), far(x, 40), floor);
  aim(s.get(), {0, -3, 1}, {0, 0, 0}, 60);
  s->bind();
  return s;
}

}  // namespace

// Goal: the penumbra of a straight edge is that of all points. Method: lamps and edges at random angles; square numbers
// of points, which are grids; pictures bit for bit, from fewer rays.
TEST_CASE("point_groups_are_exact_behind_a_straight_edge") {
  Rng rng = make_rng(3);
  std::uint64_t rays = 0, all_rays = 0;
  for (int i = 0; i < effort(12); ++i) {
    CAPTURE(i);
    auto s = half_plane_scene(&rng);
    for (std::uint32_t side : {3u, 4u, 5u, 8u, 10u, 16u}) {
      CAPTURE(side);
      const Settings settings = settings_of(side * side);
      const TracedPicture every = trace(s->scene, settings, AreaShadows::every);
      const TracedPicture adaptive = trace(s->scene, settings, AreaShadows::adaptive);
      CHECK(same(every.picture, adaptive.picture));
      for (float scale : {0x1p-50f, 0x1p50f}) {
        if (side != 4) break;
        std::vector<Vec3> positions = s->positions;
        Camera camera = s->cameras[0];
        for (Vec3& p : s->positions) p = p * scale;
        s->cameras[0].eye = camera.eye * scale, s->cameras[0].target = camera.target * scale;
        s->bind();
        CHECK(same(adaptive.picture, trace(s->scene, settings, AreaShadows::adaptive).picture));
        s->positions = positions, s->cameras[0] = camera;
        s->bind();
      }
      if (side == 8) rays += adaptive.shadow_rays, all_rays += every.shadow_rays;
    }
  }
  MESSAGE("64 points: ", rays, " rays instead of ", all_rays);
  CHECK(rays * 3 < all_rays);
}

// Goal: what an area light sends does not depend on how its rays are traced. Method: generated scenes with lamps, many
// points, glossy, mirrored and transparent surfaces; tiles against single rays, and each accelerator.
TEST_CASE("point_groups_are_the_same_in_tiles_and_ray_by_ray") {
  std::uint64_t rays = 0, all_rays = 0;
  for (std::uint32_t seed = 0; seed < static_cast<std::uint32_t>(effort(18)); ++seed) {
    CAPTURE(seed);
    constexpr std::uint32_t kPoints[] = {6, 9, 16, 50, 144, 256};
    auto s = generate_scene(bit(Feature::emission) | (seed % 2 ? ~0u : 1u << seed / 2 % 20 | 1u << seed % 7), seed);
    Material low = lamp();  // partly below the floor
    low.emission = {1, 2, 3}, low.double_sided = true;
    add_quad(s.get(), {-1.5f, -0.6f, 1}, {1.5f, -0.6f, 0.5f}, {1.5f, 1, 0.5f}, {-1.5f, 1, 1},
             add_material(s.get(), low));
    if (!s->material_maps.empty()) s->material_maps.resize(s->materials.size());
    if (!s->grains.empty()) s->grains.resize(s->materials.size());
    if (!s->clear_coats.empty()) s->clear_coats.resize(s->materials.size());
    if (!s->sheens.empty()) s->sheens.resize(s->materials.size());
    if (!s->glass_maps.empty()) s->glass_maps.resize(s->materials.size());
    if (!s->iridescences.empty()) s->iridescences.resize(s->materials.size());
    if (!s->diffuse_transmissions.empty()) s->diffuse_transmissions.resize(s->materials.size());
    s->bind();
    Settings settings = settings_of(kPoints[seed % 6]);
    settings.cut_off_levels = seed % 3 == 0 ? 0.5f : 0;
    settings.light_tolerance = 0;
    const TracedPicture tiles = trace(s->scene, settings, AreaShadows::adaptive);
    const TracedPicture single = trace(s->scene, settings, AreaShadows::adaptive, nullptr, false);
    CHECK(same(tiles.picture, single.picture));
    for (const AccelInfo* accel : kAccelList)
      CHECK(same(tiles.picture, trace(s->scene, settings, AreaShadows::adaptive, accel).picture));
    const TracedPicture every = trace(s->scene, settings, AreaShadows::every);
    CHECK(single.shadow_rays <= every.shadow_rays + every.shadow_rays / 2);  // probes of points that do not matter
    rays += single.shadow_rays, all_rays += every.shadow_rays;
  }
  MESSAGE(rays, " rays instead of ", all_rays);
  CHECK(rays < all_rays);
}

// Goal: groups halve a light's points, and each point has its place. Method: lamps of one and of several pieces, any
// number of points; the first group has all points, and the halves of a divided one are its points.
TEST_CASE("point_groups_divide_the_points_of_each_light") {
  for (std::uint32_t n = kUndividedMax + 1; n <= kPointsPerAreaLightMax; n += kEffortDivisor > 1 ? 29 : 1) {
    CAPTURE(n);
    GeneratedScene s;
    add_sheet(&s, 0, add_material(&s, matte(0.7f)));
    const std::uint32_t lamps[] = {add_material(&s, lamp()), add_material(&s, lamp())};
    add_sphere(&s, {0, 0, 3}, 0.5f, 8, 6, lamps[0]);
    add_quad(&s, {1, 0, 2}, {2, 0, 2}, {2, 1, 2}, {1, 1, 2}, lamps[1]);
    aim(&s, {0, -3, 1}, {0, 0, 0}, 60);
    s.bind();
    auto test = make_renderer(s.scene, settings_of(n, 2, 2));
    REQUIRE(render_frame(&test->renderer, 0).ok);
    const PointGroups& groups = test->renderer.frame.lights.point_groups;
    REQUIRE(groups.groups.count == 2 * n);
    REQUIRE(groups.points_of_light == n);
    for (std::uint32_t first : {0u, n}) {
      const PointGroup* all = &groups.groups[first];
      CHECK(all->begin == 0);
      CHECK(all->end == n);
      std::set<int> points(&groups.order[first], &groups.order[first] + n);
      CHECK(points.size() == n);
      for (std::uint32_t i = 0; i < n; ++i) CHECK(groups.place[first + groups.order[first + i]] == i);
      for (std::uint32_t i = 0, left = 1; i < left; ++i) {
        const PointGroup& group = all[i];
        for (std::uint8_t probe : group.probes) {
          const std::uint8_t place = groups.place[first + probe];
          CHECK((place >= group.begin && place < group.end));
        }
        if (!group.second) {
          CHECK(group.end - group.begin <= static_cast<int>(kUndividedMax));
          continue;
        }
        left += 2;
        const PointGroup &one = all[i + 1], &other = all[group.second];
        CHECK((one.begin == group.begin && one.end == other.begin && other.end == group.end));
        CHECK(3 * std::min(one.end - one.begin, other.end - other.begin) >= group.end - group.begin);
      }
    }
  }
}

// Goal: without need, no groups. Method: few points, every point tested, source selection.
TEST_CASE("point_groups_are_left_out_where_they_save_nothing") {
  Rng rng = make_rng(4);
  auto s = half_plane_scene(&rng);
  auto group_count = [&](Settings settings) {
    auto test = make_renderer(s->scene, settings);
    REQUIRE(render_frame(&test->renderer, 0).ok);
    return test->renderer.frame.lights.point_groups.groups.count;
  };
  CHECK(group_count(settings_of(9)) == 9);
  CHECK(group_count(settings_of(kUndividedMax)) == 0);
  Settings every = settings_of(9);
  every.area_shadows = AreaShadows::every;
  CHECK(group_count(every) == 0);
  for (int i = 0; i < 64; ++i) {
    Light light;
    light.kind = LightKind::point, light.position = {0, 0, 2}, light.intensity = {0.1f, 0.1f, 0.1f};
    s->lights.push_back(light);
  }
  s->bind();
  CHECK(group_count(settings_of(9)) == 0);
}

// Goal: 4 samples of 4 points see a penumbra nearly as 16 points of one sample do, and better than 4. Method:
// behind the straight edge of half a plane, each against as many samples of 256 points.
TEST_CASE("point_groups_of_samples_add_up") {
  constexpr std::uint32_t kCounts[3][2] = {{4, 4}, {1, 16}, {1, 4}};  // samples, points
  Rng rng = make_rng(7);
  double square[3] = {0, 0, 0};
  for (int i = 0; i < std::max(4, effort(12)); ++i) {
    const auto s = half_plane_scene(&rng);
    for (int way = 0; way < 3; ++way) {
      Settings settings = settings_of(256);
      settings.samples_per_pixel = kCounts[way][0];
      const Picture truth = trace(s->scene, settings, AreaShadows::every).picture;
      settings.points_per_area_light = kCounts[way][1];
      const Picture picture = trace(s->scene, settings, AreaShadows::every).picture;
      for (std::size_t k = 0; k < truth.size(); ++k) square[way] += std::pow(double(picture[k].x - truth[k].x), 2);
    }
  }
  const double to_16 = std::sqrt(square[0] / square[1]), to_4 = std::sqrt(square[0] / square[2]);
  MESSAGE("RMSE of 4 × 4 points: ", to_16, " of that of 16, ", to_4, " of that of 4");
  CHECK(square[1] > 0);
  CHECK(to_16 < (kEffortDivisor > 1 ? 2 : 1.5));
  CHECK(to_4 < (kEffortDivisor > 1 ? 0.75 : 0.65));
}
