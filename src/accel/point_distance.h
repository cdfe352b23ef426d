// Distance from a point to a triangle.
#pragma once
#include "base/box.h"

namespace pocketray {

// Squared distance from p to the triangle a, b, c, in double [Ericson 2005, Real-Time Collision Detection, sec. 5.1.5],
// by the Voronoi region that contains p: corner, edge or face. Over the face it is the distance to the plane.
inline double squared_distance(const Vec3d& p, const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  Vec3d ab = b - a, ac = c - a, ap = p - a, bp = p - b, cp = p - c;
  double d1 = dot(ab, ap), d2 = dot(ac, ap), d3 = dot(ab, bp), d4 = dot(ac, bp), d5 = dot(ab, cp), d6 = dot(ac, cp);
  Vec3d q;  // from the nearest point of the triangle to p
  if (d1 <= 0 && d2 <= 0) {
    q = ap;
  } else if (d3 >= 0 && d4 <= d3) {
    q = bp;
  } else if (d6 >= 0 && d5 <= d6) {
    q = cp;
  } else if (d1 * d4 - d3 * d2 <= 0 && d1 >= 0 && d3 <= 0 && d1 > d3) {
    q = ap - ab * (d1 / (d1 - d3));
  } else if (d5 * d2 - d1 * d6 <= 0 && d2 >= 0 && d6 <= 0 && d2 > d6) {
    q = ap - ac * (d2 / (d2 - d6));
  } else if (d3 * d6 - d5 * d4 <= 0 && d4 >= d3 && d5 >= d6 && (d4 - d3) + (d5 - d6) > 0) {
    q = bp - (c - b) * ((d4 - d3) / ((d4 - d3) + (d5 - d6)));
  } else {
    Vec3d n = cross(ab, ac);
    q = n * (dot(n, ap) / dot(n, n));
  }
  return dot(q, q);
}

// The distance as a float not above the true one, given the bounds of the triangles. The rounding error of
// squared_distance() is largest for a sliver whose regions it confuses: w of its length for one of width w, as long as
// w² < 2^-52; so 2^-26 of the bounds' extent, and 2^-24 is safe. A factor of 2^-20 covers rounding to float.
inline float distance_bound(double squared, const Box& bounds) {
  if (is_empty(bounds)) return std::numeric_limits<float>::infinity();
  double bound = std::sqrt(squared) * (1 - 0x1p-20) - max_component(extent(bounds)) * 0x1p-24;
  return bound > 0 ? static_cast<float>(bound) : 0;
}

}  // namespace pocketray
