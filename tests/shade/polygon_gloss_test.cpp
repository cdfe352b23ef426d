// Highlights of flat lamps in closed form, against sums of the lobe's value over fine grids of the lamp.
#include <doctest/doctest.h>

#include <cmath>
#include <cstring>
#include <string>

#include "brdf/linear_lobe_fit.h"
#include "shade/polygon_light.h"
#include "shade/polygon_share.h"
#include "shade/shade_helpers.h"
#include "support/effort.h"

using namespace pocketray;

namespace {

constexpr float kRadiance = 8;

Material lamp() {
  Material m = matte(0);
  m.emission = {kRadiance, kRadiance, kRadiance};
  return m;
}

// Of width α in either lobe's measure.
Material polished(std::uint32_t brdf, double alpha, float diffuse = 0) {
  Material m = white_lobe(brdf, alpha);
  m.diffuse = {diffuse, diffuse, diffuse}, m.specular = {0.5f, 0.5f, 0.5f}, m.grazing = 0.5f;
  return m;
}

Settings settings_of(std::uint32_t points, AreaIrradiance form = AreaIrradiance::analytic) {
  Settings settings;
  settings.width = 32, settings.height = 24;
  settings.points_per_area_light = points;
  settings.cut_off_levels = 0;
  settings.area_irradiance = form;
  return settings;
}

// A floor, and a square lamp of side 2 that stands beyond it and leans over, perhaps with a board before its left half.
const Vec3 kLampCorners[4] = {{-1, 2, 0.3f}, {1, 2, 0.3f}, {1, 1.5f, 2}, {-1, 1.5f, 2}};
std::unique_ptr<GeneratedScene> lamp_scene(const Material& floor, bool with_board = false) {
  auto s = std::make_unique<GeneratedScene>();
  add_sheet(s.get(), 0, add_material(s.get(), floor));
  add_quad(s.get(), kLampCorners[0], kLampCorners[1], kLampCorners[2], kLampCorners[3], add_material(s.get(), lamp()));
  if (with_board)
    add_quad(s.get(), {-4, 1.2f, -1}, {0.1f, 1.2f, -1}, {0.1f, 1.2f, 5}, {-4, 1.2f, 5},
             add_material(s.get(), matte(0)));
  aim(s.get(), {0.3f, -3, 1.5f}, {0, 0.2f, 0}, 55);
  s->bind();
  return s;
}

// The light that leaves the floor at a point: the lobe's value, summed over the lamp; what the board hides is left out.
double summed(const Material& floor, const Vec3d& point, const Vec3d& eye, bool with_board = false) {
  constexpr int kSide = kEffortDivisor > 1 ? 100 : 300;
  const Vec3d a = to_double(kLampCorners[0]), across = to_double(kLampCorners[1]) - a,
              up = to_double(kLampCorners[3]) - a, area = cross(across, up);
  const LobeFrameD frame = {{0, 0, 1}, {0, 0, 0}};
  const Vec3d to_viewer = normalize(eye - point), diffuse = to_double(floor.diffuse) * (1 / kPiD);
  double sum = 0;
  for (int i = 0; i < kSide; ++i)
    for (int j = 0; j < kSide; ++j) {
      const Vec3d to = a + across * ((i + 0.5) / kSide) + up * ((j + 0.5) / kSide) - point;
      if (with_board && point.x + to.x * ((1.2 - point.y) / to.y) < 0.1) continue;
      const double square = dot(to, to);
      const Vec3d l = to / std::sqrt(square);
      sum += kBrdfList[floor.brdf]->exact_value(floor, to_double(floor.specular), diffuse, frame, to_viewer, l).x *
             l.z * std::fabs(dot(area, l)) / square;
    }
  return sum * static_cast<double>(kRadiance) / (kSide * kSide);
}

struct Errors {
  double mean = 0, worst = 0;
  void add(double off, int count) { mean += std::fabs(off) / count, worst = std::fmax(worst, std::fabs(off)); }
};

}  // namespace

