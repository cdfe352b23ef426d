// Reconstructs illumination over a triangle from the value and the gradient at each corner: piecewise polynomials whose
// slope across an edge is linear along it, so that triangles that share the corners of an edge meet without a jump in
// value or slope (C¹) [Salesin, Lischinski, DeRose 1992, "Reconstructing Illumination Functions with Selected
// Discontinuities"]. Corners that do not share a value or gradient leave a discontinuity.
#pragma once
#include "base/vec3.h"

namespace pocketray {

// Corner i is followed by corner i + 1, counted around; edge k lies opposite corner k and leads from k + 1 to k + 2.
struct TriangleLight {
  Vec3 value[3];
  Vec3 to_next[3],
      to_previous[3];  // derivatives at a corner, along the whole edges to the next corner and the previous
  float slant[3];      // of edges, see slant_of()
};

constexpr int next_corner(int i) { return i == 2 ? 0 : i + 1; }
constexpr int previous_corner(int i) { return i == 0 ? 2 : i - 1; }

// Chosen: beyond this, a sliver would extrapolate slopes of its short edges over its length. Such edges are C⁰.
constexpr float kSlantMax = 2;

// Offset of the opposite corner along an edge, from its middle and in its lengths: the share of the slope along the
// edge in the slope towards that corner. Both elements stay within the range of the values and of the planes at the
// corners, half an edge away, as long as no corner lies beyond an edge (±½).
inline float slant_of(const Vec3& from, const Vec3& to, const Vec3& opposite) {
  const Vec3 edge = to - from;
  const float square = dot(edge, edge);
  if (!(square > 0)) return 0;
  const float slant = dot(opposite - (from + to) * 0.5f, edge) / square;
  return slant > -kSlantMax ? slant < kSlantMax ? slant : kSlantMax : -kSlantMax;
}

// Piecewise quadratic over the twelve parts between the medians and the lines joining the middles of edges [Powell,
// Sabin 1977, "Piecewise Quadratic Approximations on Triangles"]. Their element of six parts is C¹ only where its inner
// point is collinear with its neighbours'; this one needs no neighbour. As a sum: one quadratic, and for each of the
// six lines the square of the distance beyond it.
inline Vec3 quadratic_triangle(const TriangleLight& t, const float (&weight)[3]) {
  auto beyond = [](float distance) { return distance > 0 ? distance * distance : 0.0f; };
  // Kinks in the middle of each edge: of the slope along it, and of the slope across it that compensates.
  Vec3 along[3], across[3], near[3], median[3];
  for (int k = 0; k < 3; ++k) {
    const int i = next_corner(k), j = previous_corner(k);
    along[k] = (t.to_next[i] - t.to_previous[j]) * 2.0f - (t.value[j] - t.value[i]) * 4.0f;
    across[k] = along[k] * (-2 * t.slant[k]);
  }
  for (int i = 0; i < 3; ++i) near[i] = (across[next_corner(i)] + across[previous_corner(i)] - across[i]) * 0.5f;
  for (int k = 0; k < 3; ++k) median[k] = (near[previous_corner(k)] - near[next_corner(k)] - along[k]) * 0.25f;
  Vec3 sum = {0, 0, 0};
  for (int i = 0; i < 3; ++i) {
    const int next = next_corner(i), previous = previous_corner(i);
    // Bézier points of the quadratic, at the corner and on the edge to the next.
    const Vec3 corner = t.value[i] - near[i] * 0.25f - median[previous];
    const Vec3 edge = corner + (t.to_next[i] + near[i] + median[previous] * 4.0f) * 0.5f;
    sum += (corner * weight[i] + edge * (2 * weight[next])) * weight[i];
    sum += near[i] * beyond(weight[i] - 0.5f) + median[i] * beyond(weight[next] - weight[previous]);
  }
  return sum;
}

// Piecewise cubic over the three parts around the centre [Clough, Tocher 1965, "Finite element stiffness matrices for
// analysis of plates in bending"], in its reduced form, as Bézier triangles.
inline Vec3 cubic_triangle(const TriangleLight& t, const float (&weight)[3]) {
  Vec3 inner[3], middle[3], ring[3];  // between corner and centre; of parts; around the centre
  for (int i = 0; i < 3; ++i) inner[i] = t.value[i] + (t.to_next[i] + t.to_previous[i]) * (1.0f / 9);
  for (int k = 0; k < 3; ++k) {
    const int i = next_corner(k), j = previous_corner(k);
    const Vec3 &ahead = t.to_next[i], &back = t.to_previous[j];
    middle[k] = (inner[i] + inner[j]) * 0.5f + (ahead + back) * (1.0f / 12) +
                (t.value[j] - t.value[i] + (back - ahead) * 0.5f) * (t.slant[k] * (1.0f / 3));
  }
  for (int i = 0; i < 3; ++i) ring[i] = (inner[i] + middle[next_corner(i)] + middle[previous_corner(i)]) * (1.0f / 3);
  int k = weight[1] < weight[0] ? 1 : 0;
  if (weight[2] < weight[k]) k = 2;
  const int i = next_corner(k), j = previous_corner(k);
  const float a = weight[i] - weight[k], b = weight[j] - weight[k], c = 3 * weight[k];
  const Vec3 from_i = t.value[i] + t.to_next[i] * (1.0f / 3), from_j = t.value[j] + t.to_previous[j] * (1.0f / 3);
  const Vec3 centre = (ring[0] + ring[1] + ring[2]) * (1.0f / 3);
  return (t.value[i] * a + (from_i * b + inner[i] * c) * 3.0f) * (a * a) +
         (t.value[j] * b + (from_j * a + inner[j] * c) * 3.0f) * (b * b) +
         (middle[k] * (2 * a * b) + (ring[i] * a + ring[j] * b) * c) * (3 * c) + centre * (c * c * c);
}

}  // namespace pocketray
