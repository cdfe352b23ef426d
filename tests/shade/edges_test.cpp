// Samples added at edges: which pixels get them, and what they are worth.
#include <doctest/doctest.h>

#include <cmath>

#include "scene/builtin_helpers.h"
#include "shade/edges.h"
#include "shade/pixel.h"
#include "shade/sample_points.h"
#include "shade_helpers.h"
#include "support/effort.h"
#include "support/test_environment.h"

using namespace pocketray;

namespace {

constexpr std::uint32_t kSamples = 8;

Settings plain_settings(std::uint32_t features, std::uint32_t width, std::uint32_t height) {
  Settings settings = settings_for(features, width, height);
  settings.samples_per_pixel = 1;
  return settings;
}

Picture with_edges(const Scene& scene, Settings settings, double seconds = 0) {
  settings.edge_samples = kSamples;
  return render_picture(scene, settings, seconds);
}

// The definition: along rows, columns and diagonals, the displayed value bends by more than 12 levels of 255.
struct EdgeOracle {
  const Picture& centres;
  int width, height;
  double exposure;

  double shown(int x, int y, int channel) const {
    const int column = std::min(std::max(x, 0), width - 1), row = std::min(std::max(y, 0), height - 1);
    const double value =
        exposure * double(centres[std::size_t(row) * std::size_t(width) + std::size_t(column)][channel]);
    return std::sqrt(std::min(std::max(value, 0.0), 1.0));
  }
  double bend(int x, int y) const {
    constexpr int kSteps[4][2] = {{1, 0}, {0, 1}, {1, 1}, {1, -1}};
    double most = 0;
    for (const auto& step : kSteps)
      for (int c = 0; c < 3; ++c)
        most = std::max(most, std::fabs(shown(x - step[0], y - step[1], c) - 2 * shown(x, y, c) +
                                        shown(x + step[0], y + step[1], c)));
    return most;
  }
  // 1: an edge; 0: none; −1: too close to tell.
  int is_edge(int x, int y) const {
    const double over = bend(x, y) - 12 / 255.0;
    return over > 1e-5 ? 1 : over < -1e-5 ? 0 : -1;
  }
};

// Radiance of a sample of a pixel: 0 is the centre.
Vec3 sample_at(const Renderer& renderer, std::uint32_t column, std::uint32_t row, std::uint32_t sample) {
  Tracer tracer = make_tracer(renderer.frame);
  use_points_of(&tracer, sample);
  const Vec2 offset = kept_sample_offset(renderer.settings, sample);
  const Ray ray = pixel_ray(renderer.frame, column, row, offset);
  Hit hit;
  renderer.frame.geometry.accel_info->closest(renderer.frame.geometry.accel, ray, visible_filter(renderer.frame), &hit,
                                              &tracer.stats);
  return sample_radiance(&tracer, ray, hit, nullptr);
}

double difference(const Vec3& a, const Vec3& b) {
  return double(max_component(abs(a - b))) / (1e-3 + double(max_component(abs(b))));
}

// A half-plane whose border has this slope, before a sheet; each has one colour everywhere.
void add_half_plane(GeneratedScene* s, float slope, float shift, float dark = 0.1f, float bright = 0.9f) {
  add_sheet(s, 0, add_material(s, unlit(dark)));
  const float far = 20, low = shift - far * slope, high = shift + far * slope;
  add_quad(s, {low, -far, 1}, {far, -far, 1}, {far, far, 1}, {high, far, 1}, add_material(s, unlit(bright)));
  aim(s, {0, 0, 6}, {0, 0, 0}, 40);
  s->bind();
}

double mean_error(const Picture& picture, const Picture& truth) {
  double sum = 0;
  for (std::size_t i = 0; i < picture.size(); ++i)
    for (int c = 0; c < 3; ++c) sum += std::pow(double(picture[i][c]) - double(truth[i][c]), 2);
  return std::sqrt(sum / (3 * double(picture.size())));
}

// The mean of a picture with more pixels over blocks of side × side.
Picture averaged(const Picture& fine, std::uint32_t width, std::uint32_t height, std::uint32_t side) {
  Picture picture(std::size_t(width) * height, Vec3{0, 0, 0});
  for (std::uint32_t row = 0; row < height * side; ++row)
    for (std::uint32_t column = 0; column < width * side; ++column)
      picture[std::size_t(row / side) * width + column / side] +=
          fine[std::size_t(row) * width * side + column] * (1 / static_cast<float>(side * side));
  return picture;
}

}  // namespace