// Goal: a highlight is that of the lobe but for the light that its form misplaces, whatever the number of points; four
// points, on sharp lobes, are far from it. Method: radiances of a floor against sums over 90,000 points, or 10,000, at
// viewing angles up to 75°.
TEST_CASE("polygon_gloss_is_the_lobe_summed_over_the_lamp") {
  for (std::uint32_t brdf : {kGgx, kPhong})
    for (double alpha : {0.05, 0.12, 0.3, 0.5}) {
      const Material floor = polished(brdf, alpha, 0.2f);
      Errors closed, single, points;
      constexpr int kViews = 12;
      auto s = lamp_scene(floor);
      auto four = ray_renderer(s.get(), 1, 4), one = ray_renderer(s.get(), 1, 1);
      Settings settings = four->renderer.settings;
      settings.area_irradiance = AreaIrradiance::points;
      auto sum_of_four = make_renderer(s->scene, settings);
      for (int i = 0; i < kViews; ++i) {
        const Vec3 eye = {0.2f, -3, 0.8f + 0.2f * static_cast<float>(i)},
                   at = {0.07f * static_cast<float>(i), 0.15f, 0};
        const double exact = summed(floor, to_double(at), to_double(eye));
        closed.add(static_cast<double>(look(*four, eye, at).x) - exact, kViews);
        single.add(static_cast<double>(look(*one, eye, at).x) - exact, kViews);
        points.add(static_cast<double>(look(*sum_of_four, eye, at).x) - exact, kViews);
      }
      CAPTURE(brdf);
      CAPTURE(alpha);
      MESSAGE(std::string(kBrdfList[brdf]->name), " ", alpha, ": error ", closed.mean, ", at most ", closed.worst,
              "; of one point ", single.mean, ", of four summed ", points.mean);
      const double reflected = 0.5 * static_cast<double>(kRadiance);
      CHECK(closed.worst < (brdf == kGgx ? 0.12 : 0.05) * reflected);
      CHECK(single.worst < (brdf == kGgx ? 0.13 : 0.06) * reflected);
      if (alpha < 0.2) CHECK(closed.mean < 0.2 * points.mean);
    }
}

// Goal: the closed form is that of the distribution. Method: against its density summed over polygons that stand about
// the reflection, cross the horizon, and are small and large; as float, too.
TEST_CASE("polygon_gloss_is_the_share_of_the_distribution") {
  Rng rng = make_rng(4);
  auto centred = [&] { return next_double(&rng) - 0.5; };
  double worst = 0, worst_float = 0;
  int cut = 0;
  for (int i = 0; i < effort(300); ++i) {
    const std::uint32_t brdf = i % 2 ? kGgx : kPhong, power = kBrdfList[brdf]->linear->power;
    const double c = next_double(&rng), s = std::sqrt(1 - c * c);
    const Material m = white_lobe(brdf, 0.06 + 0.4 * next_double(&rng));
    LobePartsD parts;
    REQUIRE(
        kBrdfList[brdf]->linear->divide_exactly(m, {1, 1, 1}, {0, 0, 0}, {{0, 0, 1}, {0, 0, 0}}, {-s, 0, c}, &parts));
    const Vec3d middle = normalize(Vec3d{s + 0.3 * centred(), 0.3 * centred(), c + 0.3 * centred()});
    Vec3d t, b;
    make_basis(normalize(middle + Vec3d{centred(), centred(), centred()}), &t, &b);
    const double size = std::exp2(-3 + 5 * next_double(&rng));
    t = t * size, b = b * size;
    const Vec3d corners[4] = {middle + t + b, middle - t + b, middle - t - b, middle + t - b};
    double lowest = 1, sum = 0;
    for (const Vec3d& p : corners) lowest = std::fmin(lowest, p.z);
    cut += lowest < 0;
    constexpr int kSide = 500;
    const Vec3d area = cross(t, b) * 4.0;
    for (int x = 0; x < kSide; ++x)
      for (int y = 0; y < kSide; ++y) {
        const Vec3d p = middle + t * ((2 * x + 1.0) / kSide - 1) + b * ((2 * y + 1.0) / kSide - 1);
        if (!(p.z > 0)) continue;
        const double square = dot(p, p);
        const Vec3d l = p / std::sqrt(square);
        sum += linear_density(parts, power, l) * std::fabs(dot(area, l)) / square / (double(kSide) * kSide);
      }
    const double share = linear_share(parts, power, corners, 4, Vec3d{0, 0, 1});
    worst = std::fmax(worst, std::fabs(share - sum));
    LobeParts rounded;
    rounded.x = to_float(parts.x), rounded.y = to_float(parts.y), rounded.z = to_float(parts.z);
    Vec3 near[4];
    for (int k = 0; k < 4; ++k) near[k] = to_float(corners[k]);
    worst_float = std::fmax(
        worst_float, std::fabs(static_cast<double>(linear_share(rounded, power, near, 4, Vec3{0, 0, 1})) - share));
  }
  MESSAGE("off a sum by ", worst, ", as float by ", worst_float);
  CHECK(cut > effort(30));
  CHECK(worst < 1e-3);
  CHECK(worst_float < 5e-6);
}

