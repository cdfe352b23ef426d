// The segments of a bundle against a few leaves. Part of the kernels: see bvh_shaft.h.
//
// First which segments pass through the box of which leaf, then the float test of cross_triangle() for these, four
// triangles of a leaf and kLanes/4 segments at once, last what that leaves open, by the book. The loops do not wait for
// one another's results, as they would leaf by leaf.
#pragma once
#include "accel/bvh.h"
#include "accel/shaft.h"

namespace pocketray {
inline namespace POCKETRAY_ISA {

// A box relative to the reference, z along the directions; in x and y widened by the slack.
struct ShaftBox {
  float x_low, x_high, y_low, y_high, begin, end;
};
inline ShaftBox shaft_box(const Bundle& b, const BvhNode& node, int lane) {
  auto low = [&](int axis, int k) { return node.bounds[axis][lane] - b.reference[k]; };
  auto high = [&](int axis, int k) { return node.bounds[3 + axis][lane] - b.reference[k]; };
  float z_low = low(b.kz, 2), z_high = high(b.kz, 2);
  bool back = b.sign < 0;
  return {low(b.kx, 0) - b.slack,  high(b.kx, 0) + b.slack, low(b.ky, 1) - b.slack,
          high(b.ky, 1) + b.slack, back ? -z_high : z_low,  back ? -z_low : z_high};
}

constexpr int kShaftLeaves = 8;  // searched at once

struct ShaftBatch {
  int count = 0;
  const TriangleBlock* block[kShaftLeaves];
  unsigned in_use[kShaftLeaves];  // lanes that hold triangles
  ShaftBox box[kShaftLeaves];
  TriangleBlock scratch[kShaftLeaves];  // of leaves whose triangles are fetched
};

// Mask of the blocks of sixteen whose shaft meets the box.
inline unsigned meet_box(const Shafts4& shafts, const ShaftBox& box) {
  Float4 near = max(Float4::load(shafts.begin), Float4::splat(box.begin));
  Float4 far = min(Float4::load(shafts.end), Float4::splat(box.end));
  auto at = [&](int row, Float4 z) { return Float4::load(shafts.at_zero[row]) + Float4::load(shafts.slope[row]) * z; };
  return bits((near <= far) & (min(at(0, near), at(0, far)) <= Float4::splat(box.x_high)) &
              (Float4::splat(box.x_low) <= max(at(1, near), at(1, far))) &
              (min(at(2, near), at(2, far)) <= Float4::splat(box.y_high)) &
              (Float4::splat(box.y_low) <= max(at(3, near), at(3, far))));
}

// Mask of the kLanes segments from `first` on that pass through the widened box.
template <class F>
unsigned pass_box(const Bundle& b, const ShaftBox& box, int first) {
  F near = max(F::load(b.begin + first), F::splat(box.begin)), far = min(F::load(b.end + first), F::splat(box.end));
  F x = F::load(b.x + first), y = F::load(b.y + first);
  F slope_x = F::load(b.slope_x + first), slope_y = F::load(b.slope_y + first);
  F x0 = x + slope_x * near, x1 = x + slope_x * far, y0 = y + slope_y * near, y1 = y + slope_y * far;
  return bits((near <= far) & (min(x0, x1) <= F::splat(box.x_high)) & (F::splat(box.x_low) <= max(x0, x1)) &
              (min(y0, y1) <= F::splat(box.y_high)) & (F::splat(box.y_low) <= max(y0, y1)));
}

struct ShaftTest {
  std::uint8_t leaf, first;  // segment
};

template <int kLanes>
int list_shaft_tests(const Bundle& b, const ShaftBatch& batch, ShaftTest* tests) {
  using F = typename Lanes<kLanes>::Floats;
  constexpr int kAtOnce = kLanes / 4;
  int count = 0;
  for (int leaf = 0; leaf < batch.count; ++leaf) {
    const ShaftBox& box = batch.box[leaf];
    for (unsigned blocks = meet_box(b.block, batch.box[leaf]); blocks; blocks &= blocks - 1) {
      int block = __builtin_ctz(blocks) * kBlockRays;
      unsigned open = static_cast<unsigned>(b.open >> block) & 0xFFFF;
      for (int first = 0; first < kBlockRays; first += kLanes) {
        if (!(open >> first & ((1u << kLanes) - 1))) continue;
        unsigned passing = pass_box<F>(b, box, block + first) & open >> first;
        while (passing) {
          int i = __builtin_ctz(passing) & ~(kAtOnce - 1);
          tests[count++] = {static_cast<std::uint8_t>(leaf), static_cast<std::uint8_t>(block + first + i)};
          passing &= ~(((1u << kAtOnce) - 1) << i);
        }
      }
    }
  }
  return count;
}

// Masks of bits: four triangles of each of kLanes/4 segments.
struct ShaftPassing {
  unsigned pass;  // a hit that counts is not excluded
  unsigned sure;  // surely one
};

// Mask of the lanes where the segment starts beyond the triangle, most often because it leaves it: t is surely not
// above 0 there. With D the greatest depth, edge functions err by up to w (edge_error() of leaf_projection.h tells why)
// and the sum of their products with the depths by 4wD. Where one edge function is beyond w, the sum of the weights has
// its sign, or cross_triangle() falls back on weights that do.
template <class F>
unsigned surely_behind(const EdgeValues<F>& e, F low, F high, const F (&x)[3], const F (&y)[3], const F (&z)[3],
                       F nearest, F farthest, F sign) {
  F aside = max(max(abs(x[0]) + abs(y[0]), abs(x[1]) + abs(y[1])), abs(x[2]) + abs(y[2]));
  F along = max(abs(nearest), abs(farthest)), zero = F::splat(0);
  F error = aside * (aside + along * F::splat(4)) * F::splat(0x1p-19f) + F::splat(0x1p-140f);
  F depth = (e.a * z[0] + e.b * z[1] + e.c * z[2]) * sign,
    depth_error = error * along * F::splat(4) + F::splat(0x1p-140f);
  return bits(((error < high) & (depth < zero - depth_error)) | ((low < zero - error) & (depth_error < depth)));
}

// The float test of cross_triangle(), and what the triangles' depths tell.
template <int kLanes>
ShaftPassing test_segments(const Bundle& b, const TriangleBlock& block, int first) {
  using F = typename Lanes<kLanes>::Floats;
  F origin_x = F::spread(b.origin[0] + first), origin_y = F::spread(b.origin[1] + first);
  F origin_z = F::spread(b.origin[2] + first);
  F shear_x = F::spread(b.shear_x + first), shear_y = F::spread(b.shear_y + first), x[3], y[3], z[3];
  for (int k = 0; k < 3; ++k) {
    z[k] = F::repeat(Float4::load(block.vertex[k][b.kz])) - origin_z;
    x[k] = (F::repeat(Float4::load(block.vertex[k][b.kx])) - origin_x) - shear_x * z[k];
    y[k] = (F::repeat(Float4::load(block.vertex[k][b.ky])) - origin_y) - shear_y * z[k];
  }
  EdgeValues<F> e = edge_values<F>(x[0], y[0], x[1], y[1], x[2], y[2]);
  F zero = F::splat(0), low = min(min(e.a, e.b), e.c), high = max(max(e.a, e.b), e.c);
  F nearest = min(min(z[0], z[1]), z[2]), farthest = max(max(z[0], z[1]), z[2]);
  unsigned pass = bits(((zero <= low) | (high <= zero)) & (nearest <= F::spread(b.high + first)) &
                       (F::spread(b.low + first) <= farthest));
  if (!pass) return {0, 0};
  unsigned sure = bits(((zero < low) | (high < zero)) & (F::spread(b.sure_low + first) <= nearest) &
                       (farthest <= F::spread(b.sure_high + first)));
  if (b.cubes_are_finite && (pass & ~sure))
    pass &= ~surely_behind(e, low, high, x, y, z, nearest, farthest, F::splat(b.sign));
  return {pass, sure & pass};
}

// By the book: whether a triangle blocks a segment.
inline bool blocks_segment(const Bundle& b, const TriangleBlock& block, int lane, int i) {
  ShearedRay ray = {{}, {}, b.kx, b.ky, b.kz, b.shear_x[i], b.shear_y[i]};
  const int axes[] = {b.kx, b.ky, b.kz};
  for (int k = 0; k < 3; ++k) ray.origin[axes[k]] = b.origin[k][i], ray.direction[axes[k]] = b.direction[k][i];
  Crossing crossing;
  if (!cross_triangle(ray, block_vertex(block, 0, lane), block_vertex(block, 1, lane), block_vertex(block, 2, lane),
                      &crossing))
    return false;
  if (!(crossing.t > 0 && crossing.t < b.t_max[i])) return false;
  return !b.filter ||
         b.filter->accept(b.filter->context, block.triangle[lane], static_cast<float>(crossing.b / crossing.sum),
                          static_cast<float>(crossing.c / crossing.sum));
}

// Searches the leaves of the batch and empties it.
template <int kLanes>
void search_shaft_leaves(Bundle* b, ShaftBatch* batch) {
  constexpr unsigned kEach = 0x1111;
  ShaftTest tests[kShaftLeaves * kPacketMax];
  int count = list_shaft_tests<kLanes>(*b, *batch, tests);
  for (int n = 0; n < count; ++n) {
    const ShaftTest& test = tests[n];
    const TriangleBlock& block = *batch->block[test.leaf];
    ShaftPassing found = test_segments<kLanes>(*b, block, test.first);
    unsigned in_use = batch->in_use[test.leaf] * kEach;
    if (!b->filter) {
      for (unsigned sure = found.sure & in_use; sure; sure &= sure - 1)
        b->open &= ~(std::uint64_t(1) << (test.first + __builtin_ctz(sure) / 4));
    }
    for (unsigned pass = found.pass & in_use; pass; pass &= pass - 1) {
      int bit = __builtin_ctz(pass), i = test.first + bit / 4;
      if ((b->open >> i & 1) && blocks_segment(*b, block, bit % 4, i)) b->open &= ~(std::uint64_t(1) << i);
    }
  }
  batch->count = 0;
}

}  // namespace POCKETRAY_ISA
}  // namespace pocketray
