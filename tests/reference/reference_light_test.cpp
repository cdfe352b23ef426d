// Light gathered by the reference, against closed forms.
#include "base/fmath.h"
#include "desktop/reference/light.h"
#include "desktop/reference/optics.h"
#include "reference/reference_helpers.h"
#include "scene/builtin_helpers.h"
#include "support/effort.h"

using namespace pocketray;

namespace {

constexpr Transport kTransports[] = {Transport::model, Transport::physical};

// A white floor around the origin.
void add_floor(GeneratedScene* s, float side = 20) {
  add_quad(s, {-side, 0, side}, {side, 0, side}, {side, 0, -side}, {-side, 0, -side}, add_material(s, white()));
}
// A disk of 256 sides that shines down with radiance 3.
void add_disk_light(GeneratedScene* s, double radius, double height) {
  std::uint32_t light = add_material(s, emitter(3)), center = add_vertex(s, {0, static_cast<float>(height), 0});
  for (int i = 0; i < 256; ++i) {
    double x = radius * std::cos(2 * kPi * i / 256), z = radius * std::sin(2 * kPi * i / 256);
    add_vertex(s, {static_cast<float>(x), static_cast<float>(height), static_cast<float>(z)});
  }
  for (std::uint32_t i = 0; i < 256; ++i) add_triangle(s, center, center + 1 + i, center + 1 + (i + 1) % 256, light);
}
Estimate look_at(const TestReference& t, Transport transport, const Vec3d& eye, const Vec3d& point, int count) {
  return estimate(t, transport, eye, normalize(point - eye), effort(count));
}

}  // namespace

// Goal: `furnace` has the radiance E / (1 − ρ) everywhere, less by a fraction ρⁿ if n reflections are left out
// (HARDCASES row 49). Method: its scene with ρ of .5, .8 and .95; rays from inside at its walls and its block.
TEST_CASE("reference_furnace_has_its_closed_form") {
  auto built = build_builtin("furnace");
  Material m = built->scene.materials[0];
  for (double albedo : {0.5, 0.8, 0.95}) {
    m.diffuse = Vec3{1, 1, 1} * static_cast<float>(albedo);
    Scene scene = built->scene;
    scene.materials = {&m, 1};
    TestReference t(scene);
    Rng rng = make_rng(3);
    double all = 0.5 / (1 - static_cast<double>(m.diffuse.x));
    for (int i = 0; i < 2; ++i) {
      Vec3d direction = normalize(Vec3d{next_double(&rng) - 0.5, next_double(&rng) - 0.5, next_double(&rng) - 0.5});
      check_equal(estimate(t, Transport::physical, {0.7, 0.6, 0.7}, direction, effort(3000), 7), all);
      for (std::uint32_t depth : {0u, 1u, 3u})  // plus the reflection of light from the lights
        check_equal(estimate(t, Transport::physical, {0.7, 0.6, 0.7}, direction, 1000, 7, depth),
                    all * (1 - std::pow(static_cast<double>(m.diffuse.x), depth + 2)));
    }
  }
}

// Goal: the guide neither loses nor adds light. Method: a furnace with a block that is half a mirror and emits the
// missing half, so that the radiance is still E / (1 − ρ) everywhere, whichever way light came.
TEST_CASE("reference_furnace_with_a_mirror_has_its_closed_form") {
  GeneratedScene s;
  Material wall = emitter(0.5f), mirror = emitter(0.5f);
  wall.diffuse = {0.5f, 0.5f, 0.5f}, mirror.mirror = {0.5f, 0.5f, 0.5f};
  add_box(&s, {-1, -1, -1}, {1, 1, 1}, add_material(&s, wall), true);
  add_box(&s, {-0.4f, -0.4f, -0.4f}, {0.4f, 0.4f, 0.4f}, add_material(&s, mirror));
  add_camera(&s);
  s.bind();
  TestReference t(s.scene);
  CHECK(!t.reference.guide.cells.empty());
  for (Vec3d at : {Vec3d{1, 0.1, 0.2}, Vec3d{-0.3, -1, 0.7}, Vec3d{0.1, 0.4, 0.2}})
    check_equal(look_at(t, Transport::physical, {0.6, 0.7, 0.8}, at, 10000), 1);
}

