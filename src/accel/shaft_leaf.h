// Tests the rays of a bundle against a few leaves. Part of the kernels: see bvh_shaft.h.
//
// First finds which rays pass through the box of which leaf; then runs the float test of cross_triangle() on these:
// four triangles of a leaf and kLanes/4 rays at once, or one triangle and kLanes rays, whichever takes fewer tests;
// last settles the remaining doubts with the full test. The loops do not wait for each other's results, as they would
// leaf by leaf.
#pragma once
#include "accel/leaf_projection.h"
#include "accel/shaft.h"

namespace pocketray {
inline namespace POCKETRAY_ISA {

constexpr int kShaftLeaves = 8;  // searched at once
constexpr int kFewTests = 6;     // tests of four triangles of a leaf: up to this many are faster than meet_window()
constexpr int kManyTests = 24;   // and from this many, meet_planes() pays as well

struct ShaftBatch {
  int count = 0;
  std::uint32_t child[kShaftLeaves];
  const TriangleBlock* block[kShaftLeaves];  // of the leaves to test some rays against
  unsigned in_use[kShaftLeaves];             // triangles that those rays may hit
  int in_use_count[kShaftLeaves];
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

// Mask of the triangles of a leaf whose planes some segment may cross. cross_triangle() puts a hit at a point of the
// segment; displaced across its dominant axis by less than 16u Z, u = 2^-24 and Z as in shaft.h, it is a point of the
// triangle, also close to an edge. With E the greatest component of two edges, the normal errs by less than 8.1u E² and
// is at most 2E², so that displacement changes a height over the plane (times the normal) by less than 128u E² Z, and
// rounding by less than 97u E² Z. The ends of converging rays are off by an eighth of the slack, which changes theirs
// by less than .75 E² slack; a direction along the plane that rounding turns away from it changes them by less than 95u
// E² Z. The slack is at least 32u Z: together, less than 12 E² slack.
inline unsigned meet_planes(Bundle* bundle, const TriangleBlock& block) {
  if (!bundle->has_bounds) find_bounds(bundle);
  const Bundle& b = *bundle;
  const int axes[] = {b.kx, b.ky, b.kz};
  Float4 corner[3], edge[3], other[3], size = Float4::splat(0);
  for (int k = 0; k < 3; ++k) {
    corner[k] = Float4::load(block.vertex[0][axes[k]]);
    edge[k] = Float4::load(block.vertex[1][axes[k]]) - corner[k];
    other[k] = Float4::load(block.vertex[2][axes[k]]) - corner[k];
    size = max(size, max(abs(edge[k]), abs(other[k])));
  }
  Float4 low = Float4::splat(0), high = low, end = low;
  for (int k = 0; k < 3; ++k) {
    const int i = k == 2 ? 0 : k + 1, j = 3 - k - i;
    const Float4 normal = edge[i] * other[j] - edge[j] * other[i];
    const Float4 a = normal * (Float4::splat(b.low[k]) - corner[k]),
                 c = normal * (Float4::splat(b.high[k]) - corner[k]);
    low = low + min(a, c), high = high + max(a, c);
    end = end + normal * (b.converges ? Float4::splat(b.middle[k]) - corner[k] : Float4::splat(b.direction[k][0]));
  }
  const Float4 error = size * size * Float4::splat(16 * b.slack) + Float4::splat(kUnderflow), zero = Float4::splat(0);
  if (b.converges) return bits((min(low, end) <= error) & (zero - error <= max(high, end)));
  return bits(((low <= error) | (end < zero)) & ((zero - error <= high) | (zero < end)));
}

// Number of tests of four triangles for the rays of a mask of kLanes bits: one per kLanes/4 rays.
template <int kLanes>
int tests_by_rays(unsigned rays) {
  constexpr int kAtOnce = kLanes / 4;
  constexpr unsigned kSome = (1u << kAtOnce) - 1;
  int count = 0;
  for (int i = 0; i < kLanes; i += kAtOnce) count += (rays >> i & kSome) != 0;
  return count;
}

// The rays of a mask of kLanes bits that pass through the box of a leaf.
struct ShaftTest {
  std::uint8_t leaf, first;  // first ray of the mask
  std::uint16_t rays;
};

// Mask of the sixteen rays of a block that pass through a box.
inline unsigned rays_through(const Bundle& b, const Bounds4& bounds, Float4 near, int block) {
  unsigned groups = bits(meets(bounds, b.group[block]) & (near <= Float4::load(b.group_depth + 4 * block))), rays = 0;
  for (; groups; groups &= groups - 1) {
    int begin = 4 * __builtin_ctz(groups), first = 16 * block + begin;
    Float4 x = Float4::load(b.x + first), y = Float4::load(b.y + first);
    rays |= bits((bounds.x_low <= x) & (x <= bounds.x_high) & (bounds.y_low <= y) & (y <= bounds.y_high) &
                 (near <= Float4::load(b.depth + first)))
            << begin;
  }
  return rays & static_cast<unsigned>(b.open >> 16 * block);
}

template <int kLanes, class Tree>
int list_shaft_tests(const Tree& bvh, Bundle* bundle, ShaftBatch* leaves, ShaftTest* tests) {
  constexpr unsigned kAllLanes = (1u << kLanes) - 1;
  const Bundle& b = *bundle;
  int count = 0;
  for (int leaf = 0; leaf < leaves->count; ++leaf) {
    int begin = count, by_rays = 0;
    const Window& w = leaves->window[leaf];
    Bounds4 bounds = {Float4::splat(w.x_low), Float4::splat(w.x_high), Float4::splat(w.y_low), Float4::splat(w.y_high)};
    Float4 near = Float4::splat(leaves->near[leaf]);
    for (unsigned blocks = bits(meets(bounds, b.block)); blocks; blocks &= blocks - 1) {
      const int block = __builtin_ctz(blocks);
      for (unsigned rays = rays_through(b, bounds, near, block); rays;) {
        const int place = __builtin_ctz(rays) & ~(kLanes - 1);
        const unsigned some = rays >> place & kAllLanes;
        rays &= ~(kAllLanes << place);
        tests[count++] = {static_cast<std::uint8_t>(leaf), static_cast<std::uint8_t>(16 * block + place),
                          static_cast<std::uint16_t>(some)};
        by_rays += tests_by_rays<kLanes>(some);
      }
    }
    if (count == begin) continue;
    leaves->block[leaf] = &bvh.leaf(leaves->child[leaf], &leaves->scratch[leaf]);
    unsigned in_use = (1u << leaf_triangle_count(leaves->child[leaf])) - 1;
    if (by_rays >= kFewTests && b.cubes_are_finite) in_use &= meet_window(b, *leaves->block[leaf]);
    if (by_rays >= kManyTests && in_use && b.cubes_are_finite) in_use &= meet_planes(bundle, *leaves->block[leaf]);
    if (!in_use) count = begin;
    leaves->in_use[leaf] = in_use;
    leaves->in_use_count[leaf] = tests_by_rays<4>(in_use);
  }
  return count;
}

// Masks with a bit per lane: a triangle and a segment.
struct ShaftPassing {
  unsigned pass;     // a hit that counts is possible
  unsigned sure;     // certain
  unsigned crosses;  // the segment's line certainly crosses the triangle
};

// Where segments meet triangles that they certainly cross. Edge functions err by up to w (see edge_error() in
// leaf_projection.h). With D the largest depth, the sum of their products with the depths errs by less than 4wD, and so
// does the product of their sum with a depth up to D. Their sum has the sign of the edge function that is beyond w, or
// cross_triangle() falls back on weights that do. Depths are differences from the origin along the dominant axis.
template <class F>
class ShaftCrossings {
 public:
  ShaftCrossings(const EdgeValues<F>& e, F low, F high, const F (&x)[3], const F (&y)[3], const F (&z)[3], F nearest,
                 F farthest) {
    F aside = max(max(abs(x[0]) + abs(y[0]), abs(x[1]) + abs(y[1])), abs(x[2]) + abs(y[2]));
    along_ = max(abs(nearest), abs(farthest));
    error_ = aside * (aside + along_ * F::splat(4)) * F::splat(0x1p-19f) + F::splat(kUnderflow);
    low_ = low, high_ = high, sum_ = e.a + e.b + e.c, depth_ = e.a * z[0] + e.b * z[1] + e.c * z[2];
    bound_ = error_ * along_ * F::splat(4) + F::splat(kUnderflow);
  }
  // Masks of the lanes whose crossing certainly lies behind the origin, or above or below a depth.
  auto behind(float sign) const { return agrees(depth_ * F::splat(-sign), bound_); }
  auto above(F at) const { return agrees(depth_ - sum_ * limited(at), bound_ + bound_); }
  auto below(F at) const { return agrees(sum_ * limited(at) - depth_, bound_ + bound_); }

 private:
  F limited(F at) const { return max(min(at, along_), F::splat(0) - along_); }
  // Returns whether a value with an error below `bound` certainly has the sign of the sum.
  auto agrees(F value, F bound) const {
    F zero = F::splat(0);
    return ((error_ < high_) & (bound < value)) | ((low_ < zero - error_) & (value < zero - bound));
  }

  F low_, high_, along_, error_, bound_, sum_, depth_;
};

// Crossings beyond the end of a segment are cheaper to reject in float than to locate: 3 % of a frame of seesaw. But
// keeping the values at hand costs a Cortex-A7 2 % of most frames.
#if defined(__arm__)
constexpr bool kPlacesEnds = false;
#else
constexpr bool kPlacesEnds = true;
#endif

// The float test of cross_triangle(), and conclusions from the triangles' depths. ray() returns the lanes' values from
// a row of the bundle, vertex() a vertex's values along an axis.
template <class F, class Ray, class Vertex>
ShaftPassing test_lanes(const Bundle& b, Ray ray, Vertex vertex) {
  F origin_x = ray(b.origin[0]), origin_y = ray(b.origin[1]), origin_z = ray(b.origin[2]);
  F shear_x = ray(b.shear_x), shear_y = ray(b.shear_y), x[3], y[3], z[3];
  for (int k = 0; k < 3; ++k) {
    z[k] = vertex(k, b.kz) - origin_z;
    x[k] = (vertex(k, b.kx) - origin_x) - shear_x * z[k];
    y[k] = (vertex(k, b.ky) - origin_y) - shear_y * z[k];
  }
  EdgeValues<F> e = edge_values<F>(x[0], y[0], x[1], y[1], x[2], y[2]);
  F zero = F::splat(0), low = min(min(e.a, e.b), e.c), high = max(max(e.a, e.b), e.c);
  F nearest = min(min(z[0], z[1]), z[2]), farthest = max(max(z[0], z[1]), z[2]);
  unsigned pass = bits(((zero <= low) | (high <= zero)) & (nearest <= ray(b.hit_high)) & (ray(b.hit_low) <= farthest));
  if (!pass) return {0, 0, 0};
  unsigned crosses = bits((zero < low) | (high < zero));
  unsigned sure = crosses & bits((ray(b.sure_low) <= nearest) & (farthest <= ray(b.sure_high)));
  if (b.cubes_are_finite && (pass & ~sure)) {
    const ShaftCrossings<F> at(e, low, high, x, y, z, nearest, farthest);
    pass &= ~bits(at.behind(b.sign));  // most often on leaving a triangle
    if (kPlacesEnds && (pass & ~sure)) {
      F sure_low = ray(b.sure_low), sure_high = ray(b.sure_high);
      pass &= ~bits(b.sign < 0 ? at.below(ray(b.hit_low)) : at.above(ray(b.hit_high)));
      sure |= crosses &
              bits(((sure_low <= nearest) | at.above(sure_low)) & ((farthest <= sure_high) | at.below(sure_high)));
    }
  }
  return {pass, sure & pass, crosses & pass};
}

// Tests kLanes/4 rays from `first` on against the four triangles of a leaf; lane 4 i + k has ray i and triangle k.
template <int kLanes>
ShaftPassing test_leaf_triangles(const Bundle& b, const TriangleBlock& block, int first) {
  using F = typename Lanes<kLanes>::Floats;
  return test_lanes<F>(
      b, [&](const float* row) { return F::spread(row + first); },
      [&](int k, int axis) { return F::repeat(Float4::load(block.vertex[k][axis])); });
}

// Tests kLanes rays from `first` on against one triangle.
template <int kLanes>
ShaftPassing test_rays_of(const Bundle& b, const TriangleBlock& block, int triangle, int first) {
  using F = typename Lanes<kLanes>::Floats;
  return test_lanes<F>(
      b, [&](const float* row) { return F::load(row + first); },
      [&](int k, int axis) { return F::splat(block.vertex[k][axis][triangle]); });
}

// Returns whether a triangle that may cross a segment, and does not hold its beginning, blocks it, given the result of
// the lane that tested both. A filter that does not read the point is asked first, because it is cheaper than the full
// test.
inline bool blocks_segment(const Bundle& b, const TriangleBlock& block, int triangle, int i, ShaftPassing found,
                           int lane) {
  const bool early = b.filter && !b.filter->reads_point;
  if (early && !b.filter->accept(b.filter->context, block.triangle[triangle], 0, 0)) return false;
  if (early && (found.sure >> lane & 1)) return true;
  ShearedRay ray = {{}, {}, b.kx, b.ky, b.kz, b.shear_x[i], b.shear_y[i]};
  const int axes[] = {b.kx, b.ky, b.kz};
  for (int k = 0; k < 3; ++k) ray.origin[axes[k]] = b.origin[k][i], ray.direction[axes[k]] = b.direction[k][i];
  const Vec3 v[] = {block_vertex(block, 0, triangle), block_vertex(block, 1, triangle),
                    block_vertex(block, 2, triangle)};
  Crossing crossing;
  if (!(found.crosses >> lane & 1 ? cross_decided : cross_triangle)(ray, v[0], v[1], v[2], &crossing)) return false;
  if (!(crossing.t > 0 && crossing.t < b.t_max[i])) return false;
  return !b.filter || early ||
         b.filter->accept(b.filter->context, block.triangle[triangle], static_cast<float>(crossing.b / crossing.sum),
                          static_cast<float>(crossing.c / crossing.sum));
}

inline bool is_open(const Bundle& b, int i) { return b.open >> i & 1; }
inline void close_ray(Bundle* b, int i) { b->open &= ~(std::uint64_t(1) << i); }

// Closes the rays blocked by four triangles; lane 4 i + k has ray first + i and triangle k.
inline void settle_leaf_triangles(Bundle* b, const TriangleBlock& block, ShaftPassing found, int first) {
  auto begins_on = [&](int lane) { return block.triangle[lane % 4] == b->from[first + lane / 4]; };
  if (!b->filter)
    for (unsigned sure = found.sure; sure; sure &= sure - 1)
      if (const int lane = __builtin_ctz(sure); !begins_on(lane)) close_ray(b, first + lane / 4);
  for (unsigned pass = found.pass; pass; pass &= pass - 1) {
    int lane = __builtin_ctz(pass), i = first + lane / 4;
    if (is_open(*b, i) && !begins_on(lane) && blocks_segment(*b, block, lane % 4, i, found, lane)) close_ray(b, i);
  }
}

// Closes the rays blocked by one triangle; lane i has ray first + i.
inline void settle_rays_of(Bundle* b, const TriangleBlock& block, int triangle, ShaftPassing found, int first) {
  for (unsigned pass = found.pass; pass; pass &= pass - 1)  // without the triangles on which rays begin
    if (block.triangle[triangle] == b->from[first + __builtin_ctz(pass)]) found.pass ^= pass & (0 - pass);
  if (!found.pass) return;
  found.sure &= found.pass;
  if (!b->filter || !b->filter->reads_point) {
    if (b->filter && !b->filter->accept(b->filter->context, block.triangle[triangle], 0, 0)) return;
    b->open &= ~(std::uint64_t{found.sure} << first);
    found.pass &= ~found.sure;
  }
  for (unsigned pass = found.pass; pass; pass &= pass - 1) {
    int lane = __builtin_ctz(pass), i = first + lane;
    if (blocks_segment(*b, block, triangle, i, found, lane)) close_ray(b, i);
  }
}

// Searches the leaves of the batch and empties it.
template <int kLanes, class Tree>
void search_shaft_leaves(const Tree& bvh, Bundle* b, ShaftBatch* batch) {
  constexpr int kAtOnce = kLanes / 4;
  constexpr unsigned kEach = 0x1111;
  ShaftTest tests[kShaftLeaves * kPacketMax / kLanes];
  int count = list_shaft_tests<kLanes>(bvh, b, batch, tests);
  for (int n = 0; n < count; ++n) {
    const int leaf = tests[n].leaf, first = tests[n].first;
    const TriangleBlock& block = *batch->block[leaf];
    unsigned rays = tests[n].rays & static_cast<unsigned>(b->open >> first);
    if (batch->in_use_count[leaf] < tests_by_rays<kLanes>(rays)) {
      for (unsigned in_use = batch->in_use[leaf]; in_use; in_use &= in_use - 1) {
        int triangle = __builtin_ctz(in_use);
        unsigned open = rays & static_cast<unsigned>(b->open >> first);
        ShaftPassing found = test_rays_of<kLanes>(*b, block, triangle, first);
        found.pass &= open, found.sure &= open;
        settle_rays_of(b, block, triangle, found, first);
      }
      continue;
    }
    while (rays) {
      int i = __builtin_ctz(rays) & ~(kAtOnce - 1);
      rays &= ~(((1u << kAtOnce) - 1) << i);
      ShaftPassing found = test_leaf_triangles<kLanes>(*b, block, first + i);
      unsigned in_use = batch->in_use[leaf] * kEach;
      found.pass &= in_use, found.sure &= in_use;
      settle_leaf_triangles(b, block, found, first + i);
    }
  }
  batch->count = 0;
}

}  // namespace POCKETRAY_ISA
}  // namespace pocketray
