// Rays from one point walk the BVH together. Part of the kernels: see bvh_kernels.h.
//
// Seen along the dominant axis of their directions the rays are points q of the plane at depth 1, |q| ≤ 1, and so is
// everything they can hit: a box is entered if it meets the pyramid over the window that holds the points, and a
// triangle is tested with those groups of four rays alone whose window it meets. These tests only exclude (or include
// where nothing is in doubt); the rest is decided by the arithmetic of intersect_triangle() on several rays at once, so
// the answers are those of single rays, bit for bit.
//
// How far the exclusions are slackened: intersect_triangle() takes a ray for a hit that passes the triangle by up to
// 4u of the depth z at which its vertices lie (u = 2^-24: the shear, two products, a difference), that is by 4u in the
// plane. The projections and the pyramid round by a few u more. 16u = 2^-20 covers both.
#pragma once
#include <limits>

#include "accel/bvh.h"
#include "accel/leaf_projection.h"
#include "base/simd.h"

namespace pocketray {
inline namespace POCKETRAY_ISA {

// The rays of a packet that share dominant axis and sign of direction, and how far they have come. A group is four
// rays, a block four groups.
struct Packet {
  int kx, ky, kz;
  float sign;  // of the directions along kz
  Vec3 origin;
  float t_max;
  const HitFilter* filter;
  const float *direction_x, *direction_y, *direction_z;  // by kx, ky, kz
  const std::uint8_t* place;                             // of a ray in the caller's arrays
  int count;
  bool has_windows;
  Window window;                                   // of all rays
  float all_far;                                   // bound on the depth of a hit that would count, for any ray
  alignas(64) float x[kPacketMax], y[kPacketMax];  // q: the shears of the ray, times sign
  alignas(64) float far[kPacketMax];               // that bound for every ray; −∞ for what pads the last group
  // The nearest hits so far; t is t_max and triangle kNoTriangle where there is none.
  alignas(64) float t[kPacketMax], u[kPacketMax], v[kPacketMax];
  alignas(64) std::uint32_t triangle[kPacketMax];
  alignas(64) float group_far[kPacketMax / 4];
  Windows4 block, group[4];
};

// Depth that no hit at t exceeds, along a direction of that component.
inline float depth_bound(float t, float direction_z) {
  return (t + std::numeric_limits<float>::denorm_min()) * std::fabs(direction_z) * (1 + kPacketSlack);
}

// Shears, bounds and the window of all rays, from directions that are in place; count is a multiple of four.
inline void prepare_packet(Packet* p) {
  Float4 x_low = Float4::splat(kInfinity), x_high = Float4::splat(-kInfinity), y_low = x_low, y_high = x_high;
  Float4 sign = Float4::splat(p->sign), far = x_high;
  Float4 t_max = Float4::splat(p->t_max);
  for (std::uint32_t& triangle : p->triangle) triangle = kNoTriangle;
  Float4 reach = Float4::splat((p->t_max + std::numeric_limits<float>::denorm_min()) * (1 + kPacketSlack));
  for (int i = 0; i < p->count; i += 4) {
    Float4 dz = Float4::load(p->direction_z + i);
    Float4 x = Float4::load(p->direction_x + i) / dz * sign, y = Float4::load(p->direction_y + i) / dz * sign;
    Float4 bound = reach * (dz * sign);
    store(p->x + i, x), store(p->y + i, y);
    x_low = min(x_low, x), x_high = max(x_high, x), y_low = min(y_low, y), y_high = max(y_high, y);
    far = max(far, bound);
    store(p->far + i, bound);
    store(p->t + i, t_max);
  }
  p->window = {lowest(x_low) - kPacketSlack, highest(x_high) + kPacketSlack, lowest(y_low) - kPacketSlack,
               highest(y_high) + kPacketSlack};
  p->all_far = highest(far);
  p->has_windows = false;
}

// Windows of groups and blocks, made when the first leaf is met.
inline void frame_groups(Packet* p) {
  p->has_windows = true;
  for (int g = 0; g < static_cast<int>(kPacketMax) / 4; ++g) {
    Windows4& w = p->group[g / 4];
    if (4 * g >= p->count) {
      set_window(&w, g % 4, {2, 2, 2, 2});
      p->group_far[g] = -kInfinity;
      continue;
    }
    Float4 x = Float4::load(p->x + 4 * g), y = Float4::load(p->y + 4 * g);
    set_window(
        &w, g % 4,
        {lowest(x) - kPacketSlack, highest(x) + kPacketSlack, lowest(y) - kPacketSlack, highest(y) + kPacketSlack});
    p->group_far[g] = highest(Float4::load(p->far + 4 * g));
  }
  for (int b = 0; b < 4; ++b) {
    const Windows4& w = p->group[b];
    set_window(&p->block, b,
               {lowest(Float4::load(w.x_low)), highest(Float4::load(w.x_high)), lowest(Float4::load(w.y_low)),
                highest(Float4::load(w.y_high))});
  }
}

// Mask of the children that the pyramid meets no deeper than it has to look; `depth` gets where they begin.
inline unsigned enter_boxes(const Packet& p, const BvhNode& node, float* depth) {
  int near_z = p.sign < 0 ? 3 + p.kz : p.kz, far_z = p.sign < 0 ? p.kz : 3 + p.kz;
  Float4 sign = Float4::splat(p.sign), oz = Float4::splat(p.origin[p.kz]);
  Float4 ox = Float4::splat(p.origin[p.kx]), oy = Float4::splat(p.origin[p.ky]), zero = Float4::splat(0);
  Float4 near = max((Float4::load(node.bounds[near_z]) - oz) * sign, zero);
  Float4 far = (Float4::load(node.bounds[far_z]) - oz) * sign;
  Float4 x_low = Float4::load(node.bounds[p.kx]) - ox, x_high = Float4::load(node.bounds[3 + p.kx]) - ox;
  Float4 y_low = Float4::load(node.bounds[p.ky]) - oy, y_high = Float4::load(node.bounds[3 + p.ky]) - oy;
  Float4 wx_low = Float4::splat(p.window.x_low), wx_high = Float4::splat(p.window.x_high);
  Float4 wy_low = Float4::splat(p.window.y_low), wy_high = Float4::splat(p.window.y_high);
  Float4 a = x_high - min(wx_low * near, wx_low * far), b = max(wx_high * near, wx_high * far) - x_low;
  Float4 c = y_high - min(wy_low * near, wy_low * far), d = max(wy_high * near, wy_high * far) - y_low;
  store(depth, near);
  Float4 inside = min(min(a, b), min(c, d)) + far * Float4::splat(kPacketSlack);
  return bits((zero <= inside) & (near <= Float4::splat(p.all_far)) & (zero <= far));
}

// Mask of the groups that may hit the triangle in a lane of the leaf; *sure are those of which every ray passes.
inline unsigned meet_groups(const Packet& p, LeafProjection* leaf, int lane, unsigned* sure) {
  unsigned mask = 0;
  *sure = 0;
  bool bounded = !(leaf->behind >> lane & 1);
  Bounds4 bounds = splat_bounds(*leaf, lane);
  unsigned blocks = bounded ? bits(meets(bounds, p.block)) : 15;
  if (bounded && !(blocks & (blocks - 1))) {  // small
    if (!blocks) return 0;
    int b = __builtin_ctz(blocks);
    return bits(meets(bounds, p.group[b]) & (bounds.near <= Float4::load(p.group_far + 4 * b))) << 4 * b;
  }
  if (!leaf->has_edges) find_edges(leaf);
  Edges4 edges = splat_edges(*leaf, lane);
  unsigned inside;
  blocks &= cross_windows(edges, p.block, &inside);
  for (; blocks; blocks &= blocks - 1) {
    int b = __builtin_ctz(blocks);
    unsigned met = bits(bounds.near <= Float4::load(p.group_far + 4 * b));
    if (inside >> b & 1) {
      *sure |= met << 4 * b;
    } else {
      unsigned groups_inside;
      if (bounded) met &= bits(meets(bounds, p.group[b]));
      met &= cross_windows(edges, p.group[b], &groups_inside);
      *sure |= (met & groups_inside) << 4 * b;
    }
    mask |= met << 4 * b;
  }
  return mask;
}

// The triangle that is being decided about: its vertices relative to the origin, as floats for the decision and as
// doubles for the place of the hit.
struct Candidate {
  float x[3], y[3], depth[3];
  double exact_x[3], exact_y[3], exact_z[3];
  bool has_exact = false;
  float near;
  Vec3 vertex[3];
  std::uint32_t triangle;
};

inline void find_exact(const Packet& p, Candidate* c) {
  c->has_exact = true;
  double ox = p.origin[p.kx], oy = p.origin[p.ky], oz = p.origin[p.kz];
  for (int i = 0; i < 3; ++i) {
    const Vec3& v = c->vertex[i];
    c->exact_x[i] = v[p.kx] - ox, c->exact_y[i] = v[p.ky] - oy, c->exact_z[i] = v[p.kz] - oz;
  }
}

// The float test of intersect_triangle(): mask of the rays that pass, *doubtful are those with a zero edge function.
template <int kLanes>
unsigned test_rays(const Packet& p, const Candidate& c, int first, unsigned* doubtful) {
  using F = typename Lanes<kLanes>::Floats;
  F qx = F::load(p.x + first), qy = F::load(p.y + first), x[3], y[3];
  for (int i = 0; i < 3; ++i) {
    F depth = F::splat(c.depth[i]);
    x[i] = F::splat(c.x[i]) - qx * depth;
    y[i] = F::splat(c.y[i]) - qy * depth;
  }
  F a = x[2] * y[1] - y[2] * x[1];
  F b = x[0] * y[2] - y[0] * x[2];
  F e = x[1] * y[0] - y[1] * x[0];
  F zero = F::splat(0), low = min(min(a, b), e), high = max(max(a, b), e);
  unsigned pass = bits(((zero <= low) | (high <= zero)) & (F::splat(c.near) <= F::load(p.far + first)));
  *doubtful = pass & ~bits((zero < low) | (high < zero));
  return pass;
}

// Takes a hit at t with weights b and c of their sum, if it counts. Returns whether it did.
inline bool take_hit(Packet* p, int i, float t, double b, double c, double sum, std::uint32_t triangle) {
  if (!(t > 0 && (t < p->t[i] || (t == p->t[i] && triangle < p->triangle[i] && t < p->t_max)))) return false;
  float u = static_cast<float>(b / sum), v = static_cast<float>(c / sum);
  if (p->filter && !p->filter->accept(p->filter->context, triangle, u, v)) return false;
  p->t[i] = t, p->u[i] = u, p->v[i] = v, p->triangle[i] = triangle;
  p->far[i] = depth_bound(t, p->direction_z[i]);
  return true;
}

// One ray, decided by itself: where an edge function is zero or rounding makes decision and weights disagree.
inline bool settle_alone(Packet* p, const Candidate& c, int i) {
  ShearedRay ray = {p->origin, {}, p->kx, p->ky, p->kz, p->x[i] * p->sign, p->y[i] * p->sign};
  ray.direction[p->kx] = p->direction_x[i], ray.direction[p->ky] = p->direction_y[i];
  ray.direction[p->kz] = p->direction_z[i];
  Crossing crossing;
  if (!cross_triangle(ray, c.vertex[0], c.vertex[1], c.vertex[2], &crossing)) return false;
  return take_hit(p, i, crossing.t, crossing.b, crossing.c, crossing.sum, c.triangle);
}

// Finds where the rays of the mask, which all pass, cross the triangle: exact_weights() for several rays.
template <int kLanes>
bool settle_rays(Packet* p, Candidate* candidate, int first, unsigned mask, unsigned doubtful) {
  using D = typename Lanes<kLanes>::Doubles;
  using F = typename Lanes<kLanes>::Floats;
  if (!candidate->has_exact) find_exact(*p, candidate);
  const Candidate& k = *candidate;
  D dx = widen(F::load(p->direction_x + first)), dy = widen(F::load(p->direction_y + first));
  D dz = widen(F::load(p->direction_z + first)), x[3], y[3], z[3];
  for (int i = 0; i < 3; ++i) {
    z[i] = D::splat(k.exact_z[i]);
    x[i] = D::splat(k.exact_x[i]) * dz - z[i] * dx;
    y[i] = D::splat(k.exact_y[i]) * dz - z[i] * dy;
  }
  D a = x[2] * y[1] - y[2] * x[1], b = x[0] * y[2] - y[0] * x[2], c = x[1] * y[0] - y[1] * x[0];
  D zero = D::splat(0), low = min(min(a, b), c), high = max(max(a, b), c);
  auto proper = ((zero <= low) & (zero < high)) | ((high <= zero) & (low < zero));
  unsigned alone = mask & (doubtful | ~bits(proper));
  D sum = a + b + c, depth = a * z[0] + b * z[1] + c * z[2];
  D one = D::splat(1), divisor = select(proper, sum, one);
  F t = narrow(depth / (divisor * dz)), best = F::load(p->t + first);
  unsigned nearer = mask & ~alone & bits(F::splat(0) < t), equal = nearer & bits(t == best);
  nearer &= bits(t < best);
  if (p->filter) alone |= nearer | equal, nearer = equal = 0;
  alone |= equal;
  if (nearer) {
    Mask4 taken = mask_of(nearer);
    store(p->t + first, select(taken, t, best));
    store(p->u + first, select(taken, narrow(b / divisor), F::load(p->u + first)));
    store(p->v + first, select(taken, narrow(c / divisor), F::load(p->v + first)));
    F bound = (t + F::splat(std::numeric_limits<float>::denorm_min())) * abs(F::load(p->direction_z + first)) *
              F::splat(1 + kPacketSlack);
    store(p->far + first, select(taken, bound, F::load(p->far + first)));
    for (unsigned m = nearer; m; m &= m - 1) p->triangle[first + __builtin_ctz(m)] = k.triangle;
  }
  bool better = nearer != 0;
  for (; alone; alone &= alone - 1) better |= settle_alone(p, k, first + __builtin_ctz(alone));
  return better;
}

// Where one ray that passes crosses the triangle in a lane.
inline bool settle_ray(Packet* p, const TriangleBlock& block, int lane, int i, bool doubtful) {
  ShearedRay ray = {p->origin, {}, p->kx, p->ky, p->kz, p->x[i] * p->sign, p->y[i] * p->sign};
  ray.direction[p->kx] = p->direction_x[i], ray.direction[p->ky] = p->direction_y[i];
  ray.direction[p->kz] = p->direction_z[i];
  Vec3 a = block_vertex(block, 0, lane), b = block_vertex(block, 1, lane), c = block_vertex(block, 2, lane);
  Crossing crossing;
  if (!(doubtful ? cross_triangle(ray, a, b, c, &crossing) : locate_crossing(ray, a, b, c, &crossing))) return false;
  return take_hit(p, i, crossing.t, crossing.b, crossing.c, crossing.sum, block.triangle[lane]);
}

// Leaves that are small in the plane: each ray in their bounds against all four triangles.
// Returns false where the bounds hold many rays.
constexpr int kFewGroups = 4;
inline int find_groups(const Packet& p, const Window& w, int* groups) {
  Bounds4 bounds = {Float4::splat(w.x_low), Float4::splat(w.x_high), Float4::splat(w.y_low), Float4::splat(w.y_high),
                    Float4::splat(0)};
  int count = 0;
  for (unsigned blocks = bits(meets(bounds, p.block)); blocks; blocks &= blocks - 1) {
    int b = __builtin_ctz(blocks);
    for (unsigned g = bits(meets(bounds, p.group[b])); g; g &= g - 1) {
      if (count == kFewGroups) return count + 1;
      groups[count++] = 4 * b + __builtin_ctz(g);
    }
  }
  return count;
}

inline bool test_ray(Packet* p, const TriangleBlock& block, const LeafProjection& leaf, unsigned lanes, int i) {
  Float4 qx = Float4::splat(p->x[i]), qy = Float4::splat(p->y[i]), x[3], y[3];
  for (int k = 0; k < 3; ++k) {
    Float4 depth = Float4::load(leaf.depth[k]);
    x[k] = Float4::load(leaf.x[k]) - qx * depth;
    y[k] = Float4::load(leaf.y[k]) - qy * depth;
  }
  Float4 a = x[2] * y[1] - y[2] * x[1];
  Float4 b = x[0] * y[2] - y[0] * x[2];
  Float4 e = x[1] * y[0] - y[1] * x[0];
  Float4 zero = Float4::splat(0), low = min(min(a, b), e), high = max(max(a, b), e);
  unsigned pass =
      lanes & bits(((zero <= low) | (high <= zero)) & (Float4::load(leaf.near) <= Float4::splat(p->far[i])));
  if (!pass) return false;
  unsigned doubtful = ~bits((zero < low) | (high < zero));
  bool better = false;
  for (; pass; pass &= pass - 1) {
    int lane = __builtin_ctz(pass);
    better |= settle_ray(p, block, lane, i, doubtful >> lane & 1);
  }
  return better;
}

inline bool search_small_leaf(Packet* p, const TriangleBlock& block, const LeafProjection& leaf, unsigned lanes,
                              const int* groups, int group_count) {
  bool better = false;
  const Window& w = leaf.bounds;
  Float4 x_low = Float4::splat(w.x_low - kPacketSlack), x_high = Float4::splat(w.x_high + kPacketSlack);
  Float4 y_low = Float4::splat(w.y_low - kPacketSlack), y_high = Float4::splat(w.y_high + kPacketSlack);
  for (int n = 0; n < group_count; ++n) {
    int first = 4 * groups[n];
    Float4 x = Float4::load(p->x + first), y = Float4::load(p->y + first);
    bool group_better = false;
    for (unsigned rays = bits((x_low <= x) & (x <= x_high) & (y_low <= y) & (y <= y_high)); rays; rays &= rays - 1)
      group_better |= test_ray(p, block, leaf, lanes, first + __builtin_ctz(rays));
    if (!group_better) continue;
    p->group_far[groups[n]] = highest(Float4::load(p->far + first));
    better = true;
  }
  return better;
}

inline Candidate pick_candidate(const TriangleBlock& block, const LeafProjection& leaf, int lane) {
  Candidate c;
  for (int i = 0; i < 3; ++i) {
    c.x[i] = leaf.x[i][lane], c.y[i] = leaf.y[i][lane], c.depth[i] = leaf.depth[i][lane];
    c.vertex[i] = block_vertex(block, i, lane);
  }
  c.near = leaf.near[lane], c.triangle = block.triangle[lane];
  return c;
}

template <int kLanes>
void search_leaf(Packet* p, const TriangleBlock& block, std::uint32_t count) {
  constexpr int kGroups = kLanes / 4;
  constexpr unsigned kAll = (1u << kGroups) - 1;
  if (!p->has_windows) frame_groups(p);
  LeafProjection leaf;
  bool better = false;
  unsigned lanes = project_leaf(block, p->kx, p->ky, p->kz, p->origin, p->sign, p->window, p->all_far, &leaf);
  lanes &= (1u << count) - 1;
  int few[kFewGroups], few_count = lanes && !(leaf.behind & lanes) ? find_groups(*p, leaf.bounds, few) : kFewGroups + 1;
  if (few_count <= kFewGroups) {
    better = search_small_leaf(p, block, leaf, lanes, few, few_count);
    lanes = 0;
  }
  for (; lanes; lanes &= lanes - 1) {
    int lane = __builtin_ctz(lanes);
    unsigned sure, groups = meet_groups(*p, &leaf, lane, &sure);
    if (!groups) continue;
    Candidate candidate = pick_candidate(block, leaf, lane);
    while (groups) {
      int group = __builtin_ctz(groups) & ~(kGroups - 1);
      unsigned doubtful, mask = test_rays<kLanes>(*p, candidate, 4 * group, &doubtful);
      groups &= ~(kAll << group);
      if (!mask || !settle_rays<kLanes>(p, &candidate, 4 * group, mask, doubtful)) continue;
      for (int g = group; g < group + kGroups; ++g) p->group_far[g] = highest(Float4::load(p->far + 4 * g));
      better = true;
    }
  }
  if (!better) return;
  Float4 far = max(max(Float4::load(p->group_far), Float4::load(p->group_far + 4)),
                   max(Float4::load(p->group_far + 8), Float4::load(p->group_far + 12)));
  p->all_far = highest(far);
}

struct DepthEntry {
  std::uint32_t child;
  float depth;
};

template <int kLanes>
void search_packet(const Accel& accel, Packet* p, TraceStats* stats) {
  BvhView bvh(accel.data.data);
  std::uint64_t nodes = 0, triangles = 0;
  DepthEntry stack[3 * kBvhDepthMax + 4];
  int top = 0;
  stack[top++] = {0, 0};
  while (top > 0) {
    DepthEntry entry = stack[--top];
    if (!(entry.depth <= p->all_far)) continue;
    if (entry.child & kLeafBit) {
      std::uint32_t count = leaf_triangle_count(entry.child);
      triangles += count;
      search_leaf<kLanes>(p, bvh.leaves[entry.child & kLeafIndexMask], count);
      continue;
    }
    const BvhNode& node = bvh.nodes[entry.child];
    ++nodes;
    alignas(16) float depth[4];
    int first = top;
    for (unsigned mask = enter_boxes(*p, node, depth); mask; mask &= mask - 1) {
      int lane = __builtin_ctz(mask), place = top++;
      for (; place > first && stack[place - 1].depth < depth[lane]; --place) stack[place] = stack[place - 1];
      stack[place] = {node.child[lane], depth[lane]};
      prefetch(bvh, node.child[lane]);
    }
  }
  if (stats) stats->nodes += nodes, stats->triangles += triangles;
}

inline void write_hits(const Packet& p, int count, Hit* hits) {
  if (!p.has_windows) return;
  for (int i = 0; i < count; ++i)
    if (p.triangle[i] != kNoTriangle) hits[p.place[i]] = {p.t[i], p.u[i], p.v[i], p.triangle[i]};
}

}  // namespace POCKETRAY_ISA
}  // namespace pocketray