// Goal: pixels off edges keep their centre's value, and those at edges take the mean of centre and added samples.
// Method: bit for bit, and sample by sample, against the definition, in generated scenes with every feature, of sizes
// at and beside multiples of a tile's side, down to one pixel.
TEST_CASE("edges_are_as_defined") {
  constexpr std::uint32_t kSizes[][2] = {{45, 34}, {16, 16}, {17, 9}, {8, 25}, {2, 7}, {1, 5}, {6, 1}, {1, 1}};
  int edges = 0, exact = 0;
  for (const auto& size : kSizes)
    for (std::uint64_t seed = 1; seed <= std::uint64_t(kEffortDivisor > 6 ? 1 : 2); ++seed) {
      auto generated = generate_scene(kAllFeatures, seed);
      Settings settings = plain_settings(kAllFeatures, size[0], size[1]);
      if (seed == 1) settings.points_per_area_light = 16;  // of which samples see few
      auto plain = make_renderer(generated->scene, settings);
      REQUIRE(render_frame(&plain->renderer, 0.5).ok);
      const Picture centres(plain->renderer.image.begin(), plain->renderer.image.end());
      Settings with_samples = settings;
      with_samples.edge_samples = kSamples;
      auto edged = make_renderer(generated->scene, with_samples);
      REQUIRE(render_frame(&edged->renderer, 0.5).ok);
      const Array<Vec3>& picture = edged->renderer.image;
      const EdgeOracle oracle = {centres, int(size[0]), int(size[1]), double(plain->renderer.view.exposure)};
      CAPTURE(size[0]);
      CAPTURE(size[1]);
      CAPTURE(seed);
      for (std::uint32_t row = 0; row < size[1]; ++row)
        for (std::uint32_t column = 0; column < size[0]; ++column) {
          const std::size_t i = std::size_t(row) * size[0] + column;
          const int is_edge = oracle.is_edge(int(column), int(row));
          if (is_edge == 0) CHECK(picture[i] == centres[i]);
          if (is_edge != 1) continue;
          Vec3 sum = sample_at(edged->renderer, column, row, 0);  // rays are left out by other bounds than in `plain`
          for (std::uint32_t k = 0; k < kSamples; ++k) sum += sample_at(edged->renderer, column, row, 1 + k);
          exact += difference(picture[i], sum * (1 / float(kSamples + 1))) < 1e-4;
          ++edges;
        }
    }
  CAPTURE(edges);
  CHECK(edges > 100);
  MESSAGE(exact << " of " << edges << " pixels at edges are the mean of their samples");
  CHECK(exact == edges);
}

// Goal: an edge begins at twelve levels, on a display of gamma 2. Method: a half-plane before a sheet, brighter by nine
// to fifteen levels; whether any pixel differs from its centre.
TEST_CASE("edges_begin_at_twelve_levels") {
  for (float levels : {9.0f, 11.5f, 12.5f, 15.0f}) {
    GeneratedScene s;
    const float dark = 0.1f, shown = std::sqrt(dark) + levels / 255;
    add_half_plane(&s, 0.13f, 0.07f, dark, shown * shown);
    Settings settings;
    settings.width = 44, settings.height = 34;
    CAPTURE(levels);
    CHECK(same_picture(with_edges(s.scene, settings), render_picture(s.scene, settings)) == (levels < 12));
  }
}

// Goal: pixels at the edge of surfaces of even light are the mean of centre and samples, at any slope. Method: a
// half-plane before a sheet, both unlit.
TEST_CASE("edges_of_even_light_are_means") {
  for (float slope : {0.0f, 0.13f, 0.6f, 1.0f, -0.37f}) {
    GeneratedScene s;
    add_half_plane(&s, slope, 0.07f);
    Settings settings;
    settings.width = 44, settings.height = 34;
    settings.edge_samples = kSamples;
    auto test = make_renderer(s.scene, settings);
    const Picture picture = with_edges(s.scene, settings);
    int edges = 0;
    for (std::uint32_t row = 0; row < settings.height; ++row)
      for (std::uint32_t column = 0; column < settings.width; ++column) {
        Vec3 sum = sample_at(test->renderer, column, row, 0);
        const Vec3 centre = sum;
        for (std::uint32_t k = 0; k < kSamples; ++k) sum += sample_at(test->renderer, column, row, 1 + k);
        const Vec3 mean = sum * (1 / float(kSamples + 1));
        const Vec3& pixel = picture[std::size_t(row) * settings.width + column];
        edges += !(pixel == centre);
        CAPTURE(slope);
        CHECK(difference(pixel, mean) < 1e-5);
      }
    CHECK(edges > 20);
  }
}

