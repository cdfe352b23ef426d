#include "desktop/import/exact.h"

#include <algorithm>
#include <cmath>

#include "base/limits.h"

namespace pocketray {

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

bool is_exact_coordinate(const Vec3d& p) {
  constexpr double kMax = static_cast<double>(kCoordinateMax);
  return std::fabs(p.x) <= kMax && std::fabs(p.y) <= kMax && std::fabs(p.z) <= kMax;
}

}  // namespace pocketray
