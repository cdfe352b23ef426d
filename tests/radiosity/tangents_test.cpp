// Hermite patches: HARDCASES rows 54 to 57.
#include "desktop/radiosity/tangents.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "base/rng.h"
#include "indirect/reconstruct/hermite.h"
#include "support/hard_case.h"

using namespace pocketray;

namespace {

using Function = std::function<float(float s, float t)>;

struct Grid {
  std::uint32_t columns, rows;
  std::vector<RadiosityNode> nodes;
  Grid(std::uint32_t c, std::uint32_t r, const Function& f, bool limited) : columns(c), rows(r), nodes(c * r) {
    for (std::uint32_t row = 0; row < r; ++row)
      for (std::uint32_t column = 0; column < c; ++column) {
        const float value = f(static_cast<float>(column), static_cast<float>(row));
        nodes[row * c + column].value = {value, value * .5f, value * .25f};
      }
    set_tangents(nodes.data(), c, r, limited);
  }
  Vec3 at(float s, float t) const {
    const std::uint32_t column = std::min(static_cast<std::uint32_t>(s), columns - 2),
                        row = std::min(static_cast<std::uint32_t>(t), rows - 2);
    return in_cell(column, row, s - static_cast<float>(column), t - static_cast<float>(row));
  }
  Vec3 in_cell(std::uint32_t column, std::uint32_t row, float s, float t) const {
    const RadiosityNode* n = &nodes[row * columns + column];
    return bicubic_patch({n, n + 1, n + columns, n + columns + 1}, s, t);
  }
};

// The largest difference from the function inside the grid.
double error_of(const Grid& grid, const Function& f) {
  double most = 0;
  for (float s = 0; s <= static_cast<float>(grid.columns - 1); s += .13f)
    for (float t = 0; t <= static_cast<float>(grid.rows - 1); t += .17f)
      most = std::max(most, static_cast<double>(std::fabs(grid.at(s, t).x - f(s, t))));
  return most;
}

}  // namespace

// Goal: constant, bilinear and monotone quadratic data are reproduced, limited or not; quadratics with an extremum
// between nodes without limits; cubics with their exact tangents.
TEST_CASE("hard_54_polynomials_are_reproduced") {
  const Function constant = [](float, float) { return 3.f; };
  const Function bilinear = [](float s, float t) { return 1 + .5f * s + .25f * t + .125f * s * t; };
  const Function rising = [](float s, float t) { return 1 + .25f * s * s + .125f * t * t + .5f * t; };
  const Function bowl = [](float s, float t) { return 2 + (s - 1.25f) * (s - 1.25f) + .5f * t; };
  for (bool limited : {false, true})
    for (const Function& f : {constant, bilinear}) CHECK(error_of(Grid(5, 4, f, limited), f) < 2e-6);
  CHECK(error_of(Grid(5, 4, rising, false), rising) < 4e-6);
  CHECK(error_of(Grid(5, 4, bowl, false), bowl) < 4e-6);
  const Function cubic = [](float s, float t) { return s * s * s - s * t + t * t * t; };
  RadiosityNode n[4];
  for (int i = 0; i < 4; ++i) {
    const float s = static_cast<float>(i % 2), t = static_cast<float>(i / 2);
    auto grey = [](float x) { return Vec3{x, x, x}; };
    n[i] = {grey(cubic(s, t)), grey(3 * s * s - t), grey(3 * t * t - s), grey(-1)};
  }
  for (float s = 0; s <= 1; s += .1f)
    for (float t = 0; t <= 1; t += .1f)
      CHECK(std::fabs(bicubic_patch({n, n + 1, n + 2, n + 3}, s, t).x - cubic(s, t)) < 1e-6f);
  count_assertions("1e-6 of the largest value");
}