// Goal: a lamp that fills the hemisphere gives what the lobe has above the horizon; extreme places give shares from 0
// to
// 1. Method: close under a square and beside it, on its corners, edges and plane, far away; lobes of all widths.
TEST_CASE("hard_polygon_gloss_in_extreme_places") {
  LightPolygon p = {};
  p.corner_count = 4, p.scale = 0.25f, p.margin = 0x1p-9f, p.normal = {0, 0, -1};
  const Vec3 corners[4] = {{-1, 1, 1}, {1, 1, 1}, {1, -1, 1}, {-1, -1, 1}};
  std::memcpy(p.corners, corners, sizeof corners);
  for (std::uint32_t brdf : {kGgx, kPhong})
    for (double alpha : {0.001, 0.0015, 0.01, 0.1, 0.5, 1.0})
      for (float c : {1.0f, 0.99999994f, 0.7f, 0.2f, 0.01f, 1e-4f}) {
        if (brdf == kPhong && alpha > 0.5) continue;
        const Material m = white_lobe(brdf, alpha);
        const LinearForm& form = *kBrdfList[brdf]->linear;
        Surface s = {};
        LobeParts parts;
        CAPTURE(brdf);
        CAPTURE(alpha);
        CAPTURE(c);
        for (const Vec3& normal : {Vec3{0, 0, 1}, Vec3{1, 0, 0}, Vec3{0, 0, -1}, normalize(Vec3{1, 1, 1e-7f})})
          for (float z : {1.0f, std::nextafterf(1.0f, 0.0f), 0.999f, 0.0f, -1e-30f, -40.0f})
            for (float x : {0.0f, 1.0f, -1.0f, 0.5f, 1.5f, 1e-30f, 30.0f}) {
              s.point = {x, x, z}, s.normal = s.geometric = normal;
              Vec3 across, along;
              make_basis(normal, &across, &along);
              const Vec3 viewer = normalize(normal * c + across * std::sqrt(1 - c * c));
              if (!form.divide(m, m.specular, {0, 0, 0}, s, viewer, &parts)) continue;
              const float share = lobe_share(p, s, form, parts);
              CHECK(share >= 0);
              CHECK(share <= 1);
            }
        if (c < 0.2f) continue;
        s.point = {0, 0, std::nextafterf(1.0f, 0.0f)}, s.normal = s.geometric = {0, 0, 1};
        REQUIRE(form.divide(m, m.specular, {0, 0, 0}, s, normalize(Vec3{-std::sqrt(1 - c * c), 0, c}), &parts));
        LobePartsD exact;
        exact.x = to_double(parts.x), exact.y = to_double(parts.y), exact.z = to_double(parts.z);
        CHECK(static_cast<double>(lobe_share(p, s, form, parts)) ==
              doctest::Approx(share_above_horizon(exact, form.power)).epsilon(1e-4));
      }
}

