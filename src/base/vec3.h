// Vectors of three and two components. Sums associate from the left, so every build rounds alike.
#pragma once
#include <cmath>

namespace pocketray {

template <class T>
struct Vec3T {
  T x, y, z;
  T& operator[](int axis) { return (&x)[axis]; }
  const T& operator[](int axis) const { return (&x)[axis]; }
};
using Vec3 = Vec3T<float>;
using Vec3d = Vec3T<double>;

struct Vec2 {
  float x, y;
};

// clang-format off
template <class T> inline Vec3T<T> operator+(const Vec3T<T>& a, const Vec3T<T>& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
template <class T> inline Vec3T<T> operator-(const Vec3T<T>& a, const Vec3T<T>& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
template <class T> inline Vec3T<T> operator*(const Vec3T<T>& a, const Vec3T<T>& b) { return {a.x * b.x, a.y * b.y, a.z * b.z}; }
template <class T> inline Vec3T<T> operator*(const Vec3T<T>& a, T s) { return {a.x * s, a.y * s, a.z * s}; }
template <class T> inline Vec3T<T> operator*(T s, const Vec3T<T>& a) { return a * s; }
template <class T> inline Vec3T<T> operator/(const Vec3T<T>& a, T s) { return {a.x / s, a.y / s, a.z / s}; }
template <class T> inline Vec3T<T> operator-(const Vec3T<T>& a) { return {-a.x, -a.y, -a.z}; }
template <class T> inline Vec3T<T>& operator+=(Vec3T<T>& a, const Vec3T<T>& b) { return a = a + b; }
template <class T> inline Vec3T<T>& operator*=(Vec3T<T>& a, const Vec3T<T>& b) { return a = a * b; }
template <class T> inline bool operator==(const Vec3T<T>& a, const Vec3T<T>& b) { return a.x == b.x && a.y == b.y && a.z == b.z; }
template <class T> inline bool operator!=(const Vec3T<T>& a, const Vec3T<T>& b) { return !(a == b); }
template <class T> inline T dot(const Vec3T<T>& a, const Vec3T<T>& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
// clang-format on

template <class T>
inline Vec3T<T> cross(const Vec3T<T>& a, const Vec3T<T>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <class T>
inline T max_component(const Vec3T<T>& a) {
  T m = a.x > a.y ? a.x : a.y;
  return m > a.z ? m : a.z;
}
inline Vec3 min(const Vec3& a, const Vec3& b) {
  return {a.x < b.x ? a.x : b.x, a.y < b.y ? a.y : b.y, a.z < b.z ? a.z : b.z};
}
inline Vec3 max(const Vec3& a, const Vec3& b) {
  return {a.x > b.x ? a.x : b.x, a.y > b.y ? a.y : b.y, a.z > b.z ? a.z : b.z};
}
inline Vec3d to_double(const Vec3& a) { return {a.x, a.y, a.z}; }
inline Vec3 to_float(const Vec3d& v) {
  return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}
inline Vec3 abs(const Vec3& a) { return {std::fabs(a.x), std::fabs(a.y), std::fabs(a.z)}; }
template <class T>
inline bool is_zero(const Vec3T<T>& a) {
  return a.x == 0 && a.y == 0 && a.z == 0;
}
template <class T>
inline bool is_finite(const Vec3T<T>& a) {
  return std::isfinite(a.x) && std::isfinite(a.y) && std::isfinite(a.z);
}
template <class T>
inline T length(const Vec3T<T>& a) {
  return std::sqrt(dot(a, a));
}

// normalize() where squares could underflow or overflow: scales by the largest component. Out of line, so that
// normalize() is inlined.
template <class T>
[[gnu::noinline, gnu::cold]] Vec3T<T> normalize_extreme(const Vec3T<T>& a) {
  T size = max_component(Vec3T<T>{std::fabs(a.x), std::fabs(a.y), std::fabs(a.z)});
  if (!(size > 0) || !std::isfinite(size)) return {0, 0, 0};
  int exponent;
  std::frexp(size, &exponent);
  Vec3T<T> scaled = {std::ldexp(a.x, -exponent), std::ldexp(a.y, -exponent), std::ldexp(a.z, -exponent)};
  Vec3T<T> unit = scaled / std::sqrt(dot(scaled, scaled));
  return is_finite(unit) ? unit : Vec3T<T>{0, 0, 0};
}

// Unit vector along a; both 1e-30 and 1e30 work (HARDCASES row 30). The zero vector and non-finite vectors give the
// zero vector.
template <class T>
inline Vec3T<T> normalize(const Vec3T<T>& a) {
  T square = dot(a, a);
  if (square > T(0x1p-80) && square < T(0x1p80)) return a / std::sqrt(square);
  return normalize_extreme(a);
}

// Two unit vectors that span the plane normal to the unit vector n [Duff et al. 2017, listing 3].
inline void make_basis(const Vec3& n, Vec3* tangent, Vec3* bitangent) {
  float sign = std::copysign(1.0f, n.z);
  float a = -1.0f / (sign + n.z);
  float b = n.x * n.y * a;
  *tangent = {1.0f + sign * n.x * n.x * a, sign * b, -sign * n.x};
  *bitangent = {b, sign + n.y * n.y * a, -n.y};
}

}  // namespace pocketray