// Goal: a square light at height 1 gives the centre below it the form factor .2394565 and the corner .1385316
// (HARDCASES row 37), with both kinds of transport. Method: a white floor seen at a slant; its radiance is the form
// factor times the light's.
TEST_CASE("reference_square_light_has_its_closed_form") {
  GeneratedScene s;
  add_floor(&s);
  add_quad(&s, {-0.5f, 1, -0.5f}, {0.5f, 1, -0.5f}, {0.5f, 1, 0.5f}, {-0.5f, 1, 0.5f}, add_material(&s, emitter(3)));
  add_camera(&s);
  s.bind();
  TestReference t(s.scene);
  for (Transport transport : kTransports) {
    check_equal(look_at(t, transport, {1.5, 0.4, 0.7}, {0, 0, 0}, 20000), 3 * 0.2394565);
    check_equal(look_at(t, transport, {1.5, 0.4, 0.7}, {0.5, 0, 0.5}, 20000), 3 * 0.1385316);
  }
}

// Goal: a disk light of radius r at height h gives the point below it L·r²/(r² + h²), and L as h tends to zero
// (HARDCASES row 36). Method: a white floor and a disk of 256 sides, whose area is 1 part in 10⁴ less than the disk's.
TEST_CASE("reference_disk_light_has_its_closed_form") {
  for (double height : {2.0, 0.5, 0.1, 0.01}) {
    GeneratedScene s;
    add_floor(&s);
    add_disk_light(&s, 1, height);
    add_camera(&s);
    s.bind();
    TestReference t(s.scene);
    double h = static_cast<double>(static_cast<float>(height));
    for (Transport transport : kTransports) {
      if (transport == Transport::model && height < 0.1) continue;  // points on the light alone converge slowly there
      CAPTURE(height);
      check_equal(look_at(t, transport, {0, height / 2, 0}, {0, 0, 0}, 10000), 3 / (1 + h * h), 2e-4);
    }
  }
}

// Goal: points on lights are picked with the stated density: a plane at height h whose geometry term is clamped at b
// gives E / (πL) = 2s − s², s = h√b (HARDCASES row 41). Method: a disk of radius 3, without the h² / (h² + R²) that
// lies beyond it; the test clamps the term, the reference never does.
TEST_CASE("reference_plane_with_its_geometry_term_cut_has_its_closed_form") {
  for (double b : {2.0, 0.5, 8.0}) {
    GeneratedScene s;
    add_floor(&s);
    constexpr double kRadius = 3;
    add_disk_light(&s, kRadius, 0.3);
    add_camera(&s);
    s.bind();
    TestReference t(s.scene);
    const FrameData& frame = t.renderer->renderer.frame;
    double h = static_cast<double>(0.3f), root = h * std::sqrt(b), sum = 0, squares = 0;
    int count = effort(200000);
    Rng rng = make_rng(41);
    for (int i = 0; i < count; ++i) {
      double u = next_double(&rng);
      ReferencePlace place = pick_place(frame, t.reference.emitters, {u, next_double(&rng)});
      double square = dot(place.point, place.point);
      double value = std::fmin(h * h / (square * square), b) / kPi / emitter_density(t.reference, place.triangle);
      sum += value, squares += value * value;
    }
    double mean = sum / count;
    CAPTURE(b);
    if (b == 2.0) CHECK(std::fabs(2 * root - root * root - 0.668528) < 1e-6);
    check_equal({mean, std::sqrt((squares / count - mean * mean) / count)},
                2 * root - root * root - h * h / (h * h + kRadius * kRadius), 2e-4);
  }
}

// Goal: of a light that crosses the horizon only the part above counts, and nothing after it has set (HARDCASES row
// 38). Method: a vertical square that sinks into the floor; form factor of an upright rectangle [Howell, catalogue of
// configuration factors, B-5].
TEST_CASE("reference_light_that_crosses_the_horizon_is_clipped") {
  auto factor = [](double width, double height, double distance) {  // one corner in front of the point
    double x = height / width, y = distance / width, r = std::sqrt(x * x + y * y);
    return (std::atan(1 / y) - y / r * std::atan(1 / r)) / (2 * kPi);
  };
  for (double above : {1.0, 0.5, 0.1, 0.001, 0.0, -0.5}) {
    GeneratedScene s;
    add_floor(&s);
    float top = static_cast<float>(above);
    add_quad(&s, {-0.5f, top - 1, -0.75f}, {0.5f, top - 1, -0.75f}, {0.5f, top, -0.75f}, {-0.5f, top, -0.75f},
             add_material(&s, emitter(3)));
    add_camera(&s);
    s.bind();
    TestReference t(s.scene);
    for (Transport transport : kTransports) {
      Estimate e = look_at(t, transport, {0.3, 0.4, 0.7}, {0, 0, 0}, 20000);
      double height = static_cast<double>(top);
      CAPTURE(above);
      if (height > 0.01)
        check_equal(e, 3 * 2 * factor(0.5, height, 0.75));
      else if (height > 0)
        CHECK(std::fabs(e.mean - 3 * 2 * factor(0.5, height, 0.75)) <= 5 * e.error + 1e-6);
      else
        CHECK(e.mean == 0);
    }
  }
}