// Goal: highlights change without steps: as a lamp sets behind a horizon, and as the viewer passes from entry to entry
// of the table. Method: a glossy wall turned in small steps; a viewer that sinks from the normal to the horizon.
TEST_CASE("polygon_gloss_changes_without_a_step") {
  for (std::uint32_t brdf : {kGgx, kPhong})
    for (std::uint32_t points : {1u, 4u}) {
      CAPTURE(brdf);
      CAPTURE(points);
      float last = -1, largest = 0, brightest = 0;
      for (int step = 0; step <= 400; ++step) {
        const float angle = static_cast<float>(step * (1.6 / 400));
        auto s = std::make_unique<GeneratedScene>();
        const std::uint32_t wall = add_material(s.get(), polished(brdf, 0.3)), light = add_material(s.get(), lamp());
        const float c = 5 * std::cos(angle), n = 5 * std::sin(angle);
        add_quad(s.get(), {-c, -5, n}, {c, -5, -n}, {c, 5, -n}, {-c, 5, n}, wall);
        add_quad(s.get(), {-6, 1, 3}, {-4, 1, 3}, {-4, -1, 3}, {-6, -1, 3}, light);
        auto test = ray_renderer(s.get(), 1, points);
        const float radiance = look(*test, {5 * std::sin(angle + 0.5f), 0, 5 * std::cos(angle + 0.5f)}, {0, 0, 0}).x;
        if (last >= 0) largest = std::fmax(largest, std::fabs(radiance - last));
        last = radiance, brightest = std::fmax(brightest, radiance);
      }
      CAPTURE(largest);
      CAPTURE(brightest);
      CHECK(brightest > 0.02f);
      CHECK(largest < 0.05f * brightest);
      last = -1, largest = 0, brightest = 0;
      auto s = lamp_scene(polished(brdf, 0.3));
      auto test = ray_renderer(s.get(), 1, points);
      for (int step = 0; step <= 1000; ++step) {
        const float angle = static_cast<float>(step * (1.55 / 1000));
        const float radiance = look(*test, {0, -std::sin(angle), std::cos(angle)}, {0, 0, 0}).x;
        if (last >= 0) largest = std::fmax(largest, std::fabs(radiance - last));
        last = radiance, brightest = std::fmax(brightest, radiance);
      }
      CAPTURE(largest);
      CHECK(largest < 0.02f * brightest);
    }
}

// Goal: the highlight of a half-hidden lamp is about that of its visible half: bright where that is reflected, dark
// where the board is. Method: a floor of sharp gloss behind a board, with 64 points, against the sum over the visible
// half; the sum of the points themselves errs more. Where the board hides the whole lamp, black.
TEST_CASE("polygon_gloss_of_a_half_hidden_lamp") {
  for (std::uint32_t brdf : {kGgx, kPhong}) {
    CAPTURE(brdf);
    const Material floor = polished(brdf, 0.08);
    auto s = lamp_scene(floor, true);
    auto closed = ray_renderer(s.get(), 1, 64);
    Settings settings = closed->renderer.settings;
    settings.area_irradiance = AreaIrradiance::points;
    auto points = make_renderer(s->scene, settings);
    Errors error, error_of_points;
    constexpr int kPlaces = 21;
    double most = 0;
    for (int i = 0; i < kPlaces; ++i) {
      const Vec3 at = {-0.5f + 0.05f * static_cast<float>(i), 0.1f, 0}, eye = {at.x, -2, 1.4f};
      const double exact = summed(floor, to_double(at), to_double(eye), true);
      most = std::fmax(most, exact);
      error.add(static_cast<double>(look(*closed, eye, at).x) - exact, kPlaces);
      error_of_points.add(static_cast<double>(look(*points, eye, at).x) - exact, kPlaces);
    }
    MESSAGE(std::string(kBrdfList[brdf]->name), ": error ", error.mean, ", of points ", error_of_points.mean,
            ", brightest ", most);
    CHECK(error.mean < 0.06 * most);
    CHECK(error.mean < error_of_points.mean);
    CHECK(look(*closed, {-3.5f, -1, 0.5f}, {-3.5f, 1.1f, 0}).x == 0);
  }
}

// Goal: highlights do not depend on how rays are traced. Method: floors of either lobe, lit through a board and past
// it, at a few numbers of points: tiles against single rays, and each accelerator.
TEST_CASE("polygon_gloss_is_the_same_in_tiles_and_ray_by_ray") {
  auto same = [](const Picture& a, const Picture& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(Vec3)) == 0;
  };
  for (std::uint32_t brdf : {kGgx, kPhong})
    for (std::uint32_t points : {1u, 4u, 9u})
      for (float levels : {0.0f, 4.0f}) {
        CAPTURE(brdf);
        CAPTURE(points);
        auto s = lamp_scene(polished(brdf, 0.2, 0.4f), true);
        Settings settings = settings_of(points);
        settings.cut_off_levels = levels;
        const Picture tiles = trace_picture(s->scene, settings).picture;
        CHECK(same(tiles, trace_picture(s->scene, settings, nullptr, false).picture));
        for (const AccelInfo* accel : kAccelList) CHECK(same(tiles, trace_picture(s->scene, settings, accel).picture));
      }
}
