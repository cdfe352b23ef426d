// The triangles of a leaf as they appear in the plane at depth 1, four at a time. Part of the kernels: see
// bvh_packet.h.
#pragma once
#include <limits>

#include "accel/triangle.h"
#include "base/simd.h"

namespace pocketray {
inline namespace POCKETRAY_ISA {

constexpr float kPacketSlack = 0x1p-20f;
constexpr float kInfinity = std::numeric_limits<float>::infinity();

// A rectangle of the plane, slack included.
struct Window {
  float x_low, x_high, y_low, y_high;
};

// Four of them, with their centres and half sizes.
struct alignas(16) Windows4 {
  float x_low[4], x_high[4], y_low[4], y_high[4], x[4], y[4], half_x[4], half_y[4];
};
inline void set_window(Windows4* w, int i, const Window& window) {
  w->x_low[i] = window.x_low, w->x_high[i] = window.x_high, w->y_low[i] = window.y_low, w->y_high[i] = window.y_high;
  w->x[i] = (window.x_low + window.x_high) * 0.5f, w->y[i] = (window.y_low + window.y_high) * 0.5f;
  w->half_x[i] = (window.x_high - window.x_low) * 0.5f, w->half_y[i] = (window.y_high - window.y_low) * 0.5f;
}

struct LeafProjection {
  alignas(16) float x[3][4], y[3][4], depth[3][4];                      // vertices relative to the origin
  alignas(16) float x_low[4], x_high[4], y_low[4], y_high[4], near[4];  // bounds of the projections
  unsigned behind;  // lanes with a vertex at or behind the origin: their projection has no bounds
  Window bounds;    // of the triangles that may meet the window, if none is behind
  bool has_edges;
  alignas(16) float edge_x[3][4], edge_y[3][4], edge_z[3][4], edge_error[3][4];
};

// Fills the projection but for its edges; returns the mask of the triangles that may meet the window no deeper than
// `far`.
inline unsigned project_leaf(const TriangleBlock& block, int kx, int ky, int kz, const Vec3& origin, float direction,
                             const Window& window, float far, LeafProjection* leaf) {
  Float4 ox = Float4::splat(origin[kx]), oy = Float4::splat(origin[ky]), oz = Float4::splat(origin[kz]);
  Float4 sign = Float4::splat(direction), tiny = Float4::splat(std::numeric_limits<float>::min());
  Float4 px[3], py[3], depth[3];
  for (int i = 0; i < 3; ++i) {
    Float4 x = Float4::load(block.vertex[i][kx]) - ox, y = Float4::load(block.vertex[i][ky]) - oy;
    depth[i] = (Float4::load(block.vertex[i][kz]) - oz) * sign;
    store(leaf->x[i], x), store(leaf->y[i], y), store(leaf->depth[i], depth[i]);
    Float4 inverse = Float4::splat(1) / max(depth[i], tiny);
    px[i] = x * inverse, py[i] = y * inverse;
  }
  Float4 near = min(min(depth[0], depth[1]), depth[2]), deepest = max(max(depth[0], depth[1]), depth[2]);
  Float4 x_low = min(min(px[0], px[1]), px[2]), x_high = max(max(px[0], px[1]), px[2]);
  Float4 y_low = min(min(py[0], py[1]), py[2]), y_high = max(max(py[0], py[1]), py[2]);
  store(leaf->x_low, x_low), store(leaf->x_high, x_high), store(leaf->y_low, y_low), store(leaf->y_high, y_high);
  store(leaf->near, near);
  leaf->has_edges = false;
  Mask4 behind = near <= tiny;
  leaf->behind = bits(behind);
  Mask4 met = (x_low <= Float4::splat(window.x_high)) & (Float4::splat(window.x_low) <= x_high) &
              (y_low <= Float4::splat(window.y_high)) & (Float4::splat(window.y_low) <= y_high);
  Mask4 alive = (met | behind) & (Float4::splat(0) < deepest) & (near <= Float4::splat(far));
  unsigned lanes = bits(alive);
  if (lanes) {
    Float4 infinity = Float4::splat(kInfinity), minus = Float4::splat(-kInfinity);
    leaf->bounds = {lowest(select(alive, x_low, infinity)), highest(select(alive, x_high, minus)),
                    lowest(select(alive, y_low, infinity)), highest(select(alive, y_high, minus))};
  }
  return lanes;
}

// The lines of the edges: N·(q, 1) is the edge function of a ray q, where N is the cross product of two vertices. The
// decision about a ray is exact for vertices that are off by up to 4u(|x| + |y| + 2|z|) = 4uM; products and sums here
// err by less than that again: 2^-18 M M' covers both.
inline void find_edges(LeafProjection* leaf) {
  Float4 x[3], y[3], z[3], size[3];
  for (int i = 0; i < 3; ++i) {
    x[i] = Float4::load(leaf->x[i]), y[i] = Float4::load(leaf->y[i]), z[i] = Float4::load(leaf->depth[i]);
    size[i] = abs(x[i]) + abs(y[i]) + (abs(z[i]) + abs(z[i]));
  }
  for (int i = 0; i < 3; ++i) {
    int j = i == 2 ? 0 : i + 1;
    store(leaf->edge_x[i], y[i] * z[j] - z[i] * y[j]);
    store(leaf->edge_y[i], z[i] * x[j] - x[i] * z[j]);
    store(leaf->edge_z[i], x[i] * y[j] - y[i] * x[j]);
    store(leaf->edge_error[i], size[i] * size[j] * Float4::splat(0x1p-18f));
  }
  leaf->has_edges = true;
}

// One lane of the projection, in all lanes.
struct Bounds4 {
  Float4 x_low, x_high, y_low, y_high, near;
};
inline Bounds4 splat_bounds(const LeafProjection& leaf, int lane) {
  return {Float4::splat(leaf.x_low[lane]), Float4::splat(leaf.x_high[lane]), Float4::splat(leaf.y_low[lane]),
          Float4::splat(leaf.y_high[lane]), Float4::splat(leaf.near[lane])};
}
inline Mask4 meets(const Bounds4& b, const Windows4& w) {
  return (b.x_low <= Float4::load(w.x_high)) & (Float4::load(w.x_low) <= b.x_high) &
         (b.y_low <= Float4::load(w.y_high)) & (Float4::load(w.y_low) <= b.y_high);
}

struct Edges4 {
  Float4 x[3], y[3], z[3], error[3];
};
inline Edges4 splat_edges(const LeafProjection& leaf, int lane) {
  Edges4 e;
  for (int i = 0; i < 3; ++i) {
    e.x[i] = Float4::splat(leaf.edge_x[i][lane]), e.y[i] = Float4::splat(leaf.edge_y[i][lane]);
    e.z[i] = Float4::splat(leaf.edge_z[i][lane]), e.error[i] = Float4::splat(leaf.edge_error[i][lane]);
  }
  return e;
}
// Mask of the windows with a point whose edge functions may agree in sign; *inside are those where they surely do, all
// over the window.
inline unsigned cross_windows(const Edges4& e, const Windows4& w, unsigned* inside) {
  Float4 x = Float4::load(w.x), y = Float4::load(w.y), half_x = Float4::load(w.half_x), half_y = Float4::load(w.half_y);
  Float4 low_min = Float4::splat(kInfinity), low_max = Float4::splat(-kInfinity), high_min = low_min,
         high_max = low_max;
  for (int i = 0; i < 3; ++i) {
    Float4 middle = e.x[i] * x + e.y[i] * y + e.z[i];
    Float4 radius = abs(e.x[i]) * half_x + abs(e.y[i]) * half_y + e.error[i];
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