// Goal: at a step, unlimited tangents undershoot by 2/27, a corner reaches below zero and beyond the data; limited ones
// stay inside the range of the data, as they do for random data.
TEST_CASE("hard_55_steps_stay_in_the_range_of_the_data") {
  const Function step = [](float s, float) { return s < 2.5f ? 0.f : 1.f; };
  const Function corner = [](float s, float t) { return s < 2.5f || t < 2.5f ? 0.f : 1.f; };
  auto range = [](const Grid& grid) {
    std::pair<float, float> r = {1e9f, -1e9f};
    for (float s = 0; s <= static_cast<float>(grid.columns - 1); s += 1.f / 24)
      for (float t = 0; t <= static_cast<float>(grid.rows - 1); t += 1.f / 24)
        r = {std::min(r.first, grid.at(s, t).x), std::max(r.second, grid.at(s, t).x)};
    return r;
  };
  CHECK(range(Grid(6, 6, step, false)).first == doctest::Approx(-2.0 / 27).epsilon(.01));
  CHECK(range(Grid(6, 6, corner, false)).second > 1.1f);
  for (const Function& f : {step, corner}) {
    const auto r = range(Grid(6, 6, f, true));
    CHECK(r.first >= -1e-6f);
    CHECK(r.second <= 1 + 1e-6f);
  }
  Rng rng = make_rng(55);
  std::uint64_t wrong = 0;
  const int count = gate_share(200, 4000);
  for (int i = 0; i < count; ++i) {
    const Grid grid(
        6, 6, [&](float, float) { return next_u32(&rng) % 3 ? next_float(&rng) : 0.f; }, true);
    for (std::uint32_t column = 0; column < 5; ++column)
      for (std::uint32_t row = 0; row < 5; ++row)
        for (float s = 0; s <= 1; s += .125f)
          for (float t = 0; t <= 1; t += .125f) wrong += !(grid.in_cell(column, row, s, t).x >= -1e-6f);
  }
  CHECK(wrong == 0);
  count_hard(static_cast<std::uint64_t>(count), wrong, "inside the data");
}

// Goal: patches meet without a jump in value or slope.
TEST_CASE("hard_56_seams_inside_a_grid_are_smooth") {
  Rng rng = make_rng(56);
  for (bool limited : {false, true}) {
    const Grid grid(
        6, 5, [&](float, float) { return next_float(&rng); }, limited);
    for (std::uint32_t column = 1; column < 5; ++column)
      for (std::uint32_t row = 0; row < 4; ++row)
        for (float t = 0; t <= 1; t += .25f) {
          CHECK(std::fabs(grid.in_cell(column - 1, row, 1, t).x - grid.in_cell(column, row, 0, t).x) < 1e-5f);
          const float h = 1.f / 1024;
          const float before = (grid.in_cell(column - 1, row, 1, t).x - grid.in_cell(column - 1, row, 1 - h, t).x) / h;
          const float after = (grid.in_cell(column, row, h, t).x - grid.in_cell(column, row, 0, t).x) / h;
          CHECK(std::fabs(before - after) < .02f);  // second differences × h; a kink of bilinear data is near 1
        }
  }
  count_assertions("1e-5");
}

// Goal: the least grid and huge ratios are finite; turning the data by 90° or 180° turns the surface.
TEST_CASE("hard_57_small_grids_ratios_and_symmetry") {
  const Grid least(
      2, 2, [](float s, float t) { return s + 2 * t; }, true);
  CHECK(std::fabs(least.at(.5f, .5f).x - 1.5f) < 1e-6f);
  const Grid steep(
      4, 4, [](float s, float) { return s < 1.5f ? 1e-6f : 1e12f; }, true);
  for (const RadiosityNode& n : steep.nodes) CHECK((is_finite(n.ds) && is_finite(n.dt) && is_finite(n.dst)));
  Rng rng = make_rng(57);
  float data[5][5];
  for (auto& row : data)
    for (float& x : row) x = next_float(&rng);
  auto value = [&](float s, float t) { return data[static_cast<int>(t)][static_cast<int>(s)]; };
  const Grid plain(5, 5, value, true),
      turned(
          5, 5, [&](float s, float t) { return value(t, 4 - s); }, true),
      opposite(
          5, 5, [&](float s, float t) { return value(4 - s, 4 - t); }, true);
  for (float s = 0; s <= 4; s += .3f)
    for (float t = 0; t <= 4; t += .3f) {
      CHECK(std::fabs(plain.at(t, 4 - s).x - turned.at(s, t).x) < 1e-5f);
      CHECK(std::fabs(plain.at(4 - s, 4 - t).x - opposite.at(s, t).x) < 1e-5f);
    }
  count_assertions("1e-5");
}