// Goal: an area light that shrinks to a point becomes a point light (HARDCASES row 40). Method: a square of side r with
// constant downward intensity I; below it I/(π h²), with an error of less than a fraction r².
TEST_CASE("reference_light_that_shrinks_becomes_a_point_light") {
  for (float r : {0.1f, 1e-3f, 1e-6f, 1e-9f}) {
    GeneratedScene s;
    add_floor(&s);
    Material m = emitter(1);
    m.emission = Vec3{1, 1, 1} * (1 / (r * r));
    add_quad(&s, {-r / 2, 1, -r / 2}, {r / 2, 1, -r / 2}, {r / 2, 1, r / 2}, {-r / 2, 1, r / 2}, add_material(&s, m));
    add_camera(&s);
    s.bind();
    TestReference t(s.scene);
    CAPTURE(r);
    for (Transport transport : kTransports)
      check_equal(look_at(t, transport, {1.5, 0.4, 0.7}, {0, 0, 0}, 4000), 1 / kPi,
                  1e-6 + static_cast<double>(r) * static_cast<double>(r));
  }
}

// Goal: the wall of a sphere of albedo .5 around a point light of intensity π has the radiance 1 (HARDCASES row 50).
// Method: a tessellated sphere, all orders of reflection, within .002.
TEST_CASE("reference_sphere_about_a_light_has_its_closed_form") {
  GeneratedScene s;
  Material m;
  m.diffuse = {0.5f, 0.5f, 0.5f};
  add_sphere(&s, {0, 0, 0}, 1, 128, 64, add_material(&s, m));
  Light light;
  light.intensity = Vec3{1, 1, 1} * kPiF;
  s.lights.push_back(light);
  add_camera(&s);
  s.bind();
  TestReference t(s.scene);
  Rng rng = make_rng(3);
  for (int i = 0; i < 4; ++i) {
    Vec3d at = {next_double(&rng) - 0.5, next_double(&rng) - 0.5, next_double(&rng) - 0.5};
    check_equal(look_at(t, Transport::physical, {0.1, 0.2, 0.1}, at * 10.0, 3000), 1, 0.002);
  }
}

// Goal: sampled lobes return their albedo, diffuse and glossy together, and are reversible. Method: a sheet surrounded
// by uniform light, seen straight on, where the glossy lobe's albedo is `specular` for any exponent, and obliquely,
// where it is the integral of the value.
TEST_CASE("reference_lobes_have_their_albedo_in_a_white_furnace") {
  for (float exponent : {0.0f, 4.0f, 300.0f}) {
    GeneratedScene s;
    Material m;
    m.diffuse = {0.3f, 0.3f, 0.3f}, m.specular = {0.5f, 0.5f, 0.5f}, m.exponent = exponent;
    add_quad(&s, {-9, 0, 9}, {9, 0, 9}, {9, 0, -9}, {-9, 0, -9}, add_material(&s, m));
    s.lights.resize(1);
    s.lights[0].intensity = {0, 0, 0};
    s.scene.info.background = {1, 1, 1};
    add_camera(&s);
    s.bind();
    TestReference t(s.scene);
    CAPTURE(exponent);
    check_equal(look_at(t, Transport::physical, {0.1, 1, 0.1}, {0.1, 0, 0.1}, 20000), 0.8);
    ReferenceSurface surface = {};
    surface.material = &m, surface.normal = surface.geometric = {0, 1, 0}, surface.diffuse = to_double(m.diffuse);
    surface.specular = to_double(m.specular);
    Vec3d to_viewer = normalize(Vec3d{2, 1, 0});
    double albedo = 0, one_way = 0;
    constexpr int kRings = 400;
    for (int i = 0; i < kRings; ++i)
      for (int j = 0; j < kRings; ++j) {
        double cosine = (i + 0.5) / kRings, turn = 2 * kPi * (j + 0.5) / kRings, sine = std::sqrt(1 - cosine * cosine);
        Vec3d direction = {sine * std::cos(turn), cosine, sine * std::sin(turn)};
        Vec3d value = lobe_value(surface, to_viewer, direction);
        one_way = std::fmax(one_way, std::fabs(lobe_value(surface, direction, to_viewer).y / value.y - 1));
        albedo += value.y * cosine * 2 * kPi / (kRings * kRings);
      }
    CHECK(one_way < 1e-9);
    check_equal(look_at(t, Transport::physical, {2, 1, 0}, {0, 0, 0}, 20000), albedo, 1e-3);
  }
}

