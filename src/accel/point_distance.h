// Least distance between a point and a triangle.
#pragma once
#include "base/vec3.h"

namespace pocketray {

// Squared distance from p to the triangle a, b, c, in double [Ericson 2005, Real-Time Collision Detection, sec. 5.1.5]:
// the Voronoi region of p among corners, edges and face decides.
inline double squared_distance(const Vec3d& p, const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  Vec3d ab = b - a, ac = c - a, ap = p - a, bp = p - b, cp = p - c;
  double d1 = dot(ab, ap), d2 = dot(ac, ap), d3 = dot(ab, bp), d4 = dot(ac, bp), d5 = dot(ab, cp), d6 = dot(ac, cp);
  double va = d3 * d6 - d5 * d4, vb = d5 * d2 - d1 * d6, vc = d1 * d4 - d3 * d2;
  Vec3d q = cp;  // from the nearest point of the triangle to p
  if (d1 <= 0 && d2 <= 0) {
    q = ap;
  } else if (d3 >= 0 && d4 <= d3) {
    q = bp;
  } else if (d6 >= 0 && d5 <= d6) {
    q = cp;
  } else if (vc <= 0 && d1 >= 0 && d3 <= 0 && d1 > d3) {
    q = ap - ab * (d1 / (d1 - d3));
  } else if (vb <= 0 && d2 >= 0 && d6 <= 0 && d2 > d6) {
    q = ap - ac * (d2 / (d2 - d6));
  } else if (va <= 0 && d4 >= d3 && d5 >= d6 && (d4 - d3) + (d5 - d6) > 0) {
    q = bp - (c - b) * ((d4 - d3) / ((d4 - d3) + (d5 - d6)));
  } else if (va + vb + vc > 0) {
    q = ap - ab * (vb / (va + vb + vc)) - ac * (vc / (va + vb + vc));
  }
  return dot(q, q);
}

// The distance as a float that is not above it: the error of the square root, of rounding to float and of
// squared_distance() together stay below 2^-20 of it.
inline float distance_bound(double squared) { return static_cast<float>(std::sqrt(squared) * (1 - 0x1p-20)); }

}  // namespace pocketray
