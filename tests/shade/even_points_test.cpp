#include "shade/even_points.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "base/limits.h"
#include "base/rng.h"
#include "shade/shade_helpers.h"
#include "support/effort.h"

using namespace pocketray;

namespace {

struct Point {
  double x, y;
};
using Points = std::vector<Point>;

Points rooks(std::uint32_t count) {
  Points points;
  for (std::uint32_t i = 0; i < count; ++i) {
    Vec2 p = rook_point(i, count);
    points.push_back({double(p.x), double(p.y)});
  }
  return points;
}
Points cells(std::uint32_t count) {
  Points points;
  for (std::uint32_t i = 0; i < count; ++i) {
    UnitCell cell = equal_cell(i, count);
    points.push_back({0.5 * (cell.x_begin + cell.x_end), cell.y});
  }
  return points;
}
// Hammersley points with that many bits of y, in the middle of their interval: the former samples of a pixel (4 bits),
// off centre for every count but one.
Points hammersley(std::uint32_t count, int bits) {
  Points points;
  for (std::uint32_t i = 0; i < count; ++i) {
    std::uint32_t mirrored = 0;
    for (int b = 0; b < bits; ++b) mirrored |= (i >> b & 1) << (bits - 1 - b);
    points.push_back({(i + 0.5) / count, std::ldexp(mirrored + 0.5, -bits)});
  }
  return points;
}
Points at_random(std::uint32_t count, Rng* rng) {
  Points points(count);
  for (Point& p : points) p = {next_double(rng), next_double(rng)};
  return points;
}

double off_centre(const Points& points) {
  double x = 0, y = 0;
  for (const Point& p : points) x += p.x, y += p.y;
  return std::hypot(x / double(points.size()) - 0.5, y / double(points.size()) - 0.5);
}

// ∫∫ √(x² + y²) over [0, a] × [0, b].
double corner_distance(double a, double b) {
  if (!(a > 0 && b > 0)) return 0;
  double d = std::hypot(a, b);
  return (2 * a * b * d + a * a * a * std::log((b + d) / a) + b * b * b * std::log((a + d) / b)) / 6;
}

// Over all straight lines that meet the unit square, uniform in direction and position: root mean square error of the
// area on one side when the points represent it. For one direction the mean over positions is an energy distance
// [Székely & Rizzo 2013, "Energy statistics", eq. 4.5]; over all directions its |x − y| become distances in the plane;
// the mean distance of two points of the square is (2 + √2 + 5 arsinh 1) / 15.
double edge_error(const Points& points) {
  const double between = (2 + std::sqrt(2.0) + 5 * std::asinh(1.0)) / 15;
  double to_square = 0, to_points = 0, n = double(points.size());
  for (const Point& p : points) {
    for (double a : {p.x, 1 - p.x})
      for (double b : {p.y, 1 - p.y}) to_square += corner_distance(a, b);
    for (const Point& q : points) to_points += std::hypot(p.x - q.x, p.y - q.y);
  }
  return std::sqrt(std::fmax(0, 0.5 * (to_square / n - 0.5 * between - 0.5 * to_points / (n * n))));
}

// L2 star discrepancy [Warnock 1972].
double star_error(const Points& points) {
  double one = 0, two = 0, n = double(points.size());
  for (const Point& p : points) {
    one += (1 - p.x * p.x) * (1 - p.y * p.y);
    for (const Point& q : points) two += (1 - std::fmax(p.x, q.x)) * (1 - std::fmax(p.y, q.y));
  }
  return std::sqrt(std::fmax(0, 1.0 / 9 - one / (2 * n) + two / (n * n)));
}

// Where samples see the edge of a white wall whose right (axis 0) or upper (axis 1) edge is that many pixels from the
// left or the lower border of a picture of 8 × 8: the sum of the pixels across it.
double edge_seen(std::uint32_t samples, int axis, double edge, bool orthographic) {
  constexpr int kSide = 8, kMiddle = kSide / 2;
  GeneratedScene s;
  float low = -100, high = 100, end = float(edge) - kMiddle;
  Vec3 corner = axis == 0 ? Vec3{end, high, 0} : Vec3{high, end, 0};
  add_quad(&s, {low, low, 0}, {corner.x, low, 0}, corner, {low, corner.y, 0}, add_material(&s, unlit(1)));
  constexpr float kDistance = 10;
  aim(&s, {0, 0, kDistance}, {0, 0, 0}, 2 * std::atan(kMiddle / double(kDistance)) * 180 / kPiD);
  if (orthographic) s.cameras[0].projection = Projection::orthographic, s.cameras[0].vertical_extent = kSide;
  s.bind();
  Settings settings;
  settings.width = settings.height = kSide;
  settings.samples_per_pixel = samples;
  Picture picture = render_picture(s.scene, settings);
  double sum = 0;
  for (std::size_t i = 0; i < kSide; ++i) sum += double(picture[axis == 0 ? 2 * kSide + i : i * kSide + 2].x);
  return sum;
}

double edge_bound(double n) { return 0.28 * std::pow(n, -0.75); }
double star_bound(double n) { return 0.32 * std::pow(n, -5.0 / 6); }

// Mean of an error over sets of random points.
constexpr int kRandomSets = 20;
template <class Error>
double error_at_random(std::uint32_t count, Error error) {
  Rng rng = make_rng(count);
  double sum = 0;
  for (int i = 0; i < kRandomSets; ++i) sum += error(at_random(count, &rng));
  return sum / kRandomSets;
}

}  // namespace