// Goal: the error is that of as many samples everywhere. Method: shadows of a square before a lamp of one point, and a
// mirror; the reference has 81 samples a pixel.
TEST_CASE("edges_err_as_little_as_samples_everywhere") {
  GeneratedScene s;
  add_sheet(&s, 0, add_material(&s, matte(0.8f)));
  Material mirror = matte(0.1f);
  mirror.mirror = {0.7f, 0.7f, 0.7f};
  add_quad(&s, {-2, -1, 0.2f}, {0.3f, -1.4f, 0.2f}, {0.1f, 0.8f, 0.9f}, {-1.8f, 1, 0.9f}, add_material(&s, mirror));
  add_quad(&s, {0.4f, -0.3f, 1}, {1.5f, 0, 1}, {1.2f, 1.1f, 1.1f}, {0.2f, 0.9f, 1.1f}, add_material(&s, matte(0.3f)));
  s.lights.resize(1);
  s.lights[0].position = {3, 2, 5}, s.lights[0].intensity = {60, 50, 40};
  aim(&s, {0, 0, 6}, {0, 0, 0}, 40);
  s.bind();
  Settings settings;
  settings.width = 80, settings.height = 60, settings.cut_off_levels = 0;
  Settings fine = settings, even = settings;
  fine.width *= 9, fine.height *= 9;
  even.samples_per_pixel = kSamples;
  const Picture truth = averaged(render_picture(s.scene, fine), settings.width, settings.height, 9);
  const double of_samples = mean_error(render_picture(s.scene, even), truth);
  const double of_edges = mean_error(with_edges(s.scene, settings), truth);
  CAPTURE(of_samples);
  CAPTURE(of_edges);
  CHECK(of_edges < 1.15 * of_samples);
  CHECK(mean_error(render_picture(s.scene, settings), truth) > 3 * of_samples);
}

// Goal: light that pixels share with their neighbours reaches the samples at edges, too. Method: an environment that is
// even and a floor with a wall on it: next to the mean of many samples, each with the light of its own neighbours.
TEST_CASE("edges_take_shared_light") {
  const TestEnvironment even = even_environment({0.5f, 0.5f, 0.5f});
  GeneratedScene s;
  add_sheet(&s, 0, add_material(&s, matte(0.6f)));
  add_quad(&s, {0.2f, -2, 0}, {0.5f, 2, 0}, {0.5f, 2, 3}, {0.2f, -2, 3}, add_material(&s, matte(0.9f)));
  aim(&s, {-2, -3, 5}, {0, 0, 0.5f}, 40);
  s.bind();
  Scene scene = s.scene;
  even.give(&scene);
  Settings settings;
  settings.width = 80, settings.height = 60;
  Settings samples = settings;
  samples.samples_per_pixel = 16;
  const Picture truth = render_picture(scene, samples), picture = with_edges(scene, settings);
  const double plain = mean_error(render_picture(scene, settings), truth), error = mean_error(picture, truth);
  CAPTURE(plain);
  CAPTURE(error);
  CHECK(plain > 0.003);
  CHECK(error < 0.8 * plain);
}

// Goal: one thread traces no centre twice. Method: camera rays of a picture without edges are counted.
TEST_CASE("edges_trace_centres_once") {
  GeneratedScene s;
  add_sheet(&s, 0, add_material(&s, unlit(0.5f)));
  aim(&s, {0, 0, 6}, {0, 0, 0}, 40);
  s.bind();
  for (std::uint32_t width : {32u, 45u}) {
    Settings settings;
    settings.width = width, settings.height = 35, settings.edge_samples = kSamples;
    auto test = make_renderer(s.scene, settings);
    REQUIRE(render_frame(&test->renderer, 0).ok);
    CHECK(total_counts(test->renderer).rays[static_cast<int>(RayKind::primary)] == width * 35);
  }
}

