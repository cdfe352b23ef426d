// Flat lamps in closed form, against the formula in double precision, sums over many points, and each way to trace.
#include "shade/polygon_light.h"

#include <doctest/doctest.h>

#include <cmath>
#include <cstring>

#include "plan/place_light_polygons.h"
#include "shade/form_factor.h"
#include "shade/shade_helpers.h"
#include "support/effort.h"

using namespace pocketray;

namespace {

Vec3 random_direction(Rng* rng) {
  for (;;) {
    const Vec3 v = {2 * next_float(rng) - 1, 2 * next_float(rng) - 1, 2 * next_float(rng) - 1};
    if (dot(v, v) > 0.01f && dot(v, v) < 1) return normalize(v);
  }
}

// A star-shaped polygon of `count` corners, convex if they lie on a circle.
LightPolygon random_polygon(Rng* rng, std::uint32_t count, bool convex) {
  LightPolygon p = {};
  const Vec3 middle = {4 * next_float(rng), 4 * next_float(rng), 4 * next_float(rng)};
  Vec3 across, along;
  p.normal = random_direction(rng);
  make_basis(p.normal, &across, &along);
  p.corner_count = count;
  for (std::uint32_t i = 0; i < count; ++i) {
    const double angle = 2 * kPiD * (i + 0.8 * next_double(rng)) / count;
    const float radius = convex ? 0.5f : 0.15f + 0.35f * next_float(rng);
    p.corners[i] = middle + across * (radius * static_cast<float>(std::cos(angle))) +
                   along * (radius * static_cast<float>(std::sin(angle)));
  }
  p.radiance = {3, 2, 1};
  p.scale = 1, p.margin = 0x1p-9f;
  return p;
}

Vec3 middle_of(const LightPolygon& p) {
  Vec3 sum = {0, 0, 0};
  for (std::uint32_t i = 0; i < p.corner_count; ++i) sum += p.corners[i];
  return sum / static_cast<float>(p.corner_count);
}

Surface facing(const Vec3& point, const Vec3& normal) {
  Surface s = {};
  s.point = point, s.normal = s.geometric = normal;
  return s;
}

// A point in front of the polygon at a distance of up to kPolygonNear, turned to it by less than 60° or anyhow.
Surface random_receiver(Rng* rng, const LightPolygon& p, bool turned) {
  const float distance = std::exp2(-5 + 8.9f * next_float(rng));
  const Vec3 from = normalize(p.normal + random_direction(rng) * 0.9f);
  Vec3 normal = random_direction(rng);
  if (turned) normal = normalize(-from + normal * 0.5f);
  return facing(middle_of(p) + from * distance, normal);
}

double exact_form_factor(const LightPolygon& p, const Surface& s) {
  Vec3d corners[kLightCornerMax], clipped[2 * kLightCornerMax];
  for (std::uint32_t i = 0; i < p.corner_count; ++i) corners[i] = to_double(p.corners[i]) - to_double(s.point);
  const Vec3d normal = to_double(s.normal);
  return form_factor_above_horizon(clipped, clip_to_horizon(corners, p.corner_count, normal, clipped), normal);
}

Material lamp(float radiance = 8) {
  Material m = matte(0);
  m.emission = {radiance, radiance, radiance};
  return m;
}

Settings settings_of(std::uint32_t points, AreaIrradiance form = AreaIrradiance::analytic, std::uint32_t width = 24,
                     std::uint32_t height = 20) {
  Settings settings;
  settings.width = width, settings.height = height;
  settings.points_per_area_light = points;
  settings.cut_off_levels = 0;
  settings.area_irradiance = form;
  return settings;
}

Picture picture_of(const Scene& scene, const Settings& settings, const AccelInfo* accel = nullptr,
                   bool in_tiles = true) {
  return trace_picture(scene, settings, accel, in_tiles).picture;
}

bool same(const Picture& a, const Picture& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(Vec3)) == 0;
}

// A floor under a square lamp of side 2 at a height.
std::unique_ptr<GeneratedScene> lamp_scene(float height, bool with_blocker = false) {
  auto s = std::make_unique<GeneratedScene>();
  const std::uint32_t floor = add_material(s.get(), matte(0.7f)), light = add_material(s.get(), lamp());
  add_sheet(s.get(), 0, floor);
  add_quad(s.get(), {-1, 1, height}, {1, 1, height}, {1, -1, height}, {-1, -1, height}, light);
  if (with_blocker) add_quad(s.get(), {-.3f, -2, 1}, {.4f, -2, 1}, {.4f, 2, 1}, {-.3f, 2, 1}, floor);
  aim(s.get(), {0, -3, 1}, {0, 0, 0}, 60);
  s->bind();
  return s;
}

}  // namespace