// Goal: the measure of edge errors is what it claims to be. Method: many random lines, for point sets with large and
// small errors.
TEST_CASE("even_points_edge_error_is_that_of_random_lines") {
  Rng rng = make_rng(5);
  const int lines = effort(4000), steps = 64;
  for (const Points& points : {Points{{0.5, 0.5}}, hammersley(2, 4), rooks(5)}) {
    double square_sum = 0, weight = 0;
    for (int i = 0; i < lines; ++i) {
      // Lines of one direction meet the square in proportion to its width across them.
      double angle = 3.14159265358979 * next_double(&rng), c = std::cos(angle), s = std::sin(angle);
      double width = std::fabs(c) + s, t = std::fmin(0, c) + width * next_double(&rng);
      double area = 0, hits = 0;
      for (int k = 0; k < steps; ++k) {  // across the square along x: c x + s y < t
        double x = (k + 0.5) / steps, y = (t - c * x) / s;
        area += std::fmin(1, std::fmax(0, y)) / steps;
      }
      for (const Point& p : points) hits += c * p.x + s * p.y < t;
      double error = hits / double(points.size()) - area;
      square_sum += width * error * error, weight += width;
    }
    CHECK(std::sqrt(square_sum / weight) ==
          doctest::Approx(edge_error(points)).epsilon(0.05 * std::sqrt(4000.0 / lines)));
  }
}

// Goal: a pixel's samples are centred, one per column and row, and as even as such sets get, for every count; one
// sample is the centre. Method: means, bounds that random points and the former points exceed, and exchanging any two
// points, which must not be an improvement.
TEST_CASE("even_points_of_a_pixel_are_centred_and_even") {
  CHECK((rook_point(0, 1).x == 0.5f && rook_point(0, 1).y == 0.5f));
  for (std::uint32_t n = 1; n <= kSampleCountMax; ++n) {
    CAPTURE(n);
    Points points = rooks(n), before = hammersley(n, 4);
    CHECK(off_centre(points) < 1e-7);
    std::vector<double> rows;
    for (std::uint32_t i = 0; i < n; ++i) {
      CHECK(points[i].x == double(float(i + 0.5) / float(n)));
      rows.push_back(points[i].y);
    }
    std::sort(rows.begin(), rows.end());
    for (std::uint32_t i = 0; i < n; ++i) CHECK(rows[i] == double(float(i + 0.5) / float(n)));
    double own = edge_error(points);
    CHECK(own < edge_bound(n));
    CHECK(star_error(points) < star_bound(n));
    for (std::uint32_t i = 0; i < n; ++i)
      for (std::uint32_t j = 0; j < i; ++j) {
        Points other = points;
        std::swap(other[i].y, other[j].y);
        CHECK(edge_error(other) > own - 1e-9);
      }
    if (n == 1) continue;
    if (n < 16) CHECK(off_centre(before) > 0.03);  // sixteen were centred, with four bits
    CHECK(edge_error(before) > edge_bound(n));
    CHECK(star_error(before) > star_bound(n));
    CHECK(error_at_random(n, edge_error) > edge_bound(n));
    CHECK(error_at_random(n, star_error) > star_bound(n));
  }
}