// Goal: slivers, which centres meet or miss, and their shadows err less than with one sample. Method: blades a third of
// a pixel to two pixels wide, before a sheet with a light; the reference has 81 samples a pixel.
TEST_CASE("edges_of_slivers_err_less") {
  for (float width : {0.02f, 0.05f, 0.12f}) {
    GeneratedScene s;
    add_sheet(&s, 0, add_material(&s, matte(0.7f)));
    const std::uint32_t blade = add_material(&s, matte(0.2f));
    for (int i = -8; i <= 8; ++i) {
      const float x = 0.23f * static_cast<float>(i), lean = 0.05f * static_cast<float>(i);
      add_quad(&s, {x, -1.5f, 0.4f}, {x + width, -1.5f, 0.4f}, {x + width + lean, 1.5f, 0.8f}, {x + lean, 1.5f, 0.8f},
               blade);
    }
    s.lights.resize(1);
    s.lights[0].position = {1, 2, 5}, s.lights[0].intensity = {40, 40, 40};
    aim(&s, {0, 0, 6}, {0, 0, 0}, 40);
    s.bind();
    Settings settings;
    settings.width = 80, settings.height = 60, settings.cut_off_levels = 0;
    Settings fine = settings;
    fine.width *= 9, fine.height *= 9;
    const Picture truth = averaged(render_picture(s.scene, fine), settings.width, settings.height, 9);
    const double plain = mean_error(render_picture(s.scene, settings), truth);
    const double edges = mean_error(with_edges(s.scene, settings), truth);
    CAPTURE(width);
    CAPTURE(plain);
    CAPTURE(edges);
    CHECK(edges < 0.5 * plain);
  }
}

// Goal: samples at edges see few points of a lamp, and err as little as if they saw all: a pixel's samples together see
// more than its centre. Method: boxes under a lamp, flat or round, of 4 and of 16 points; the rays that edges add, and
// errors against 16 samples of 64 points.
TEST_CASE("edges_see_few_points_of_a_lamp") {
  for (const bool is_round : {false, true}) {
    GeneratedScene s;
    add_sheet(&s, 0, add_material(&s, matte(0.7f)));
    Material lamp = matte(0);
    lamp.emission = {6, 6, 6};
    const std::uint32_t light = add_material(&s, lamp), grey = add_material(&s, matte(0.5f));
    if (is_round)
      add_sphere(&s, {0.5f, 0.5f, 5}, 0.8f, 12, 8, light);
    else
      add_quad(&s, {-0.5f, 1.5f, 5}, {1.5f, 1.5f, 5}, {1.5f, -0.5f, 5}, {-0.5f, -0.5f, 5}, light);
    for (int i = 0; i < 5; ++i) {
      const float x = static_cast<float>(i) - 2.2f, y = 0.4f * static_cast<float>(i % 3) - 0.5f;
      add_box(&s, {x, y, 0}, {x + 0.3f, y + 0.5f, 0.4f + 0.2f * static_cast<float>(i)}, grey);
    }
    aim(&s, {-1, -4, 4}, {0, 0, 0.5f}, 40);
    s.bind();
    Settings settings;
    settings.width = 64, settings.height = 48, settings.cut_off_levels = 0;
    auto shadow_rays = [&](std::uint32_t points, std::uint32_t samples) {
      Settings counted = settings;
      counted.points_per_area_light = points, counted.edge_samples = samples;
      auto test = make_renderer(s.scene, counted);
      REQUIRE(render_frame(&test->renderer, 0).ok);
      return static_cast<double>(total_counts(test->renderer).rays[static_cast<int>(RayKind::shadow)]);
    };
    const double of_4 = shadow_rays(4, kSamples) - shadow_rays(4, 0);
    const double of_16 = shadow_rays(16, kSamples) - shadow_rays(16, 0);
    Settings many = settings;
    many.samples_per_pixel = 16, many.points_per_area_light = 64;
    const Picture truth = render_picture(s.scene, many);
    settings.points_per_area_light = 4;
    const double error_4 = mean_error(with_edges(s.scene, settings), truth);
    settings.points_per_area_light = 16;
    const double error_16 = mean_error(with_edges(s.scene, settings), truth);
    CAPTURE(is_round);
    CAPTURE(error_4);
    CAPTURE(error_16);
    CHECK(of_4 > 1000);
    CHECK(of_16 < 1.5 * of_4);
    CHECK(error_16 < 1.1 * error_4);
  }
}
