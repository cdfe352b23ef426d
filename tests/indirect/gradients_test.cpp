// Gradients at the corners of triangles, and the light that quadratic and cubic reconstruction make of them.
#include "indirect/reconstruct/gradients.h"

#include <doctest/doctest.h>

#include <cmath>
#include <functional>
#include <vector>

#include "base/rng.h"
#include "effect/setting_list.h"
#include "engine/frame.h"
#include "indirect/radiosity.h"
#include "support/generated_scene.h"

using namespace pocketray;

namespace {

using Function = std::function<float(const Vec3& p)>;
using R = Reconstruction;

// Triangles that store a value at each of their vertices.
struct Mesh {
  std::vector<Vec3> positions, values;
  std::vector<Triangle> triangles;
  std::vector<std::uint32_t> places;
  std::vector<RadiosityCorners> corners;
  std::vector<RadiositySplit> splits;
  std::vector<std::uint8_t> memory;
  std::vector<Material> materials;
  std::vector<RadiosityInfo> info = {{{1e6f, 1e6f, 1e6f}}};
  Scene scene;
  const RadiosityGradient* gradients = nullptr;

  std::uint32_t add(const Vec3& p, float value) {
    positions.push_back(p), values.push_back(Vec3{1, .5f, .25f} * value);
    return static_cast<std::uint32_t>(positions.size() - 1);
  }
  void triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    triangles.push_back(Triangle(a, b, c, 0)), places.push_back(kRadiosityAtVertices);
  }
  void finish() {
    auto view = [](const auto& v) {
      return Array<const std::decay_t<decltype(v[0])>>{v.data(), static_cast<std::uint32_t>(v.size())};
    };
    materials.resize(1), materials[0].diffuse = {1, 1, 1};
    scene.materials = view(materials), scene.positions = view(positions), scene.triangles = view(triangles);
    scene.radiosity_info = view(info), scene.radiosity_triangles = view(places), scene.radiosity_values = view(values);
    scene.radiosity_corners = view(corners), scene.radiosity_splits = view(splits);
    memory.resize(gradients_need(scene) + gradients_scratch_need(scene) + 2 * kArenaAlignment);
    Arena keep = make_arena("keep", memory.data(), gradients_need(scene) + kArenaAlignment);
    Arena scratch = make_arena("scratch", memory.data() + gradients_need(scene) + kArenaAlignment,
                               gradients_scratch_need(scene) + kArenaAlignment);
    gradients = set_gradients(scene, &keep, &scratch);
    CHECK(scratch.used == 0);
  }
  float at(std::uint32_t triangle, float u, float v, R how) const {
    const Vec3 any = {0, 0, 0};
    return RadiosityIndirect::radiance({scene, gradients, any, any, materials[0].diffuse, triangle, u, v, true, how}).x;
  }
  Vec3 place(std::uint32_t triangle, float u, float v) const {
    const Triangle& t = triangles[triangle];
    return positions[t.vertex(0)] * (1 - u - v) + positions[t.vertex(1)] * u + positions[t.vertex(2)] * v;
  }
};

// side × side cells of a unit, halved; vertices off by up to `off`, lifted to z = lift·x so that no axis is its normal.
Mesh sheet(std::uint32_t side, float off, float lift, const Function& f) {
  Mesh mesh;
  Rng rng = make_rng(7);
  for (std::uint32_t y = 0; y <= side; ++y)
    for (std::uint32_t x = 0; x <= side; ++x) {
      auto moved = [&](std::uint32_t i) { return static_cast<float>(i) + off * (2 * next_float(&rng) - 1); };
      Vec3 p = {moved(x), moved(y), 0};
      p.z = lift * p.x;
      mesh.add(p, f(p));
    }
  for (std::uint32_t y = 0; y < side; ++y)
    for (std::uint32_t x = 0; x < side; ++x) {
      const std::uint32_t a = y * (side + 1) + x, b = a + 1, c = a + side + 1, d = c + 1;
      mesh.triangle(a, b, d), mesh.triangle(a, d, c);
    }
  mesh.finish();
  return mesh;
}

