// Undersampling: which pixels are traced, and what those between are made of.
#include <doctest/doctest.h>

#include <cmath>
#include <cstring>

#include "scene/builtin_helpers.h"
#include "shade/lattice.h"
#include "shade_helpers.h"
#include "support/effort.h"

using namespace pocketray;

namespace {

Settings lattice_settings(Resolution resolution, std::uint32_t width, std::uint32_t height) {
  Settings settings = settings_for(kAllFeatures, width, height);
  settings.resolution = resolution;
  return settings;
}

// The definition, over the whole picture: from all its pixels traced, with those off the lattice replaced.
struct Oracle {
  Picture pixels;
  int width, height;

  const Vec3& at(int x, int y) const {
    auto mirror = [](int i, int count) { return i < 0 ? -i : i >= count ? 2 * count - 2 - i : i; };
    return pixels[static_cast<std::size_t>(mirror(y, height) * width + mirror(x, width))];
  }
  // From the four neighbours at (dx, dy), (−dx, −dy), (−dy, dx) and (dy, −dx).
  void replace(int x, int y, int dx, int dy) {
    const Vec3 a = at(x - dx, y - dy), b = at(x + dx, y + dy), c = at(x + dy, y - dx), d = at(x - dy, y + dx);
    auto distance = [](const Vec3& p, const Vec3& q) {
      return std::fabs(p.x - q.x) + std::fabs(p.y - q.y) + std::fabs(p.z - q.z);
    };
    const float first = distance(a, b), second = distance(c, d);
    Vec3 value = ((a + b) + (c + d)) * 0.25f;
    if (first < second) value = (a + b) * 0.5f;
    if (first > second) value = (c + d) * 0.5f;
    pixels[static_cast<std::size_t>(y * width + x)] = value;
  }
};

Picture undersampled(const Picture& exact, Resolution resolution, int width, int height) {
  Oracle oracle = {exact, width, height};
  if (width < 2 || height < 2) return exact;
  if (resolution == Resolution::half)
    for (int y = 1; y < height; y += 2)
      for (int x = 1; x < width; x += 2) oracle.replace(x, y, 1, 1);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      if ((x + y) % 2 == 1) oracle.replace(x, y, 1, 0);
  return oracle.pixels;
}

constexpr Resolution kResolutions[] = {Resolution::checkerboard, Resolution::half};

}  // namespace

// Goal: pixels of the lattice are those of the exact picture, the others what the definition says. Method: bit for bit
// against the definition, over generated scenes and sizes at and beside multiples of a tile's side, down to one pixel.
TEST_CASE("lattice_pixels_are_as_defined") {
  constexpr std::uint32_t kSizes[][2] = {{45, 34}, {16, 16}, {17, 9}, {33, 8}, {8, 25},
                                         {3, 3},   {2, 2},   {2, 7},  {1, 5},  {6, 1}};
  for (const auto& size : kSizes)
    for (Resolution resolution : kResolutions)
      for (std::uint64_t seed = 1; seed <= std::uint64_t(kEffortDivisor > 6 ? 1 : 3); ++seed) {
        auto generated = generate_scene(kAllFeatures, seed);
        const Settings settings = lattice_settings(resolution, size[0], size[1]);
        const Settings full = lattice_settings(Resolution::full, size[0], size[1]);
        const Picture exact = render_picture(generated->scene, full, 0.5);
        CAPTURE(size[0]);
        CAPTURE(size[1]);
        CAPTURE(seed);
        const Picture expected = undersampled(exact, resolution, static_cast<int>(size[0]), static_cast<int>(size[1]));
        CHECK(same_picture(render_picture(generated->scene, settings, 0.5), expected));
      }
}

// Goal: with the effect forced on, all pixels at full resolution are traced. Method: differential, bit for bit.
TEST_CASE("lattice_of_all_pixels_is_exact") {
  auto generated = generate_scene(kAllFeatures, 1);
  Settings settings = lattice_settings(Resolution::full, 45, 34);
  const Picture expected = render_picture(generated->scene, settings, 0.5);
  settings.forced_on = bit(Effect::undersampling);
  CHECK(same_picture(render_picture(generated->scene, settings, 0.5), expected));
}

// Goal: nothing but the lattice is traced, and no pixel of it twice by one thread. Method: camera rays are counted.
TEST_CASE("lattice_is_traced_once") {
  auto generated = generate_scene(bit(Feature::point_light), 1);
  for (std::uint32_t width : {32u, 45u})
    for (std::uint32_t height : {24u, 35u})
      for (Resolution resolution : kResolutions) {
        Settings settings;
        settings.width = width, settings.height = height, settings.resolution = resolution;
        auto test = make_renderer(generated->scene, settings);
        const std::uint64_t before = total_counts(test->renderer).rays[static_cast<int>(RayKind::primary)];
        REQUIRE(render_frame(&test->renderer, 0).ok);
        std::uint64_t expected = 0;
        for (std::uint32_t y = 0; y < height; ++y)
          for (std::uint32_t x = 0; x < width; ++x) expected += on_lattice(resolution, x, y);
        CAPTURE(width);
        CAPTURE(height);
        CHECK(before == 0);
        CHECK(total_counts(test->renderer).rays[static_cast<int>(RayKind::primary)] == expected);
        const std::uint32_t count = width * height;
        const std::uint32_t traced_max =
            resolution == Resolution::half ? (width + 1) * (height + 1) / 4 : (count + 1) / 2;
        CHECK(expected <= traced_max);
      }
}

// Goal: upright and level edges are as sharp on a checkerboard as traced, wherever they lie. Method:
// a bright half-plane before a dark one; the picture equals the exact one.
TEST_CASE("lattice_keeps_upright_edges") {
  for (int i = 0; i < 12; ++i)
    for (bool level : {false, true}) {
      GeneratedScene s;
      add_sheet(&s, 0, add_material(&s, matte(0.1f)));
      const float edge = -0.5f + 0.08f * static_cast<float>(i);
      const std::uint32_t bright = add_material(&s, matte(0.9f));
      if (level)
        add_quad(&s, {-9, edge, 1}, {9, edge, 1}, {9, 9, 1}, {-9, 9, 1}, bright);
      else
        add_quad(&s, {edge, -9, 1}, {9, -9, 1}, {9, 9, 1}, {edge, 9, 1}, bright);
      s.lights.resize(1);
      s.lights[0].kind = LightKind::directional;
      s.lights[0].direction = {0, 0, -1};
      aim(&s, {0, 0, 6}, {0, 0, 0}, 40);
      s.bind();
      Settings settings;
      settings.width = 44, settings.height = 34, settings.cut_off_levels = 0;
      const Picture exact = render_picture(s.scene, settings);
      CAPTURE(i);
      CAPTURE(level);
      settings.resolution = Resolution::checkerboard;
      CHECK(same_picture(render_picture(s.scene, settings), exact));
    }
}