// Goal: the cells of a light tile the square with equal areas, and their middles are centred and even, for every count;
// a square number gives a grid. Method: the cells' own arithmetic, means, and bounds that random points exceed; the
// former points exceed them or are off centre, except for squares.
TEST_CASE("even_points_cells_are_equal_centred_and_even") {
  const std::uint32_t step = kEffortDivisor > 1 ? 7 : 1;
  for (std::uint32_t n = 1; n <= kPointsPerAreaLightMax; n += step) {
    CAPTURE(n);
    std::uint32_t side = 1;
    while (side * side < n) ++side;
    double y_begin = 0;
    std::size_t least = n, most = 0;
    for (std::uint32_t i = 0; i < n;) {  // row by row
      std::uint32_t begin = i;
      UnitCell first = equal_cell(i, n), cell = first;
      CHECK(first.x_begin == 0);
      for (; i < n && (cell = equal_cell(i, n)).y == first.y; ++i) {
        CHECK(cell.x_begin == (i == begin ? 0 : equal_cell(i - 1, n).x_end));
        CHECK(cell.x_end - cell.x_begin == doctest::Approx(first.x_end));
      }
      std::size_t in_row = i - begin;
      CHECK(equal_cell(i - 1, n).x_end == 1);
      least = std::min(least, in_row), most = std::max(most, in_row);
      double height = 2 * (first.y - y_begin);  // the middle is half-way
      CHECK(height * first.x_end == doctest::Approx(1.0 / n));
      y_begin += height;
    }
    CHECK(y_begin == doctest::Approx(1));
    CHECK(most - least <= (most == n ? n : 1));
    if (side * side == n) CHECK((least == side && most == side));
    Points points = cells(n);
    CHECK(off_centre(points) < 1e-12);
    CHECK(edge_error(points) < edge_bound(n));
    CHECK(star_error(points) < 0.29 / std::sqrt(n));
    if (n == 1) continue;
    if (n % 16 == 3) {
      CHECK(error_at_random(n, edge_error) > edge_bound(n));
      CHECK(error_at_random(n, star_error) > 0.29 / std::sqrt(n));
    }
  }
}

// Goal: more samples do not shift the picture. Method: horizontal and vertical edges of a wall at many positions within
// a pixel: for each count, the sums of a row or column place them correctly, averaged over the positions.
TEST_CASE("even_points_do_not_move_the_picture") {
  constexpr int kPlaces = 32;
  for (std::uint32_t n = 1; n <= kSampleCountMax; n += kEffortDivisor > 1 ? 5 : 1)
    for (int way = 0; way < 4; ++way) {
      int axis = way & 1;
      double moved = 0;
      for (int place = 0; place < kPlaces; ++place) {
        double edge = 3.5 + (place + 0.5) / kPlaces;  // pixels from the left or from below
        moved += edge_seen(n, axis, edge, way >= 2) - edge;
      }
      CAPTURE(n);
      CAPTURE(way);
      CHECK(std::fabs(moved / kPlaces) < 1.0 / kPlaces);
    }
}