template <class Visit>
void each_place(const Mesh& mesh, const Visit& visit) {
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
    for (float u = 0; u <= 1; u += .125f)
      for (float v = 0; u + v <= 1; v += .125f) visit(t, u, v);
}

}  // namespace

// Goal: planes are reproduced on any sheet; parabolas inside a regular one, and about so at its border, where linear
// light errs by as much as .375.
TEST_CASE("gradients_of_planes_and_parabolas_are_found") {
  const Function plane = [](const Vec3& p) { return 3 + .5f * p.x - .25f * p.y; };
  for (float lift : {0.f, .75f}) {
    const Mesh mesh = sheet(5, .3f, lift, plane);
    for (R how : {R::bilinear, R::bicubic, R::quadratic, R::cubic})
      each_place(mesh, [&](std::uint32_t t, float u, float v) {
        CHECK(std::fabs(mesh.at(t, u, v, how) - plane(mesh.place(t, u, v))) < 2e-5f);
      });
  }
  const Function rising = [](const Vec3& p) { return 1 + p.x * p.x + .5f * p.y * p.y; };
  const Mesh mesh = sheet(6, 0, 0, rising);
  for (R how : {R::quadratic, R::cubic})
    each_place(mesh, [&](std::uint32_t t, float u, float v) {
      const Vec3 p = mesh.place(t, u, v);
      const bool inside = p.x >= 1 && p.x <= 5 && p.y >= 1 && p.y <= 5;
      CHECK(std::fabs(mesh.at(t, u, v, how) - rising(p)) < (inside ? 5e-5f : .2f));
    });
  // Steps of 1 and 2: about the parabola through three points, whose slope is 4; the mean of the slopes is 3.5.
  Mesh strip;
  for (float x : {0.f, 1.f, 3.f})
    for (float y : {0.f, 1.f, 2.f}) strip.add({x, y, 0}, 10 - (x - 3) * (x - 3));
  for (std::uint32_t i : {0u, 1u, 3u, 4u}) strip.triangle(i, i + 3, i + 4), strip.triangle(i, i + 4, i + 1);
  strip.finish();
  CHECK(std::fabs(strip.gradients[4].dx.x - 4) < .25f);
  // At the least value, too, where rounding leaves a slope along the border.
  CHECK(std::fabs(strip.gradients[1].dx.x - 6) < .25f);
}

// Goal: reconstructions differ where light bends: smooth ones are nearer to it. Method: the error over a sheet of a
// wave.
TEST_CASE("gradients_bring_light_nearer_to_the_truth") {
  const Function wave = [](const Vec3& p) { return 2 + std::sin(p.x * .8f) + std::cos(p.y * .7f); };
  const Mesh mesh = sheet(8, .2f, .5f, wave);
  auto error_of = [&](R how) {
    double sum = 0;
    each_place(mesh, [&](std::uint32_t t, float u, float v) {
      const double off = static_cast<double>(mesh.at(t, u, v, how) - wave(mesh.place(t, u, v)));
      sum += off * off;
    });
    return std::sqrt(sum);
  };
  const double linear = error_of(R::bicubic), quadratic = error_of(R::quadratic), cubic = error_of(R::cubic);
  MESSAGE("linear, quadratic, cubic: ", linear, ", ", quadratic, ", ", cubic);
  CHECK(error_of(R::bilinear) == linear);
  CHECK(error_of(R::constant) > 2 * linear);
  CHECK(quadratic < .5 * linear);
  CHECK(cubic < .5 * linear);
  CHECK(cubic != quadratic);
}

