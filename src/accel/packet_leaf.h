// Tests the rays of a packet against one triangle. Part of the kernels: see bvh_packet.h.
//
// Windows and edge lines tell which rays certainly miss a triangle and which certainly hit it; cross_triangle() decides
// the others, close to an edge. Hits are located with single-ray arithmetic, for several rays at once. So the answers
// equal those of single rays bit for bit.
#pragma once
#include "accel/leaf_projection.h"

namespace pocketray {
inline namespace POCKETRAY_ISA {

// A triangle's vertices relative to the origin, as doubles.
struct ExactTriangle {
  double x[3], y[3], z[3];
  double reach;  // largest |z|
};
inline ExactTriangle exact_triangle(const Packet& p, const TriangleBlock& block, int lane) {
  ExactTriangle k;
  double ox = p.origin[p.kx], oy = p.origin[p.ky], oz = p.origin[p.kz];
  for (int i = 0; i < 3; ++i) {
    k.x[i] = block.vertex[i][p.kx][lane] - ox, k.y[i] = block.vertex[i][p.ky][lane] - oy;
    k.z[i] = block.vertex[i][p.kz][lane] - oz;
  }
  const double a = std::fabs(k.z[0]), b = std::fabs(k.z[1]), c = std::fabs(k.z[2]), farther = a > b ? a : b;
  k.reach = farther > c ? farther : c;
  return k;
}

template <class D>
inline D all_lanes(double x) {
  return D::splat(x);
}
template <>
inline double all_lanes<double>(double x) {
  return x;
}

// exact_weights() of triangle.h, and the parts of t: t = depth / (sum · direction_z).
template <class D>
struct Location {
  EdgeValues<D> weight;
  D sum, depth;
};
template <class D>
inline Location<D> locate(const ExactTriangle& k, D dx, D dy, D dz) {
  D x[3], y[3], z[3];
  for (int i = 0; i < 3; ++i) {
    z[i] = all_lanes<D>(k.z[i]);
    x[i] = all_lanes<D>(k.x[i]) * dz - z[i] * dx;
    y[i] = all_lanes<D>(k.y[i]) * dz - z[i] * dy;
  }
  EdgeValues<D> w = edge_values<D>(x[0], y[0], x[1], y[1], x[2], y[2]);
  return {w, w.a + w.b + w.c, w.a * z[0] + w.b * z[1] + w.c * z[2]};
}

// Takes a hit at t if it counts; b and c are the unnormalised weights. Returns whether it did.
inline bool take_hit(Packet* p, int i, float t, double b, double c, double sum, std::uint32_t triangle) {
  if (!(t > 0 && (t < p->t[i] || (t == p->t[i] && triangle < p->triangle[i] && t < p->t_max)))) return false;
  float u = static_cast<float>(b / sum), v = static_cast<float>(c / sum);
  if (p->filter && !p->filter->accept(p->filter->context, triangle, u, v)) return false;
  p->t[i] = t, p->u[i] = u, p->v[i] = v, p->triangle[i] = triangle;
  p->far[i] = depth_bound(t, p->direction_z[i]);
  return true;
}

// Tests one ray against one triangle in full: close to an edge, or if rounding makes decision and weights
// disagree.
inline bool settle_doubtful(Packet* p, const TriangleBlock& block, int lane, int i) {
  float dx = p->direction_x[i], dy = p->direction_y[i], dz = p->direction_z[i];
  ShearedRay ray = {p->origin, {}, p->kx, p->ky, p->kz, dx / dz, dy / dz};
  ray.direction[p->kx] = dx, ray.direction[p->ky] = dy, ray.direction[p->kz] = dz;
  Crossing crossing;
  if (!cross_triangle(ray, block_vertex(block, 0, lane), block_vertex(block, 1, lane), block_vertex(block, 2, lane),
                      &crossing))
    return false;
  return take_hit(p, i, crossing.t, crossing.b, crossing.c, crossing.sum, block.triangle[lane]);
}

// Settles one ray that certainly hits the triangle in a lane.
inline bool settle_ray(Packet* p, const TriangleBlock& block, int lane, int i) {
  double dz = p->direction_z[i];
  const ExactTriangle k = exact_triangle(*p, block, lane);
  Location<double> at = locate<double>(k, p->direction_x[i], p->direction_y[i], dz);
  if (signs_differ(at.weight) || all_zero(at.weight)) return settle_doubtful(p, block, lane, i);
  float t = static_cast<float>(at.depth / (at.sum * dz));
  if (is_close_hit(t, p->direction_z[i], k.z[0], k.z[1], k.z[2])) return settle_doubtful(p, block, lane, i);
  return take_hit(p, i, t, at.weight.b, at.weight.c, at.sum, block.triangle[lane]);
}

// Settles several rays: those in the mask pass, and certainly hit unless doubtful.
template <int kLanes>
bool settle_rays(Packet* p, const TriangleBlock& block, int lane, const ExactTriangle& k, int first, unsigned mask,
                 unsigned doubtful) {
  using D = typename Lanes<kLanes>::Doubles;
  using F = typename Lanes<kLanes>::Floats;
  F direction_z = F::load(p->direction_z + first);
  D dz = widen(direction_z);
  Location<D> at = locate<D>(k, widen(F::load(p->direction_x + first)), widen(F::load(p->direction_y + first)), dz);
  D zero = D::splat(0), a = at.weight.a, b = at.weight.b, c = at.weight.c;
  D low = min(min(a, b), c), high = max(max(a, b), c);
  auto proper = ((zero <= low) & (zero < high)) | ((high <= zero) & (low < zero));  // signs agree, not all zero
  D sum = select(proper, at.sum, D::splat(1));
  F t = narrow(at.depth / (sum * dz)), best = F::load(p->t + first);
  // Close hits as in is_close_hit(), or slightly beyond: these are settled one by one.
  const F close = F::splat(2 * kCloseHit * static_cast<float>(k.reach));
  unsigned alone = mask & (doubtful | ~bits(proper) | bits(abs(t * direction_z) < close));
  unsigned ahead = mask & ~alone & bits(F::splat(0) < t), nearer = ahead & bits(t < best);
  alone |= ahead & bits(t == best);
  if (p->filter) alone |= nearer, nearer = 0;
  if (nearer) {
    auto taken = F::mask_of(nearer);
    store(p->t + first, select(taken, t, best));
    store(p->u + first, select(taken, narrow(b / sum), F::load(p->u + first)));
    store(p->v + first, select(taken, narrow(c / sum), F::load(p->v + first)));
    store(p->far + first, select(taken, depth_bound(t, direction_z), F::load(p->far + first)));
    for (unsigned m = nearer; m; m &= m - 1) p->triangle[first + __builtin_ctz(m)] = block.triangle[lane];
  }
  bool better = nearer != 0;
  for (; alone; alone &= alone - 1) better |= settle_doubtful(p, block, lane, first + __builtin_ctz(alone));
  return better;
}

template <int kLanes>
void search_triangle(Packet* p, const TriangleBlock& block, LeafProjection* projection, int lane) {
  using F = typename Lanes<kLanes>::Floats;
  constexpr int kGroups = kLanes / 4;
  if (!projection->has_edges) find_edges(*p, projection);
  const LeafProjection& leaf = *projection;
  bool bounded = !(leaf.behind >> lane & 1), has_exact = false;
  Bounds4 bounds = {Float4::splat(leaf.x_low[lane]), Float4::splat(leaf.x_high[lane]), Float4::splat(leaf.y_low[lane]),
                    Float4::splat(leaf.y_high[lane])};
  SplatTriangle<Float4> narrow_triangle = splat_triangle<Float4>(leaf, lane);
  SplatTriangle<F> triangle = splat_triangle<F>(leaf, lane);
  ExactTriangle exact;
  unsigned inside = 0, blocks = bounded ? bits(meets(bounds, p->block)) : 15;
  if (blocks & (blocks - 1)) blocks &= cross_windows(*p, narrow_triangle, p->block, &inside);
  for (; blocks; blocks &= blocks - 1) {
    int b = __builtin_ctz(blocks);
    unsigned groups = bounded && !(inside >> b & 1) ? bits(meets(bounds, p->group[b])) : 15;
    while (groups) {
      int group = __builtin_ctz(groups) & ~(kGroups - 1), first = 16 * b + 4 * group;
      groups &= ~(((1u << kGroups) - 1) << group);
      float far = p->group_far[first / 4];
      for (int g = 1; g < kGroups; ++g) far = p->group_far[first / 4 + g] > far ? p->group_far[first / 4 + g] : far;
      if (!(leaf.near[lane] <= far)) continue;
      Passing rays = judge(edge_range(triangle.line, F::load(p->x + first) - F::splat(p->middle_x),
                                      F::load(p->y + first) - F::splat(p->middle_y)),
                           triangle.error, triangle.near <= F::load(p->far + first));
      if (!rays.pass) continue;
      if (!has_exact) exact = exact_triangle(*p, block, lane), has_exact = true;
      if (!settle_rays<kLanes>(p, block, lane, exact, first, rays.pass, ~rays.sure)) continue;
      for (int i = first; i < first + kLanes; i += 4) p->group_far[i / 4] = highest(Float4::load(p->far + i));
    }
  }
}

}  // namespace POCKETRAY_ISA
}  // namespace pocketray