// Goal: light by way of a mirror is found with and without the guide, and with less noise with it. Method: a square
// light next to a mirror, so that the point below it sees it and its image; form factors of rectangles from below a
// corner [Howell, catalogue of configuration factors, B-4].
TEST_CASE("reference_light_by_way_of_a_mirror_has_its_closed_form") {
  auto corner = [](double a, double b) {
    double p = std::sqrt(1 + a * a), q = std::sqrt(1 + b * b);
    return (a / p * std::atan(b / p) + b / q * std::atan(a / q)) / (2 * kPi);
  };
  GeneratedScene s;
  add_floor(&s);
  Material mirror = emitter(0);
  mirror.mirror = {0.75f, 0.75f, 0.75f};
  add_quad(&s, {-0.25f, 1, -0.25f}, {0.25f, 1, -0.25f}, {0.25f, 1, 0.25f}, {-0.25f, 1, 0.25f},
           add_material(&s, emitter(3)));
  add_quad(&s, {0.75f, -0.1f, -1}, {0.75f, -0.1f, 1}, {0.75f, 1.2f, 1}, {0.75f, 1.2f, -1}, add_material(&s, mirror));
  add_camera(&s);
  s.bind();
  double image = 2 * (corner(1.75, 0.25) - corner(1.25, 0.25));
  double expected = 3 * (4 * corner(0.25, 0.25) + 0.75 * image), error[2];
  for (std::uint32_t guided : {0, 1}) {
    TestReference t(s.scene, small_settings(), guided * 4000);
    Estimate e = look_at(t, Transport::physical, {-0.6, 0.5, 0.2}, {0, 0, 0}, 30000);
    check_equal(e, expected);
    error[guided] = e.error;
  }
  CHECK(error[1] < 0.6 * error[0]);
}

// Goal: a point light close under a ceiling lights a small bright spot, whose light is found with and without the
// guide, and with less noise with it. Method: one bounce, integrated over the rings of the ceiling; a light that shines
// everywhere, and a spot light that shines up.
TEST_CASE("reference_light_by_way_of_a_bright_spot_has_its_closed_form") {
  constexpr double kHeight = 2, kSide = 20, kAlbedo = 0.8;
  for (bool is_spot : {false, true}) {
    GeneratedScene s;
    add_floor(&s, static_cast<float>(kSide));
    float side = static_cast<float>(kSide), top = static_cast<float>(kHeight);
    Material ceiling = white();
    ceiling.diffuse = Vec3{1, 1, 1} * static_cast<float>(kAlbedo);
    add_quad(&s, {-side, top, -side}, {side, top, -side}, {side, top, side}, {-side, top, side},
             add_material(&s, ceiling));
    Light light;
    light.kind = is_spot ? LightKind::spot : LightKind::point;
    light.position = {0, top - 0.0625f, 0};
    light.direction = {0, 1, 0};
    light.intensity = {1, 1, 1};
    light.cos_inner = light.cos_outer = static_cast<float>(std::cos(0.75));
    s.lights.push_back(light);
    add_camera(&s);
    s.bind();
    double below = kHeight - static_cast<double>(light.position.y), sum = 0;
    double cosine = static_cast<double>(light.cos_outer);
    double reach = is_spot ? below * std::sqrt(1 - cosine * cosine) / cosine : kSide;
    constexpr int kRings = 200000;
    for (int i = 0; i < kRings; ++i) {  // rings whose radii grow geometrically: narrow in the middle
      double r = reach * std::exp(-16.0 * (kRings - i - 0.5) / kRings), width = r * 16.0 / kRings;
      double irradiance = below / std::pow(below * below + r * r, 1.5);
      double form = kHeight * kHeight / std::pow(kHeight * kHeight + r * r, 2) / kPi;
      sum += kAlbedo * irradiance * form * 2 * kPi * r * width;
    }
    double direct = is_spot ? 0 : 1 / std::pow(kHeight - below, 2), expected = (direct + sum) / kPi, error[2];
    CAPTURE(is_spot);
    for (std::uint32_t guided : {0, 1}) {
      TestReference t(s.scene, small_settings(), guided * 4000);
      Vec3d eye = {0.3, 0.4, 0.2};
      Estimate e = estimate(t, Transport::physical, eye, normalize(-eye), effort(200000), 1, 1);
      check_equal(e, expected, 2e-3);
      error[guided] = e.error;
    }
    CHECK(error[1] < 0.4 * error[0]);
  }
}

