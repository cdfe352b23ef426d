// The rays of a bundle against a few leaves. Part of the kernels: see bvh_shaft.h.
//
// First find which rays pass through the box of which leaf; then run the float test of cross_triangle() on these, four
// triangles of a leaf and kLanes/4 rays at once; last settle the remaining doubts with the full test. The loops do not
// wait for each other's results, as they would leaf by leaf.
#pragma once
#include "accel/leaf_projection.h"
#include "accel/shaft.h"

namespace pocketray {
inline namespace POCKETRAY_ISA {

constexpr int kShaftLeaves = 8;  // searched at once
constexpr int kFewTests = 6;     // tests of a leaf: so few are faster than meet_window()

struct ShaftBatch {
  int count = 0;
  std::uint32_t child[kShaftLeaves];
  const TriangleBlock* block[kShaftLeaves];  // of the leaves to test some rays against
  unsigned in_use[kShaftLeaves];             // triangles that those rays may hit
  TriangleBlock scratch[kShaftLeaves];
  Window window[kShaftLeaves];  // of the leaf's box
  float near[kShaftLeaves];     // its nearest depth
};

// Mask of the triangles of a leaf that some ray of the window may cross, by edge lines over the whole window as in
// leaf_projection.h. The weight w of a vertex is its depth if the rays converge, otherwise 1.
inline unsigned meet_window(const Bundle& b, const TriangleBlock& block) {
  const Float4 half = Float4::splat(0.5f), slack = Float4::splat(b.slack);
  Float4 middle_x = (b.window[0] + b.window[1]) * half, middle_y = (b.window[2] + b.window[3]) * half;
  Float4 half_x = b.window[1] - middle_x, half_y = b.window[3] - middle_y;
  Float4 x[3], y[3], w[3], aside = Float4::splat(0), along = aside;
  for (int i = 0; i < 3; ++i) {
    Float4 depth = (Float4::splat(b.middle[2]) - Float4::load(block.vertex[i][b.kz])) * Float4::splat(b.sign);
    w[i] = b.converges ? depth : Float4::splat(1);
    x[i] = (Float4::load(block.vertex[i][b.kx]) - Float4::splat(b.middle[0])) - Float4::splat(b.slope[0]) * depth -
           middle_x * w[i];
    y[i] = (Float4::load(block.vertex[i][b.ky]) - Float4::splat(b.middle[1])) - Float4::splat(b.slope[1]) * depth -
           middle_y * w[i];
    aside = max(aside, abs(x[i]) + abs(y[i])), along = max(along, max(abs(depth), abs(w[i])));
  }
  // The vertices are displaced by less than the slack, so the edge functions err by its product with their terms.
  Float4 size = aside + along * (half_x + half_y) + slack;
  Float4 error = size * slack * Float4::splat(4) + size * (aside + along * Float4::splat(4)) * Float4::splat(0x1p-19f) +
                 Float4::splat(kUnderflow);
  Float4 low_max = Float4::splat(-kInfinity), high_min = Float4::splat(kInfinity), zero = Float4::splat(0);
  for (int i = 0; i < 3; ++i) {
    int j = i == 2 ? 0 : i + 1;
    Float4 line_x = y[i] * w[j] - w[i] * y[j], line_y = w[i] * x[j] - x[i] * w[j], line = x[i] * y[j] - y[i] * x[j];
    Float4 radius = abs(line_x) * half_x + abs(line_y) * half_y + error;
    low_max = max(low_max, line - radius), high_min = min(high_min, line + radius);
  }
  return bits((zero <= high_min) | (low_max <= zero));
}

struct ShaftTest {
  std::uint8_t leaf, first;  // first ray
};

template <int kLanes, class Tree>
int list_shaft_tests(const Tree& bvh, const Bundle& b, ShaftBatch* leaves, ShaftTest* tests) {
  constexpr int kAtOnce = kLanes / 4;
  int count = 0;
  for (int leaf = 0; leaf < leaves->count; ++leaf) {
    int begin = count;
    const Window& w = leaves->window[leaf];
    Bounds4 bounds = {Float4::splat(w.x_low), Float4::splat(w.x_high), Float4::splat(w.y_low), Float4::splat(w.y_high)};
    Float4 near = Float4::splat(leaves->near[leaf]);
    for (unsigned blocks = bits(meets(bounds, b.block)); blocks; blocks &= blocks - 1) {
      int block = __builtin_ctz(blocks);
      unsigned groups = bits(meets(bounds, b.group[block]) & (near <= Float4::load(b.group_depth + 4 * block)));
      for (; groups; groups &= groups - 1) {
        int first = 16 * block + 4 * __builtin_ctz(groups);
        Float4 x = Float4::load(b.x + first), y = Float4::load(b.y + first);
        unsigned rays = bits((bounds.x_low <= x) & (x <= bounds.x_high) & (bounds.y_low <= y) & (y <= bounds.y_high) &
                             (near <= Float4::load(b.depth + first)));
        rays &= static_cast<unsigned>(b.open >> first);
        while (rays) {
          int i = __builtin_ctz(rays) & ~(kAtOnce - 1);
          tests[count++] = {static_cast<std::uint8_t>(leaf), static_cast<std::uint8_t>(first + i)};
          rays &= ~(((1u << kAtOnce) - 1) << i);
        }
      }
    }
    if (count == begin) continue;
    leaves->block[leaf] = &bvh.leaf(leaves->child[leaf], &leaves->scratch[leaf]);
    leaves->in_use[leaf] = (1u << leaf_triangle_count(leaves->child[leaf])) - 1;
    if (count - begin < kFewTests || !b.cubes_are_finite) continue;
    leaves->in_use[leaf] &= meet_window(b, *leaves->block[leaf]);
    if (!leaves->in_use[leaf]) count = begin;
  }
  return count;
}

// Bit masks: four triangles for each of kLanes/4 segments.
struct ShaftPassing {
  unsigned pass;  // a hit that counts is possible
  unsigned sure;  // certain
};

// Mask of the lanes where the segment certainly has t ≤ 0, since it starts beyond the triangle, most often on leaving
// it. With D the largest depth, edge functions err by up to w (see edge_error() in leaf_projection.h), and the sum of
// their products with the depths by 4wD. If one edge function is beyond w, the sum of the weights has its sign, or
// cross_triangle() falls back on weights that do.
template <class F>
unsigned surely_behind(const EdgeValues<F>& e, F low, F high, const F (&x)[3], const F (&y)[3], const F (&z)[3],
                       F nearest, F farthest, F sign) {
  F aside = max(max(abs(x[0]) + abs(y[0]), abs(x[1]) + abs(y[1])), abs(x[2]) + abs(y[2]));
  F along = max(abs(nearest), abs(farthest)), zero = F::splat(0);
  F error = aside * (aside + along * F::splat(4)) * F::splat(0x1p-19f) + F::splat(kUnderflow);
  F depth = (e.a * z[0] + e.b * z[1] + e.c * z[2]) * sign,
    depth_error = error * along * F::splat(4) + F::splat(kUnderflow);
  return bits(((error < high) & (depth < zero - depth_error)) | ((low < zero - error) & (depth_error < depth)));
}

// The float test of cross_triangle(), and conclusions from the triangles' depths.
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
  unsigned pass = bits(((zero <= low) | (high <= zero)) & (nearest <= F::spread(b.hit_high + first)) &
                       (F::spread(b.hit_low + first) <= farthest));
  if (!pass) return {0, 0};
  unsigned sure = bits(((zero < low) | (high < zero)) & (F::spread(b.sure_low + first) <= nearest) &
                       (farthest <= F::spread(b.sure_high + first)));
  if (b.cubes_are_finite && (pass & ~sure))
    pass &= ~surely_behind(e, low, high, x, y, z, nearest, farthest, F::splat(b.sign));
  return {pass, sure & pass};
}

// Full test whether a triangle blocks a segment.
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
template <int kLanes, class Tree>
void search_shaft_leaves(const Tree& bvh, Bundle* b, ShaftBatch* batch) {
  constexpr unsigned kEach = 0x1111;
  ShaftTest tests[kShaftLeaves * kPacketMax];
  int count = list_shaft_tests<kLanes>(bvh, *b, batch, tests);
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