// Goal: light stays between the least and the largest value around; at a step it does not overshoot. Method: random
// values, many of them 0, in a regular sheet, against those of the triangle's corners and their neighbours.
TEST_CASE("gradients_are_limited_to_the_range_of_the_values") {
  Rng rng = make_rng(3);
  const Function random = [&](const Vec3&) { return next_u32(&rng) % 3 ? next_float(&rng) : 0.f; };
  for (int i = 0; i < 20; ++i) {
    const Mesh mesh = sheet(5, 0, .5f, random);
    for (R how : {R::quadratic, R::cubic})
      for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
        float low = 1e9f, high = 0;
        const float slack = 1e-3f;
        for (std::uint32_t n = 0; n < mesh.triangles.size(); ++n) {
          bool touches = false;
          for (std::uint32_t a : mesh.triangles[t].vertices())
            for (std::uint32_t b : mesh.triangles[n].vertices()) touches |= a == b;
          for (std::uint32_t v : mesh.triangles[n].vertices())
            if (touches) low = std::min(low, mesh.values[v].x), high = std::max(high, mesh.values[v].x);
        }
        for (float u = 0; u <= 1; u += .125f)
          for (float v = 0; u + v <= 1; v += .125f) {
            const float x = mesh.at(t, u, v, how);
            CHECK((x >= low - slack && x <= high + slack));
          }
      }
  }
}

// Goal: corners that do not share a value have gradients of their own, so a crease of the surface stays one of light.
// Method: two sheets that meet in an edge, with values of one of them raised; the other's light is what it is alone.
TEST_CASE("gradients_do_not_cross_discontinuities") {
  auto build = [](bool both) {
    Mesh mesh;
    auto half = [&](float x, float step) {
      const std::uint32_t a = mesh.add({x, 0, 0}, 1), b = mesh.add({x + step, 0, 0}, 3), c = mesh.add({x, 1, 0}, 2);
      step > 0 ? mesh.triangle(a, b, c) : mesh.triangle(a, c, b);
    };
    half(0, 1);
    if (both) half(0, -1);
    mesh.finish();
    return mesh;
  };
  const Mesh alone = build(false), both = build(true);
  for (int i = 0; i < 3; ++i) CHECK(both.gradients[i].dx == alone.gradients[i].dx);
  CHECK(both.gradients[3].dx.x == -alone.gradients[0].dx.x);
  for (R how : {R::quadratic, R::cubic}) CHECK(both.at(0, 0, .5f, how) == alone.at(0, 0, .5f, how));
}

// Goal: parts of a divided triangle have the light of the same triangles undivided. Method: a triangle halved on two of
// its edges, with values of its own, against three triangles with values at their vertices.
TEST_CASE("gradients_follow_the_parts_of_divided_triangles") {
  const Vec3 p[5] = {{0, 0, 0}, {2, 0, 1}, {0, 3, 0}, {1, 1.5f, .5f}, {1, 0, .5f}};  // A, B, C, middles of BC, AB
  const float values[5] = {1, 2, 4, 7, 1.5f};
  const std::uint32_t parts[3][3] = {{0, 4, 3}, {4, 1, 3}, {3, 2, 0}}, turn = kRadiosityTurnShift;
  Mesh whole, divided;
  for (int i = 0; i < 5; ++i) whole.add(p[i], values[i]), divided.add(p[i], values[i]);
  for (const auto& part : parts) {
    whole.triangle(part[0], part[1], part[2]);
    divided.corners.push_back({{part[0], part[1], part[2]}});
  }
  divided.triangle(0, 1, 2);
  divided.places[0] = kRadiositySplitBit | 1u << turn;
  divided.splits = {{{kRadiositySplitBit | 2u << turn | 1, 2}}, {{0u | 1u << kRadiosityLevelShift, 1}}};
  whole.finish(), divided.finish();
  for (int i = 0; i < 5; ++i) {
    CHECK(divided.gradients[i].dx == whole.gradients[i].dx);
    CHECK(divided.gradients[i].dy == whole.gradients[i].dy);
    CHECK(divided.gradients[i].dz == whole.gradients[i].dz);
  }
  int found = 0;
  for (R how : {R::quadratic, R::cubic})
    for (std::uint32_t t = 0; t < 3; ++t)
      for (float u = .0625f; u < 1; u += .125f)
        for (float v = .0625f; u + v < 1; v += .125f) {
          const Vec3 at = whole.place(t, u, v);
          const float y = at.y / 3, x = at.x / 2;  // barycentric in ABC
          CHECK(divided.at(0, x, y, how) == doctest::Approx(static_cast<double>(whole.at(t, u, v, how))).epsilon(1e-5));
          ++found;
        }
  CHECK(found > 100);
}

