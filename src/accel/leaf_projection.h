// The triangles of a leaf projected to the plane at depth 1, four at a time. Part of the kernels: see bvh_packet.h.
#pragma once
#include "accel/packet.h"
#include "accel/triangle.h"

namespace pocketray {
inline namespace POCKETRAY_ISA {

// Edge lines: x·qx + y·qy + z is the edge function of a ray q, up to its error.
struct EdgeLines {
  alignas(16) float x[3][4], y[3][4], z[3][4];
};

struct LeafProjection {
  unsigned lanes;   // triangles that may meet the packet's window
  unsigned behind;  // with a vertex at or behind the origin: their projection is unbounded
  Window bounds;    // of all lanes together, if none is behind
  float nearest;    // depth of the nearest lane
  alignas(16) float x_low[4], x_high[4], y_low[4], y_high[4], near[4];
  alignas(16) float x[3][4], y[3][4], depth[3][4];  // vertices relative to the origin
  bool has_edges;
  EdgeLines edge;
  alignas(16) float error[4];
};

// Bound on the error of an edge function, here or in the decision of cross_triangle(). With u = 2^-24, that decision is
// exact for vertices displaced by less than 4uM, M = |x| + |y| + 2|z|, and the vertices here are displaced by less than
// that, so the value errs by 16u M S, where S bounds |x| + |y| as seen from any ray of the window; sums and products
// add 8u S². The constant covers underflow: it is absolute, but can only leave more decisions to cross_triangle().
inline Float4 edge_error(const Packet& p, const Float4 (&x)[3], const Float4 (&y)[3], const Float4 (&depth)[3]) {
  Float4 aside = max(max(abs(x[0]) + abs(y[0]), abs(x[1]) + abs(y[1])), abs(x[2]) + abs(y[2]));
  Float4 along = max(max(abs(depth[0]), abs(depth[1])), abs(depth[2]));
  Float4 s = aside + along * (p.half4[0] + p.half4[1]), m = aside + along * Float4::splat(4);
  return s * m * Float4::splat(0x1p-19f) + Float4::splat(kUnderflow);
}

// Computes everything but the edges.
inline void project_leaf(const Packet& p, const TriangleBlock& block, LeafProjection* leaf) {
  const Float4 tiny = Float4::splat(std::numeric_limits<float>::min());
  Float4 px[3], py[3], depth[3];
  for (int i = 0; i < 3; ++i) {
    depth[i] = (Float4::load(block.vertex[i][p.kz]) - p.origin4[2]) * p.sign4;
    Float4 x = Float4::load(block.vertex[i][p.kx]) - p.origin4[0];
    Float4 y = Float4::load(block.vertex[i][p.ky]) - p.origin4[1];
    store(leaf->x[i], x), store(leaf->y[i], y), store(leaf->depth[i], depth[i]);
    Float4 inverse = reciprocal(max(depth[i], tiny));
    px[i] = x * inverse, py[i] = y * inverse;
  }
  Float4 near = min(min(depth[0], depth[1]), depth[2]), deepest = max(max(depth[0], depth[1]), depth[2]);
  Float4 x_low = min(min(px[0], px[1]), px[2]), x_high = max(max(px[0], px[1]), px[2]);
  Float4 y_low = min(min(py[0], py[1]), py[2]), y_high = max(max(py[0], py[1]), py[2]);
  Mask4 behind = near <= tiny;
  Mask4 met = (x_low <= p.window4[1]) & (p.window4[0] <= x_high) & (y_low <= p.window4[3]) & (p.window4[2] <= y_high);
  Mask4 alive = (met | behind) & (Float4::splat(0) < deepest);
  leaf->lanes = bits(alive);
  leaf->behind = bits(behind & alive), leaf->has_edges = false;
  store(leaf->x_low, x_low), store(leaf->x_high, x_high), store(leaf->y_low, y_low), store(leaf->y_high, y_high);
  store(leaf->near, near);
  Float4 infinity = Float4::splat(kInfinity), minus = Float4::splat(-kInfinity);
  leaf->bounds = {lowest(select(alive, x_low, infinity)), highest(select(alive, x_high, minus)),
                  lowest(select(alive, y_low, infinity)), highest(select(alive, y_high, minus))};
  leaf->nearest = lowest(select(alive, near, infinity));
}

// Computes the edges, as seen from the middle of the window.
inline void find_edges(const Packet& p, LeafProjection* leaf) {
  Float4 x[3], y[3], depth[3];
  for (int i = 0; i < 3; ++i) {
    depth[i] = Float4::load(leaf->depth[i]);
    x[i] = Float4::load(leaf->x[i]) - p.middle4[0] * depth[i];
    y[i] = Float4::load(leaf->y[i]) - p.middle4[1] * depth[i];
  }
  for (int i = 0; i < 3; ++i) {
    int j = i == 2 ? 0 : i + 1;
    store(leaf->edge.x[i], y[i] * depth[j] - depth[i] * y[j]);
    store(leaf->edge.y[i], depth[i] * x[j] - x[i] * depth[j]);
    store(leaf->edge.z[i], x[i] * y[j] - y[i] * x[j]);
  }
  store(leaf->error, edge_error(p, x, y, depth));
  leaf->has_edges = true;
}

// Smallest and largest of three edge functions.
template <class F>
struct EdgeRange {
  F low, high;
};

// Masks of the lanes that may be hits and of the lanes that certainly are.
struct Passing {
  unsigned pass, sure;
};
// Classifies edge functions with an error up to `error`; `alive` are the lanes in question.
template <class F, class Mask>
inline Passing judge(const EdgeRange<F>& e, F error, Mask alive) {
  F minus = F::splat(0) - error;
  unsigned pass = bits(((minus <= e.low) | (e.high <= error)) & alive);
  return {pass, pass ? bits((error < e.low) | (e.high < minus)) : 0};
}

template <class F>
struct EdgeLine {
  F x, y, z;
};
template <class F>
inline EdgeRange<F> edge_range(const EdgeLine<F> (&line)[3], F qx, F qy) {
  F e[3];
  for (int i = 0; i < 3; ++i) e[i] = line[i].x * qx + line[i].y * qy + line[i].z;
  return {min(min(e[0], e[1]), e[2]), max(max(e[0], e[1]), e[2])};
}

// One triangle of the projection, broadcast to all lanes.
template <class F>
struct SplatTriangle {
  EdgeLine<F> line[3];
  F error, near;
};
template <class F>
inline SplatTriangle<F> splat_triangle(const LeafProjection& leaf, int lane) {
  SplatTriangle<F> t;
  for (int i = 0; i < 3; ++i)
    t.line[i] = {F::splat(leaf.edge.x[i][lane]), F::splat(leaf.edge.y[i][lane]), F::splat(leaf.edge.z[i][lane])};
  t.error = F::splat(leaf.error[lane]), t.near = F::splat(leaf.near[lane]);
  return t;
}

// Four rectangles.
struct Bounds4 {
  Float4 x_low, x_high, y_low, y_high;
};
inline Mask4 meets(const Bounds4& b, const Windows4& w) {
  return (b.x_low <= Float4::load(w.x_high)) & (Float4::load(w.x_low) <= b.x_high) &
         (b.y_low <= Float4::load(w.y_high)) & (Float4::load(w.y_low) <= b.y_high);
}

// Mask of the windows in which the triangle may be hit at some point; *inside: those certainly hit at every point.
inline unsigned cross_windows(const Packet& p, const SplatTriangle<Float4>& t, const Windows4& w, unsigned* inside) {
  Float4 x = Float4::load(w.x) - p.middle4[0], y = Float4::load(w.y) - p.middle4[1], half_x = Float4::load(w.half_x),
         half_y = Float4::load(w.half_y);
  Float4 low_min = Float4::splat(kInfinity), low_max = Float4::splat(-kInfinity), high_min = low_min,
         high_max = low_max;
  for (const EdgeLine<Float4>& line : t.line) {
    Float4 middle = line.x * x + line.y * y + line.z;
    Float4 radius = abs(line.x) * half_x + abs(line.y) * half_y + t.error;
    Float4 low = middle - radius, high = middle + radius;
    low_min = min(low_min, low), low_max = max(low_max, low);
    high_min = min(high_min, high), high_max = max(high_max, high);
  }
  Float4 zero = Float4::splat(0);
  *inside = bits((zero < low_min) | (high_max < zero));
  return bits((zero <= high_min) | (low_max <= zero));
}

}  // namespace POCKETRAY_ISA
}  // namespace pocketray
