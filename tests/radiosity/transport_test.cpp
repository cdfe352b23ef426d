// The exchange of light: HARDCASES rows 49 to 53.
#include "desktop/radiosity/transport.h"

#include <doctest/doctest.h>

#include <cmath>
#include <vector>

#include "base/fmath.h"
#include "radiosity/loose.h"
#include "scene/baked.h"
#include "scene/builtin_helpers.h"
#include "support/hard_case.h"

using namespace pocketray;

namespace {

// A closed cube's faces, by their closed forms.
FormFactors cube_factors() {
  FormFactors f;
  f.count = 6;
  f.rows.assign(36, 0);
  for (std::uint32_t i = 0; i < 6; ++i)
    for (std::uint32_t j = 0; j < 6; ++j)
      if (i != j) f.rows[i * 6 + j] = (i ^ 1) == j ? .1998248956f : .2000437760f;
  return f;
}

Exchange cube_exchange(double albedo) {
  const Vec3d grey = {albedo, albedo, albedo};
  return start_exchange(std::vector<double>(6, 4), std::vector<Vec3d>(6, grey), std::vector<Vec3d>(6, {1, 2, 3}));
}

// A unit sphere seen from inside, by subdivision of an octahedron.
void add_sphere(int levels, const Vec3& a, const Vec3& b, const Vec3& c, Loose* scene) {
  if (levels == 0) return scene->add(a, c, b);
  const Vec3 ab = normalize(a + b), bc = normalize(b + c), ca = normalize(c + a);
  add_sphere(levels - 1, a, ab, ca, scene), add_sphere(levels - 1, b, bc, ab, scene);
  add_sphere(levels - 1, c, ca, bc, scene), add_sphere(levels - 1, ab, bc, ca, scene);
}

}  // namespace

// Goal: in a closed room whose surfaces all emit Le and reflect ρ, every surface shows Le/(1 − ρ).
TEST_CASE("hard_49_furnace_exchange") {
  for (double albedo : {.5, .8, .95}) {
    Exchange e = cube_exchange(albedo);
    settle(cube_factors(), 1e-6, 100000, &e);
    for (const Vec3d& radiance : e.radiance)
      for (int axis = 0; axis < 3; ++axis) CHECK(std::fabs(radiance[axis] / (axis + 1) * (1 - albedo) - 1) < 1e-4);
  }
  count_assertions("1e-4");
}

// Goal: the whole solver keeps the furnace: the built-in one, closed but with a body in it. Light arrives everywhere
// with Le/(1 − ρ) = 1, that of its own material included.
TEST_CASE("hard_49_furnace_solved") {
  auto built = build_builtin("furnace");
  RadiositySolution solution;
  REQUIRE(solve(built->scene, 300, &solution).ok);
  CHECK(solution.nodes.size() > 300);
  for (const RadiosityNode& node : solution.nodes)
    for (int axis = 0; axis < 3; ++axis) CHECK(std::fabs(node.value[axis] - 1) < 1e-3f);
  count_assertions("1e-3, of which 1e-4 is left unshot");
}

// Goal: a point light of intensity π in the middle of a unit sphere with ρ = .5: reflected light arrives with
// radiance 1.
TEST_CASE("hard_50_point_light_in_a_sphere") {
  Loose sphere;
  const Vec3 x = {1, 0, 0}, y = {0, 1, 0}, z = {0, 0, 1};
  for (int octant = 0; octant < 8; ++octant) {
    const Vec3 a = octant & 1 ? -x : x, b = octant & 2 ? -y : y, c = octant & 4 ? -z : z;
    const bool turned = (octant & 1) ^ (octant >> 1 & 1) ^ (octant >> 2 & 1);
    add_sphere(4, a, turned ? c : b, turned ? b : c, &sphere);
  }
  sphere.materials.resize(1);
  sphere.materials[0].diffuse = {.5f, .5f, .5f};
  sphere.materials[0].double_sided = 0;
  sphere.lights.resize(1);
  sphere.lights[0].intensity = {kPiF, kPiF, kPiF};
  RadiositySolution solution;
  REQUIRE(solve(sphere.bind(), 400, &solution).ok);
  REQUIRE(!solution.values.empty());
  double sum = 0;
  for (const Vec3& value : solution.values) {
    sum += static_cast<double>(value.x);
    CHECK(std::fabs(value.x - 1) < .02f);
  }
  CHECK(std::fabs(sum / static_cast<double>(solution.values.size()) - 1) < .004);  // of which .002 is the tessellation
  count_assertions("mean .004, each .02");
}