// Goal: meshes without area, far too bright or with huge ratios give finite light, and files whose splits share parts
// are read in time.
TEST_CASE("gradients_of_hostile_meshes_are_finite") {
  Mesh mesh;
  const std::uint32_t a = mesh.add({0, 0, 0}, 0), b = mesh.add({0, 0, 0}, 1e6f), c = mesh.add({1e-30f, 0, 0}, 5),
                      d = mesh.add({1e18f, 0, 0}, 0), e = mesh.add({1e18f, 1e18f, 1}, 1e6f);
  mesh.triangle(a, b, c), mesh.triangle(a, c, d), mesh.triangle(c, d, e), mesh.triangle(a, a, a);
  mesh.finish();
  for (std::uint32_t i = 0; i < mesh.values.size(); ++i)
    CHECK((is_finite(mesh.gradients[i].dx) && is_finite(mesh.gradients[i].dy) && is_finite(mesh.gradients[i].dz)));
  for (R how : {R::quadratic, R::cubic})
    each_place(mesh, [&](std::uint32_t t, float u, float v) {
      const float x = mesh.at(t, u, v, how);
      CHECK((x >= 0 && x <= 1e6f));
    });
  Mesh deep;
  deep.triangle(deep.add({0, 0, 0}, 1), deep.add({1, 0, 0}, 2), deep.add({0, 1, 0}, 3));
  deep.corners = {{{0, 1, 2}}};
  deep.places[0] = kRadiositySplitBit;
  for (std::uint32_t level = 0; level <= kRadiosityLevelMax; ++level) {  // 2³² parts
    const std::uint32_t part = level < kRadiosityLevelMax ? kRadiositySplitBit | (level + 1) : 0;
    deep.splits.push_back({{part | level << kRadiosityLevelShift, part}});
  }
  deep.finish();
  CHECK(deep.at(0, .25f, .25f, R::cubic) >= 0);
}

// Goal: both elements on a grid's cells: quadratics are reproduced, and halves and cells meet without a jump in value
// or slope. Method: two cells of random light; one-sided slopes that are exact for cubics.
TEST_CASE("cells_of_grids_are_two_triangles") {
  Rng rng = make_rng(5);
  auto grey = [](float x) { return Vec3{x, x, x}; };
  std::vector<RadiosityNode> bent, random;  // two rows of three nodes
  for (int i = 0; i < 6; ++i) {
    const float s = static_cast<float>(i % 3), t = static_cast<float>(i / 3);
    auto any = [&] { return grey(2 * next_float(&rng) - 1); };
    bent.push_back({grey(1 + s * s - s * t + 2 * t * t), grey(2 * s - t), grey(4 * t - s), grey(0)});
    random.push_back({any(), any(), any(), any()});
  }
  for (R how : {R::quadratic, R::cubic}) {
    auto in_cell = [&](const std::vector<RadiosityNode>& n, std::size_t cell, float s, float t) {
      return smooth_cell({&n[cell], &n[cell + 1], &n[cell + 3], &n[cell + 4]}, s, t, how).x;
    };
    for (float s = 0; s <= 1; s += .125f)
      for (float t = 0; t <= 1; t += .125f)
        CHECK(std::fabs(in_cell(bent, 0, s, t) - (1 + s * s - s * t + 2 * t * t)) < 2e-6f);
    constexpr float kStep = 1.f / 256;
    auto slope = [](auto at) { return (18 * at(kStep) - 9 * at(2 * kStep) + 2 * at(3 * kStep) - 11 * at(0)) / 6; };
    for (float x : {.2f, .3f, .5f, .8f}) {
      CHECK(std::fabs(in_cell(random, 0, x + 1e-6f, x) - in_cell(random, 0, x, x + 1e-6f)) < 2e-5f);
      const float below = slope([&](float way) { return in_cell(random, 0, x + way, x - way); }),
                  above = slope([&](float way) { return in_cell(random, 0, x - way, x + way); });
      CHECK(std::fabs(below + above) < .02f * kStep);
      CHECK(std::fabs(in_cell(random, 0, 1, x) - in_cell(random, 1, 0, x)) < 2e-5f);
      const float before = slope([&](float way) { return in_cell(random, 0, 1 - way, x); }),
                  after = slope([&](float way) { return in_cell(random, 1, way, x); });
      CHECK(std::fabs(before + after) < .02f * kStep);
    }
  }
}