// Goal: the closed form in float is as exact as float allows. Method: random polygons of 3 to 8 corners, convex and
// not, seen from up to the distance at which points take over, above the horizon and cut by it, and on a border of the
// ranges of the arc tangent; against the formula in double precision.
TEST_CASE("polygon_light_is_the_formula_in_double_precision") {
  Rng rng = make_rng(5);
  double worst = 0, worst_relative = 0;
  int near = 0, cut = 0;
  for (int i = 0; i < effort(200000); ++i) {
    const LightPolygon p = random_polygon(&rng, 3 + static_cast<std::uint32_t>(i % 6), i % 2 == 0);
    const Surface s = random_receiver(&rng, p, i % 3 != 0);
    const PolygonView view = view_polygon(p, s);
    if (!view.is_near) continue;
    ++near;
    cut += view.highest > 0;
    const double exact = std::fmax(exact_form_factor(p, s), 0), off = std::fabs(view.form_factor - exact);
    worst = std::fmax(worst, off);
    if (exact > 1e-4 && view.highest == 0) worst_relative = std::fmax(worst_relative, off / exact);
  }
  MESSAGE("largest error ", worst, ", relative ", worst_relative, "; ", near, " near, ", cut, " cut by the horizon");
  CHECK(near > effort(100000));
  CHECK(cut > effort(20000));
  CHECK(worst < 3e-6);
  CHECK(worst_relative < 2e-4);
}

// Goal: the part below the horizon counts for nothing. Method: against the sum over a fine grid of points, each with
// its cosines.
TEST_CASE("polygon_light_below_the_horizon") {
  Rng rng = make_rng(6);
  for (int i = 0; i < effort(40); ++i) {
    LightPolygon p = {};
    p.corner_count = 4, p.scale = 0.5f, p.margin = 0x1p-9f, p.normal = {0, 0, -1};
    const Vec3 corners[4] = {{-1, 1, 1}, {1, 1, 1}, {1, -1, 1}, {-1, -1, 1}};
    std::memcpy(p.corners, corners, sizeof corners);
    const Vec3 normal =
        normalize(Vec3{next_float(&rng) - 0.5f, next_float(&rng) - 0.5f, 0.6f * next_float(&rng) - 0.4f});
    const Surface s = facing({0.2f, 0.1f, 0}, normal);
    double sum = 0;
    constexpr int kSide = 400;
    for (int x = 0; x < kSide; ++x)
      for (int y = 0; y < kSide; ++y) {
        const Vec3d to = Vec3d{-1 + (2 * x + 1.0) / kSide, -1 + (2 * y + 1.0) / kSide, 1} - to_double(s.point);
        const double square = dot(to, to), cosine = dot(to, to_double(normal)) / std::sqrt(square);
        if (cosine > 0) sum += cosine * (to.z / std::sqrt(square)) / square * 4 / (kSide * kSide) / kPiD;
      }
    CAPTURE(i);
    CHECK(std::fabs(view_polygon(p, s).form_factor - sum) < 2e-5);
  }
}

