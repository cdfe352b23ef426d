#include "import/exact.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "base/check.h"
#include "base/limits.h"

namespace pocketray {
namespace {

// The number with the fewest decimals, or the most zeros, within `error` of x: a model's offset is mostly such a one.
double rounded_within(double x, double error) {
  for (double unit = 1e7; unit >= 1; unit /= 10)
    if (std::fabs(std::floor(x / unit + 0.5) * unit - x) <= error) return std::floor(x / unit + 0.5) * unit;
  for (double parts = 10; parts <= 1e9; parts *= 10)
    if (std::fabs(std::floor(x * parts + 0.5) / parts - x) <= error) return std::floor(x * parts + 0.5) / parts;
  return x;
}

}  // namespace

bool is_far(const ExactBox& bounds, std::uint64_t triangle_count) {
  // A typical edge must lose its last 10 of 24 bits, and the model must be farther away than twice its size: so most of
  // the loss is the offset's, and ordinary models keep their bits.
  constexpr double kLossMax = 0x1p-10, kDistanceMin = 2;
  const Vec3d size = bounds.high - bounds.low, middle = (bounds.low + bounds.high) * 0.5;
  for (double x : {bounds.low.x, bounds.low.y, bounds.low.z, bounds.high.x, bounds.high.y, bounds.high.z})
    if (!(std::fabs(x) <= static_cast<double>(kCoordinateMax))) return false;
  const double diagonal = length(size), distance = length(middle);
  if (!(diagonal > 0) || !(distance > kDistanceMin * diagonal)) return false;
  const double edge = diagonal / std::sqrt(static_cast<double>(std::max<std::uint64_t>(triangle_count, 1)));
  return distance * static_cast<double>(std::numeric_limits<float>::epsilon()) > kLossMax * edge;
}

ExactTransform exact(const Transform& t) {
  ExactTransform result;
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 4; ++column) result.m[row][column] = static_cast<double>(t.m[row][column]);
  return result;
}

ExactTransform operator*(const ExactTransform& a, const ExactTransform& b) {
  ExactTransform r;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 4; ++j)
      r.m[i][j] = a.m[i][0] * b.m[0][j] + a.m[i][1] * b.m[1][j] + a.m[i][2] * b.m[2][j] + (j == 3 ? a.m[i][3] : 0.0);
  return r;
}

Vec3d transform_point(const ExactTransform& t, const Vec3d& p) {
  return {t.m[0][0] * p.x + t.m[0][1] * p.y + t.m[0][2] * p.z + t.m[0][3],
          t.m[1][0] * p.x + t.m[1][1] * p.y + t.m[1][2] * p.z + t.m[1][3],
          t.m[2][0] * p.x + t.m[2][1] * p.y + t.m[2][2] * p.z + t.m[2][3]};
}

Transform recentred(const ExactTransform& t, const Vec3d& origin) {
  Transform result;
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 4; ++column)
      result.m[row][column] = static_cast<float>(t.m[row][column] - (column == 3 ? origin[row] : 0.0));
  return result;
}

void extend(ExactBox* box, const Vec3d& p) {
  for (int c = 0; c < 3; ++c) box->low[c] = std::min(box->low[c], p[c]), box->high[c] = std::max(box->high[c], p[c]);
}

void extend(ExactBox* box, const ExactTransform& to_world, const ExactBox& local) {
  for (int corner = 0; corner < 8; ++corner)
    extend(box,
           transform_point(to_world, {corner & 1 ? local.high.x : local.low.x, corner & 2 ? local.high.y : local.low.y,
                                      corner & 4 ? local.high.z : local.low.z}));
}

Vec3d choose_origin(const ExactBox& bounds, std::uint64_t triangle_count, SceneBuilder* builder) {
  CHECK(builder->out->origin.empty());  // chosen once
  if (!is_far(bounds, triangle_count)) return {0, 0, 0};
  const double error = length(bounds.high - bounds.low) * 0x1p-20;
  Vec3d origin;
  for (int c = 0; c < 3; ++c) origin[c] = rounded_within((bounds.low[c] + bounds.high[c]) / 2, error);
  builder->out->origin.push_back({origin.x, origin.y, origin.z});
  char told[200];
  std::snprintf(told, sizeof told,
                "the model is far from the origin, so it is moved by (%.12g, %.12g, %.12g) to keep its shape; --camera "
                "and --aov position count from its own origin",
                -origin.x, -origin.y, -origin.z);
  note_remark(builder, told);
  return origin;
}

Vec3d origin_of(const SceneBuilder& builder) {
  if (builder.out->origin.empty()) return {0, 0, 0};
  const SceneOrigin& origin = builder.out->origin[0];
  return {origin.x, origin.y, origin.z};
}

Vec3d choose_origin(const ExactBox& bounds, const Transform& turn, std::uint64_t triangle_count,
                    SceneBuilder* builder) {
  ExactBox turned;
  extend(&turned, exact(turn), bounds);
  const Vec3d o = choose_origin(turned, triangle_count, builder);
  auto back = [&](int c) {  // by the transpose
    return static_cast<double>(turn.m[0][c]) * o.x + static_cast<double>(turn.m[1][c]) * o.y +
           static_cast<double>(turn.m[2][c]) * o.z;
  };
  return {back(0), back(1), back(2)};
}

void recentre(const std::vector<Vec3d>& positions, const Transform& turn, std::uint64_t triangle_count,
              SceneBuilder* builder, std::vector<Vec3>* rounded) {
  ExactBox bounds;
  for (const Vec3d& p : positions) extend(&bounds, p);
  const Vec3d origin = choose_origin(bounds, turn, triangle_count, builder);
  if (builder->out->origin.empty()) return;
  CHECK_EQ(positions.size(), rounded->size());
  for (std::size_t i = 0; i < positions.size(); ++i) (*rounded)[i] = to_float(positions[i] - origin);
}

}  // namespace pocketray
