// Affine transforms as three rows of four: p' = A p + t.
#pragma once
#include <limits>

#include "base/vec3.h"

namespace pocketray {

struct Transform {
  float m[3][4] = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}};
};

struct Quaternion {
  float x = 0, y = 0, z = 0, w = 1;
};

inline Vec3 transform_point(const Transform& t, const Vec3& p) {
  return {t.m[0][0] * p.x + t.m[0][1] * p.y + t.m[0][2] * p.z + t.m[0][3],
          t.m[1][0] * p.x + t.m[1][1] * p.y + t.m[1][2] * p.z + t.m[1][3],
          t.m[2][0] * p.x + t.m[2][1] * p.y + t.m[2][2] * p.z + t.m[2][3]};
}
inline Vec3 transform_vector(const Transform& t, const Vec3& v) {
  return {t.m[0][0] * v.x + t.m[0][1] * v.y + t.m[0][2] * v.z, t.m[1][0] * v.x + t.m[1][1] * v.y + t.m[1][2] * v.z,
          t.m[2][0] * v.x + t.m[2][1] * v.y + t.m[2][2] * v.z};
}
// a ∘ b: applies b first.
inline Transform operator*(const Transform& a, const Transform& b) {
  Transform r;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 4; ++j)
      r.m[i][j] = a.m[i][0] * b.m[0][j] + a.m[i][1] * b.m[1][j] + a.m[i][2] * b.m[2][j] + (j == 3 ? a.m[i][3] : 0.0f);
  return r;
}
// Translation × rotation × scale, as glTF composes its nodes (glTF 2.0, sec. 3.5.3).
inline Transform compose(const Vec3& translation, const Quaternion& q, const Vec3& scale) {
  float xx = q.x * q.x, yy = q.y * q.y, zz = q.z * q.z, xy = q.x * q.y, xz = q.x * q.z, yz = q.y * q.z;
  float wx = q.w * q.x, wy = q.w * q.y, wz = q.w * q.z;
  Transform t;
  t.m[0][0] = (1 - 2 * (yy + zz)) * scale.x, t.m[0][1] = 2 * (xy - wz) * scale.y, t.m[0][2] = 2 * (xz + wy) * scale.z;
  t.m[1][0] = 2 * (xy + wz) * scale.x, t.m[1][1] = (1 - 2 * (xx + zz)) * scale.y, t.m[1][2] = 2 * (yz - wx) * scale.z;
  t.m[2][0] = 2 * (xz - wy) * scale.x, t.m[2][1] = 2 * (yz + wx) * scale.y, t.m[2][2] = (1 - 2 * (xx + yy)) * scale.z;
  t.m[0][3] = translation.x, t.m[1][3] = translation.y, t.m[2][3] = translation.z;
  return t;
}
// Determinant of the linear part, in double: products of three floats do not overflow there.
inline double determinant(const Transform& t) {
  Vec3d a = {t.m[0][0], t.m[0][1], t.m[0][2]}, b = {t.m[1][0], t.m[1][1], t.m[1][2]},
        c = {t.m[2][0], t.m[2][1], t.m[2][2]};
  return dot(a, cross(b, c));
}
// The effect of a transform on normals: its cofactor matrix. It needs no division, so singular transforms do no harm,
// and it carries the sign of the determinant: mirrored geometry keeps n·t = 0 and, with its winding flipped, its
// orientation.
struct NormalTransform {
  Vec3d row[3];
};
inline NormalTransform normal_transform(const Transform& t) {
  Vec3d a = {t.m[0][0], t.m[0][1], t.m[0][2]}, b = {t.m[1][0], t.m[1][1], t.m[1][2]},
        c = {t.m[2][0], t.m[2][1], t.m[2][2]};
  Vec3d bc = cross(b, c);
  double sign = dot(a, bc) < 0 ? -1.0 : 1.0;
  return {{bc * sign, cross(c, a) * sign, cross(a, b) * sign}};
}
// Unit vector; the zero vector where n is zero or is flattened to zero.
inline Vec3 transform_normal(const NormalTransform& t, const Vec3& n) {
  Vec3d m = {n.x, n.y, n.z};
  Vec3d u = normalize(Vec3d{dot(t.row[0], m), dot(t.row[1], m), dot(t.row[2], m)});
  return to_float(u);
}
inline Vec3 transform_normal(const Transform& t, const Vec3& n) { return transform_normal(normal_transform(t), n); }

// Returns whether the linear part can be inverted within float range; HARDCASES row 27 refuses transforms that cannot.
inline bool is_invertible(const Transform& t) {
  double d = std::fabs(determinant(t));
  return d >= std::numeric_limits<float>::min() && d <= std::numeric_limits<float>::max();
}

}  // namespace pocketray