// Goal: extreme places give a share of the hemisphere. Method: on corners, edges, in the plane, in line with an edge,
// as near as floats can be, far away, and where coordinates overflow.
TEST_CASE("hard_polygon_light_in_extreme_places") {
  LightPolygon p = {};
  p.corner_count = 4, p.scale = 0.25f, p.margin = 0x1p-9f, p.normal = {0, 0, -1};
  const Vec3 corners[4] = {{-1, 1, 1}, {1, 1, 1}, {1, -1, 1}, {-1, -1, 1}};
  std::memcpy(p.corners, corners, sizeof corners);
  const float below = std::nextafterf(1.0f, 0.0f);
  for (float z : {1.0f, below, 0.999f, 2.0f, 0.0f, -1e-30f, -1e30f, -3e38f})
    for (float x : {0.0f, 1.0f, -1.0f, 0.5f, 1.5f, 1e-30f, 3e38f})
      for (const Vec3& normal : {Vec3{0, 0, 1}, Vec3{1, 0, 0}, Vec3{0, 0, -1}, normalize(Vec3{1, 1, 1e-7f})}) {
        const PolygonView view = view_polygon(p, facing({x, x, z}, normal));
        CAPTURE(x);
        CAPTURE(z);
        CHECK(view.form_factor >= 0);
        CHECK(view.form_factor <= 1);
        if (z == 1 || z == 2) CHECK(view.form_factor == 0);
      }
  CHECK(view_polygon(p, facing({0, 0, below}, {0, 0, 1})).form_factor == doctest::Approx(1));
  CHECK(view_polygon(p, facing({0, 1, below}, {0, 0, 1})).form_factor == doctest::Approx(0.5));
  CHECK(view_polygon(p, facing({1, 1, below}, {0, 0, 1})).form_factor == doctest::Approx(0.25));
  CHECK(!view_polygon(p, facing({0, 0, -3e38f}, {0, 0, 1})).is_near);
  const Surface in_front = facing({0.2f, 0.1f, 0}, {0.6f, 0, 0.8f}), behind = facing({0.2f, 0.1f, 2}, {0.6f, 0, -0.8f});
  CHECK(view_polygon(p, behind).form_factor == 0);
  p.two_sided = 1;
  CHECK(view_polygon(p, behind).form_factor == doctest::Approx(view_polygon(p, in_front).form_factor));
  CHECK(view_polygon(p, behind).is_whole == view_polygon(p, in_front).is_whole);
}

// Goal: a floor under a lamp that nothing hides is lit as by infinitely many points, whatever their number, also close
// to the lamp, where four points give up to 2.5 times the light. Method: radiances against the formula in double
// precision, .7 · 8 times the form factor.
TEST_CASE("polygon_light_needs_no_points_where_nothing_is_in_the_way") {
  double off_points = 0;
  for (float height : {0.25f, 0.5f, 2.0f, 20.0f}) {
    CAPTURE(height);
    LightPolygon p = {};
    p.corner_count = 4;
    const Vec3 corners[4] = {{-1, 1, height}, {1, 1, height}, {1, -1, height}, {-1, -1, height}};
    std::memcpy(p.corners, corners, sizeof corners);
    for (std::uint32_t points : {1u, 4u, 5u, 16u, 256u}) {
      CAPTURE(points);
      auto s = lamp_scene(height);
      auto analytic = ray_renderer(s.get(), 1, points);
      Settings settings = analytic->renderer.settings;
      settings.area_irradiance = AreaIrradiance::points;
      auto summed = make_renderer(s->scene, settings);
      for (int i = 0; i < 12; ++i) {
        const float x = 0.25f * static_cast<float>(i);
        const Vec3 eye = {x, -2, 0.2f}, floor = {x, 0.1f, 0};
        const double exact = 5.6 * exact_form_factor(p, facing(floor, {0, 0, 1}));
        CHECK(static_cast<double>(look(*analytic, eye, floor).x) == doctest::Approx(exact).epsilon(1e-5));
        if (points != 4) continue;
        const double ratio = static_cast<double>(look(*summed, eye, floor).x) / exact;
        off_points = std::fmax(off_points, std::fabs(ratio - 1));
      }
    }
  }
  CHECK(off_points > 0.5);
}

// Goal: the shadow of a lamp in closed form is that of its points. Method: where they agree that it is hidden, the
// picture is black in both forms; elsewhere it converges to many points.
TEST_CASE("polygon_light_behind_a_blocker") {
  auto s = lamp_scene(2, true);
  const Picture exact = picture_of(s->scene, settings_of(256, AreaIrradiance::points));
  const Picture few = picture_of(s->scene, settings_of(16)),
                points = picture_of(s->scene, settings_of(16, AreaIrradiance::points));
  double error = 0, error_of_points = 0;
  for (std::size_t i = 0; i < exact.size(); ++i) {
    CHECK((few[i].x == 0) == (points[i].x == 0));
    error += std::fabs(static_cast<double>(few[i].x - exact[i].x));
    error_of_points += std::fabs(static_cast<double>(points[i].x - exact[i].x));
  }
  CAPTURE(error);
  CAPTURE(error_of_points);
  CHECK(error < error_of_points);
}