// Goal: without reflectance there is no indirect light; a reflectance beyond 1 or below 0 is refused.
TEST_CASE("hard_51_reflectance_none_and_impossible") {
  Exchange e = cube_exchange(0);
  settle(cube_factors(), 1e-6, 1000, &e);
  for (const Vec3d& radiance : e.radiance) CHECK((radiance == Vec3d{1, 2, 3}));
  Loose loose;
  loose.add({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  loose.materials.resize(1);
  CHECK(validate_scene(loose.bind()).ok);
  for (float albedo : {1.001f, -.001f}) {
    loose.materials[0].diffuse = {albedo, .5f, .5f};
    CHECK_FALSE(validate_scene(loose.bind()).ok);
  }
  count_assertions("exact");
}

// Goal: no light is lost or made: emitted = absorbed + escaped + unshot after every shot, with overshooting and
// without; without it, the unshot part falls with every shot.
TEST_CASE("hard_52_energy_is_kept_at_every_shot") {
  FormFactors factors = cube_factors();
  for (bool open : {false, true}) {
    if (open)
      for (std::uint32_t i = 0; i < 36; ++i)
        if (i / 6 == 5 || i % 6 == 5) factors.rows[i] = 0;  // a face is missing
    for (bool overshooting : {false, true}) {
      Exchange e = cube_exchange(.7);
      for (int i = 0; i < 200; ++i) {
        const double before = unshot_magnitude(e);
        shoot(factors, overshooting, &e);
        CHECK(std::fabs(e.absorbed + e.escaped + unshot_energy(e) - e.emitted) < 1e-5 * e.emitted);
        if (!overshooting) CHECK((unshot_magnitude(e) < before || before < 1e-12));
      }
      CHECK(unshot_magnitude(e) < 1e-4 * e.emitted);
      CHECK((e.escaped > .1 * e.emitted) == open);
    }
  }
  count_assertions("1e-5 of the emitted light");
}

// Goal: triangles without area, and a patch that sees nothing else, make no NaN.
TEST_CASE("hard_53_degenerate_and_isolated_patches") {
  Loose loose;
  loose.materials.resize(1);
  loose.lights.resize(1);
  loose.lights[0].position = {.2f, .3f, 1};
  loose.add({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  loose.add({0, 0, 0}, {0, 0, 0}, {0, 0, 0});
  loose.add({0, 0, 0}, {1, 1, 1}, {2, 2, 2});
  RadiositySolution solution;
  REQUIRE(solve(loose.bind(), 10, &solution).ok);
  for (const RadiosityNode& n : solution.nodes)
    CHECK((is_finite(n.value) && is_finite(n.ds) && is_finite(n.dt) && is_finite(n.dst)));
  for (const Vec3& value : solution.values) CHECK(is_finite(value));
  CHECK(solution.bytes() > 0);
  Loose nothing;
  nothing.materials.resize(1);
  nothing.lights.resize(1);
  nothing.add({0, 0, 0}, {0, 0, 0}, {0, 0, 0});
  CHECK_FALSE(solve(nothing.bind(), 10, &solution).ok);
  count_assertions("finite");
}

// Goal: the number of threads does not change a bit of a solution, and a stored one is read back.
TEST_CASE("radiosity_does_not_depend_on_threads_and_is_stored") {
  auto built = build_builtin("cube");
  Settings settings;
  settings.width = settings.height = 4, settings.indirect = IndirectChoice::none;
  auto test = make_renderer(built->scene, settings);
  RadiositySolution solutions[2];
  for (int i = 0; i < 2; ++i) {
    RadiosityOptions options;
    options.patch_count = 60, options.threads = i ? 3 : 1;
    REQUIRE(solve_radiosity(
                test->renderer.frame, options, [](double) { return true; }, &solutions[i])
                .ok);
    solutions[i].view(&built->scene);
    REQUIRE(validate_scene(built->scene).ok);
  }
  REQUIRE(solutions[0].nodes.size() == solutions[1].nodes.size());
  for (std::size_t i = 0; i < solutions[0].nodes.size(); ++i) {
    CHECK(solutions[0].nodes[i].value == solutions[1].nodes[i].value);
    CHECK(solutions[0].nodes[i].dst == solutions[1].nodes[i].dst);
  }
  int calls = 0;
  CHECK_FALSE(solve_radiosity(
                  test->renderer.frame, {}, [&](double) { return ++calls < 3; }, &solutions[0])
                  .ok);
}

// Goal: surfaces reflect what their textures show, by either set of texture coordinates. Method: textures of the second
// set, and the same coordinates as the first: equal solutions; those of the other coordinates differ.
TEST_CASE("radiosity_reads_textures_by_their_set") {
  RadiositySolution solutions[3];
  for (int i = 0; i < 3; ++i) {
    auto s = generate_scene(
        bit(Feature::texture) | bit(Feature::metallic_roughness) | bit(Feature::point_light) | bit(Feature::emission),
        3);
    if (i == 0)
      for (Texture& texture : s->textures) texture.uv_set = 1;
    if (i == 1) s->uvs = s->second_uvs;
    s->with_second_uvs = i == 0;
    s->bind();
    REQUIRE(validate_scene(s->scene).ok);
    REQUIRE(solve(s->scene, 60, &solutions[i]).ok);
  }
  REQUIRE(!solutions[0].nodes.empty());
  REQUIRE(solutions[0].nodes.size() == solutions[1].nodes.size());
  bool differs = solutions[0].nodes.size() != solutions[2].nodes.size();
  for (std::size_t i = 0; i < solutions[0].nodes.size(); ++i) {
    CHECK(solutions[0].nodes[i].value == solutions[1].nodes[i].value);
    differs = differs || !(solutions[0].nodes[i].value == solutions[2].nodes[i].value);
  }
  CHECK(differs);
}