// Goal: memory for gradients is planned where they are asked for and nowhere else; frames cannot ask for them later.
TEST_CASE("gradients_are_planned_on_request") {
  Mesh mesh = sheet(3, 0, 0, [](const Vec3& p) { return 1 + p.x * p.x; });
  Light dark;  // no default lights
  dark.position = {0, 0, -1}, mesh.scene.lights = {&dark, 1};
  Settings settings;
  settings.width = settings.height = 4, settings.indirect = indirect_choice(Effect::radiosity);
  auto linear = make_renderer(mesh.scene, settings);
  CHECK(linear->renderer.frame.indirect.prepared[2] == nullptr);
  CHECK(indirect_need(mesh.scene, settings, kAllEffects & ~bit(Effect::instant_radiosity)).keep == 0);
  settings.reconstruction = R::cubic;
  const Status refused = change_settings(&linear->renderer, settings);
  CHECK_FALSE(refused.ok);
  auto smooth = make_renderer(mesh.scene, settings);
  REQUIRE(begin_frame(&smooth->renderer, {0}).ok);
  const float seen = trace_ray(smooth->renderer, {.6f, .3f, 1}, {0, 0, -1}).x;
  CHECK(seen == mesh.at(0, .3f, .3f, R::cubic));
  settings.reconstruction = R::quadratic;
  CHECK(change_settings(&smooth->renderer, settings).ok);
  settings.reconstruction = R::bicubic;
  CHECK(change_settings(&smooth->renderer, settings).ok);
  // Other methods may turn to it between frames, if it is not switched off.
  settings.indirect = IndirectChoice::none, settings.reconstruction = R::cubic;
  auto turned = make_renderer(mesh.scene, settings);
  CHECK_FALSE(has(turned->renderer.effects.mask, Effect::radiosity));
  settings.indirect = indirect_choice(Effect::radiosity);
  REQUIRE(change_settings(&turned->renderer, settings).ok);
  REQUIRE(begin_frame(&turned->renderer, {0}).ok);
  CHECK(trace_ray(turned->renderer, {.6f, .3f, 1}, {0, 0, -1}).x == seen);
  settings.indirect = IndirectChoice::none, settings.forced_off = bit(Effect::radiosity);
  CHECK(make_renderer(mesh.scene, settings)->renderer.frame.indirect.prepared[2] == nullptr);
  settings.forced_off = 0, settings.indirect = indirect_choice(Effect::radiosity);
  // A scene without such triangles takes nothing.
  Scene plain = mesh.scene;
  plain.radiosity_values = {}, plain.radiosity_triangles = {}, plain.radiosity_info = {};
  settings.reconstruction = R::cubic;
  CHECK(indirect_need(plain, settings, bit(Effect::radiosity)).keep == 0);
}