// Goal: lamps too dim for weights leave finite pictures. Method: radiances about the smallest floats, a lamp that is
// partly hidden and one that the floor's horizon cuts, matte and glossy floors.
TEST_CASE("polygon_light_of_a_lamp_hardly_above_nothing") {
  for (float radiance : {1e-36f, 1e-38f, 1e-40f, 1e-44f})
    for (bool glossy : {false, true})
      for (float height : {2.0f, 0.01f}) {
        CAPTURE(radiance);
        auto s = lamp_scene(height, true);
        for (Material& m : s->materials) {
          if (!is_zero(m.emission)) m.emission = {radiance, radiance, radiance};
          if (glossy) m.specular = {0.3f, 0.3f, 0.3f};
        }
        s->bind();
        for (const Vec3& pixel : picture_of(s->scene, settings_of(4))) CHECK(is_finite(pixel));
      }
}

// Goal: as a lamp sets behind a horizon, its light fades out without a step, whatever the number of points. Method: a
// wall turned in small steps; no step of the radiance exceeds what the slope of the whole curve explains.
TEST_CASE("polygon_light_sets_without_a_step") {
  for (std::uint32_t points : {1u, 4u, 16u}) {
    CAPTURE(points);
    float last = -1, largest = 0, brightest = 0;
    for (int step = 0; step <= 400; ++step) {
      const float angle = static_cast<float>(step * (1.6 / 400));  // beyond it, the lamp is below
      auto s = std::make_unique<GeneratedScene>();
      const std::uint32_t wall = add_material(s.get(), matte(0.7f)), light = add_material(s.get(), lamp());
      const float c = 5 * std::cos(angle), n = 5 * std::sin(angle);
      add_quad(s.get(), {-c, -5, n}, {c, -5, -n}, {c, 5, -n}, {-c, 5, n}, wall);
      add_quad(s.get(), {-6, 1, 3}, {-4, 1, 3}, {-4, -1, 3}, {-6, -1, 3}, light);
      auto test = ray_renderer(s.get(), 1, points);
      const float radiance = look(*test, {5 * std::sin(angle + 0.2f), 0, 5 * std::cos(angle + 0.2f)}, {0, 0, 0}).x;
      if (last >= 0) largest = std::fmax(largest, std::fabs(radiance - last));
      last = radiance, brightest = std::fmax(brightest, radiance);
    }
    CAPTURE(largest);
    CAPTURE(brightest);
    CHECK(brightest > 0.05f);
    CHECK(largest < 0.03f * brightest);
  }
}

// Goal: what a lamp sends does not depend on how its rays are traced, nor on the size of the scene. Method: generated
// scenes with lamps, glossy, mirrored and transparent surfaces and smooth normals, few points and many; tiles against
// single rays, each accelerator, and sizes 2⁻⁵⁰ and 2⁵⁰.
TEST_CASE("polygon_light_is_the_same_in_tiles_and_ray_by_ray") {
  int changed = 0;
  for (std::uint32_t seed = 0; seed < static_cast<std::uint32_t>(effort(12)); ++seed) {
    CAPTURE(seed);
    auto s = generate_scene(bit(Feature::emission) | (seed % 2 ? ~0u : 1u << seed / 2 % 20 | 1u << seed % 7), seed);
    Material low = lamp(2);  // partly below the floor
    low.double_sided = true;
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
    for (std::uint32_t points : {1u, 4u, 9u}) {
      CAPTURE(points);
      Settings settings = settings_of(points);
      settings.light_tolerance = 0;
      settings.cut_off_levels = seed % 2 ? 0 : 0.5f;
      const Picture tiles = picture_of(s->scene, settings);
      CHECK(same(tiles, picture_of(s->scene, settings, nullptr, false)));
      for (const AccelInfo* accel : kAccelList) CHECK(same(tiles, picture_of(s->scene, settings, accel)));
      settings.area_irradiance = AreaIrradiance::points;
      changed += !same(tiles, picture_of(s->scene, settings));
    }
  }
  CHECK(changed > 0);
  auto round = lamp_scene(2);  // coarse: points of the lamp are below triangles whose normals see it whole
  round->with_normals = true;
  add_sphere(round.get(), {0, 0, 0.6f}, 0.6f, 9, 6, add_material(round.get(), matte(0.5f)));
  round->bind();
  for (std::uint32_t points : {4u, 64u}) {
    Settings settings = settings_of(points, AreaIrradiance::analytic, 96, 80);
    settings.area_shadows = AreaShadows::every;
    CHECK(same(picture_of(round->scene, settings), picture_of(round->scene, settings, nullptr, false)));
  }
  auto s = lamp_scene(2, true);
  const Picture picture = picture_of(s->scene, settings_of(4));
  for (float scale : {0x1p-50f, 0x1p50f}) {
    auto scaled = lamp_scene(2, true);
    for (Vec3& p : scaled->positions) p = p * scale;
    scaled->cameras[0].eye = scaled->cameras[0].eye * scale;
    scaled->cameras[0].target = scaled->cameras[0].target * scale;
    scaled->bind();
    CHECK(same(picture, picture_of(scaled->scene, settings_of(4))));
  }
}