// Goal: a picture does not depend on how its rows are shared out; seeds give different pictures, whose mean is that of
// independent random numbers: even sampling introduces no bias. Method: a room with a lamp and a mirror; five standard
// errors, for ten seeds and as many independent paths.
TEST_CASE("reference_pictures_of_seeds_agree") {
  GeneratedScene s;
  Material wall, mirror = emitter(0.1f);
  wall.diffuse = {0.6f, 0.5f, 0.4f}, wall.specular = {0.2f, 0.2f, 0.2f}, wall.exponent = 12;
  mirror.mirror = {0.5f, 0.5f, 0.5f};
  add_box(&s, {-1, -1, -1}, {1, 1, 1}, add_material(&s, wall), true);
  add_box(&s, {-0.5f, 0.9f, -0.5f}, {0.5f, 0.95f, 0.5f}, add_material(&s, emitter(4)));
  add_box(&s, {-0.7f, -1, -0.7f}, {-0.2f, -0.3f, -0.1f}, add_material(&s, mirror));
  aim(&s, {0.5f, 0.1f, 0.9f}, {-0.2f, -0.2f, 0}, 60);
  s.bind();
  TestReference t(s.scene);
  for (Transport transport : kTransports) {
    ReferenceOptions o;
    o.transport = transport, o.samples_per_pixel = 8;
    std::vector<Vec3d> whole(64), parts(64);
    constexpr int kSeedCount = 10;
    double sum = 0, squares = 0, last = 0, difference2 = 0;
    std::vector<Vec3d> before(64);
    for (o.seed = 1; o.seed <= kSeedCount; ++o.seed) {
      trace_reference(t.reference, o, 0, 8, whole.data());
      double mean = 0;
      for (std::size_t i = 0; i < 64; ++i) {
        mean += whole[i].y / 64;
        difference2 += (whole[i].y - before[i].y) * (whole[i].y - before[i].y) / (64 * kSeedCount);
      }
      before = whole;
      if (o.seed == 1) difference2 = 0;
      CHECK(mean != last);
      last = mean, sum += mean, squares += mean * mean;
    }
    --o.seed;
    trace_reference(t.reference, o, 5, 8, &parts[40]);
    trace_reference(t.reference, o, 0, 1, &parts[0]);
    trace_reference(t.reference, o, 1, 5, &parts[8]);
    CHECK(parts == whole);
    double mean = sum / kSeedCount, error2 = (squares / kSeedCount - mean * mean) / (kSeedCount - 1);
    Rng rng = make_rng(99);
    const CameraRays& camera = t.renderer->renderer.frame.view.camera;
    int count = effort(20000);
    double independent = 0, independent_squares = 0;
    for (int i = 0; i < count; ++i) {
      double column = 8 * next_double(&rng);
      ReferenceRay ray = reference_camera_ray(camera, column, 8 * next_double(&rng));
      double v = sample_radiance(t.reference, o, ray.origin, ray.direction, &rng).y;
      independent += v / count, independent_squares += v * v / count;
    }
    double independent_error2 = (independent_squares - independent * independent) / count;
    CHECK(std::fabs(mean - independent) <= 5 * std::sqrt(error2 + independent_error2));
    CHECK(error2 < 0.03 * 0.03 * mean * mean);
    // Pixels of two seeds differ like independent ones: the mean's error is that of the pixels divided by eight.
    double apart = difference2 / 2 / 64 / (kSeedCount - 1);
    CHECK(error2 < 6 * apart);
    CHECK(apart < 6 * error2);
    CHECK(apart > 1e-6 * mean * mean);
  }
}