// Goal: a lamp does not light itself, on whichever side of its plane rounding puts a point. Method: a tilted lamp that
// also reflects, alone: each pixel shows what it emits.
TEST_CASE("polygon_light_does_not_light_its_lamp") {
  GeneratedScene s;
  Material light = lamp();
  light.diffuse = {0.7f, 0.7f, 0.7f};
  add_quad(&s, {-1, -0.3f, 1.1f}, {1.1f, -0.7f, 0.9f}, {1.3f, 1.1f, 2.1f}, {-0.8f, 1.5f, 2.3f},
           add_material(&s, light));
  aim(&s, {0.1f, -1, 5}, {0.1f, 0.5f, 1.5f}, 40);
  s.bind();
  const Picture picture = picture_of(s.scene, settings_of(4, AreaIrradiance::analytic, 48, 40));
  int seen = 0;
  for (const Vec3& pixel : picture) {
    CHECK((pixel == Vec3{8, 8, 8} || is_zero(pixel)));
    seen += !is_zero(pixel);
  }
  CHECK(seen > 200);
}

// Goal: lamps that a polygon describes get one. Method: outlines of a square, of several, of an L and of a triangle;
// each plane of a lamp that is bent or has two sides; none for lamps in parts, with textures, or of many corners.
TEST_CASE("light_polygons_of_flat_lamps") {
  auto corners_of = [](auto build) {
    GeneratedScene s;
    const std::uint32_t floor = add_material(&s, matte(0.7f)), light = add_material(&s, lamp());
    add_sheet(&s, 0, floor);
    build(&s, light);
    aim(&s, {0, -3, 1}, {0, 0, 0}, 60);
    s.bind();
    auto test = make_renderer(s.scene, settings_of(4));
    REQUIRE(render_frame(&test->renderer, 0).ok);
    const Array<const LightPolygon>& polygons = test->renderer.frame.lights.polygons;
    std::uint32_t corners = 0;
    for (const LightPolygon& polygon : polygons) corners += polygon.corner_count;
    return corners;
  };
  auto quad = [](GeneratedScene* s, float x, float y, float side, std::uint32_t m, float lift = 0) {
    add_quad(s, {x, y + side, 3 + lift}, {x + side, y + side, 3 + lift}, {x + side, y, 3}, {x, y, 3}, m);
  };
  CHECK(corners_of([&](auto* s, auto m) { quad(s, 0, 0, 1, m); }) == 4);
  CHECK(corners_of([&](auto* s, auto m) { quad(s, 0, 0, 1, m), quad(s, 1, 0, 1, m); }) == 6);
  CHECK(corners_of([&](auto* s, auto m) { quad(s, 0, 0, 1, m), quad(s, 1, 0, 1, m), quad(s, 0, 1, 1, m); }) == 8);
  CHECK(corners_of([&](auto* s, auto m) {
          add_triangle(s, add_vertex(s, {0, 1, 3}), add_vertex(s, {1, 0, 3}), add_vertex(s, {0, 0, 3}), m);
        }) == 3);
  CHECK(corners_of([&](auto* s, auto m) { quad(s, 0, 0, 1, m), quad(s, 5, 0, 1, m); }) == 0);
  CHECK(corners_of([&](auto* s, auto m) { quad(s, 0, 0, 1, m), quad(s, 0, 1, 1, m, 0.1f); }) == 8);
  CHECK(corners_of([&](auto* s, auto m) {
          quad(s, 0, 0, 1, m);
          add_quad(s, {0, 0, 3}, {1, 0, 3}, {1, 1, 3}, {0, 1, 3}, m);  // its back
        }) == 8);
  CHECK(corners_of([&](auto* s, auto m) {
          s->with_uvs = true;
          s->materials[m].emission_texture.texture = add_texture(s, 1, 1, {{255, 255, 255, 255}});
          quad(s, 0, 0, 1, m);
        }) == 0);
  CHECK(corners_of([&](auto* s, auto m) {
          for (int i = 0; i < 5; ++i) quad(s, static_cast<float>(i), 0, 1, m);
        }) == 0);
}
