#include "accel/bvh_divide.h"

#include <algorithm>

#include "base/check.h"

namespace pocketray {
namespace {

constexpr std::uint32_t kBinCount = 32;
constexpr double kInfinite = std::numeric_limits<double>::infinity();

struct BinDivision {
  double cost = kInfinite;
  int axis = -1;  // -1: none
  std::uint32_t left_bins = 0, left_count = 0;
};

// Maps centroids to bins; scale is 0 on an axis where all centroids coincide.
struct BinMap {
  Float4 low, scale;
  float axis_low[4], axis_scale[4];
  explicit BinMap(const WideBox& centroids) {
    alignas(16) float l[4], h[4], s[4] = {0, 0, 0, 0};
    store(l, centroids.low), store(h, centroids.high);
    for (int axis = 0; axis < 3; ++axis) {
      float per_unit = kBinCount / (h[axis] - l[axis]);  // infinite where the extent is 0 or denormal
      s[axis] = h[axis] > l[axis] && per_unit <= std::numeric_limits<float>::max() ? per_unit : 0;
    }
    low = centroids.low, scale = Float4::load(s);
    for (int axis = 0; axis < 4; ++axis) axis_low[axis] = l[axis], axis_scale[axis] = s[axis];
  }
  std::uint32_t bin(const BuildPrimitive& p, int axis) const {
    float position = (centroid2(p, axis) - axis_low[axis]) * axis_scale[axis];
    return std::min(static_cast<std::uint32_t>(static_cast<std::int32_t>(position)), kBinCount - 1);
  }
};

struct Bins {
  WideBox box[3][kBinCount];
  std::uint32_t count[3][kBinCount];
};

void add_to_bins(const BuildPrimitive& primitive, const BinMap& map, Bins* bins) {
  WideBox box = wide_box(primitive);
  alignas(16) float position[4];
  store(position, min((centroid2(box) - map.low) * map.scale, Float4::splat(kBinCount - 1)));
  for (int axis = 0; axis < 3; ++axis) {
    std::uint32_t bin = static_cast<std::uint32_t>(static_cast<std::int32_t>(position[axis]));
    bins->box[axis][bin] = merge(bins->box[axis][bin], box);
    ++bins->count[axis][bin];
  }
}

// Alternate primitives use separate bins: neighbours often share a bin, and each would wait for the one before it.
void fill_bins(const BuildPrimitive* primitives, const BuildPart& part, const BinMap& map, Bins* bins) {
  Bins odd;
  for (Bins* b : {bins, &odd})
    for (int axis = 0; axis < 3; ++axis)
      for (std::uint32_t i = 0; i < kBinCount; ++i) b->box[axis][i] = empty_wide_box(), b->count[axis][i] = 0;
  const BuildPrimitive *p = primitives + part.begin, *end = p + part.count;
  for (; p + 1 < end; p += 2) add_to_bins(p[0], map, bins), add_to_bins(p[1], map, &odd);
  if (p < end) add_to_bins(*p, map, bins);
  for (int axis = 0; axis < 3; ++axis)
    for (std::uint32_t i = 0; i < kBinCount; ++i) {
      bins->box[axis][i] = merge(bins->box[axis][i], odd.box[axis][i]);
      bins->count[axis][i] += odd.count[axis][i];
    }
}

// Each side must be one leaf or at least four.
bool side_is_allowed(std::uint32_t count) {
  return count > 0 && (leaves_for(count) == 1 || leaves_for(count) >= kSideLeavesMin);
}
bool division_is_allowed(const BuildPart& part, std::uint32_t left) {
  return side_is_allowed(left) && side_is_allowed(part.count - left) &&
         leaves_for(left) + leaves_for(part.count - left) <= part.leaf_max;
}

// Returns the allowed count nearest to `wish`.
std::uint32_t allowed_left_count(const BuildPart& part, std::uint32_t wish) {
  for (std::uint32_t step = 0;; ++step) {
    if (wish > step && division_is_allowed(part, wish - step)) return wish - step;
    if (wish + step < part.count && division_is_allowed(part, wish + step)) return wish + step;
    CHECK_LT(step, part.count);
  }
}

BinDivision bin_division(const Bins& bins, const BuildPart& part, const BinMap& map) {
  BinDivision best;
  for (int axis = 0; axis < 3; ++axis) {
    if (map.axis_scale[axis] == 0) continue;
    double right_cost[kBinCount];
    WideBox box = empty_wide_box();
    std::uint32_t right = 0;
    for (std::uint32_t i = kBinCount; i-- > 1;) {
      box = merge(box, bins.box[axis][i]), right += bins.count[axis][i];
      right_cost[i] = right ? part_cost(box, right) : 0;
    }
    box = empty_wide_box();
    std::uint32_t left = 0;
    for (std::uint32_t i = 1; i < kBinCount; ++i) {
      box = merge(box, bins.box[axis][i - 1]), left += bins.count[axis][i - 1];
      if (!side_is_allowed(left) || !side_is_allowed(part.count - left)) continue;
      double cost = part_cost(box, left) + right_cost[i];
      if (cost < best.cost) best.cost = cost, best.axis = axis, best.left_bins = i, best.left_count = left;
    }
  }
  return best;
}

// Moves the primitives of the lower bins to the front, without data-dependent branches.
void partition(BuildPrimitive* primitives, const BuildPart& part, const BinMap& map, const BinDivision& division) {
  BuildPrimitive *first = primitives + part.begin, *end = first + part.count, *middle = first;
  for (BuildPrimitive* p = first; p < end; ++p) {
    BuildPrimitive here = *p;
    bool is_left = map.bin(here, division.axis) < division.left_bins;
    *p = *middle, *middle = here;
    middle += is_left;
  }
  CHECK_EQ(middle - first, std::ptrdiff_t(division.left_count));
}

struct CentroidLess {
  int axis;
  bool operator()(const BuildPrimitive& a, const BuildPrimitive& b) const {
    float ca = centroid2(a, axis), cb = centroid2(b, axis);
    return ca != cb ? ca < cb : a.tagged_id < b.tagged_id;
  }
};

// Moves the boundary between two sides, taking the primitives nearest to it.
void move_boundary(BuildPrimitive* primitives, const BuildPart& part, int axis, std::uint32_t from, std::uint32_t to) {
  CHECK_LE(from, part.count);
  CHECK_LE(to, part.count);
  BuildPrimitive* first = primitives + part.begin;
  for (; from < to; ++from)
    std::swap(first[from], *std::min_element(first + from, first + part.count, CentroidLess{axis}));
  for (; from > to; --from) std::swap(first[from - 1], *std::max_element(first, first + from, CentroidLess{axis}));
}

int widest_axis(const WideBox& box) {
  alignas(16) float e[4];
  store(e, box.high - box.low);
  return e[0] >= e[1] && e[0] >= e[2] ? 0 : e[1] >= e[2] ? 1 : 2;
}

}  // namespace

bool has_division_axis(const BuildPart& part) {
  BinMap map(part.centroids);
  return map.axis_scale[0] > 0 || map.axis_scale[1] > 0 || map.axis_scale[2] > 0;
}

BuildPart make_part(const BuildPrimitive* primitives, std::uint32_t begin, std::uint32_t count,
                    std::uint32_t leaf_max) {
  BuildPart part = {begin, count, leaf_max, empty_wide_box(), empty_wide_box()};
  for (std::uint32_t i = begin; i < begin + count; ++i) {
    WideBox box = wide_box(primitives[i]);
    Float4 centroid = centroid2(box);
    part.box = merge(part.box, box);
    part.centroids = {min(part.centroids.low, centroid), max(part.centroids.high, centroid)};
  }
  return part;
}

void divide_part(BuildPrimitive* primitives, const BuildPart& part, bool halve, BuildPart* left, BuildPart* right) {
  CHECK(can_be_divided(part.count));
  CHECK_LE(leaves_for(part.count), part.leaf_max);
  BinMap map(part.centroids);
  BinDivision division;
  if (!halve) {
    Bins bins;
    fill_bins(primitives, part, map, &bins);
    division = bin_division(bins, part, map);
  }
  std::uint32_t middle;
  if (division.axis >= 0) {
    middle = allowed_left_count(part, division.left_count);
    partition(primitives, part, map, division);
    move_boundary(primitives, part, division.axis, division.left_count, middle);
  } else {
    middle = allowed_left_count(part, part.count / 2);
    BuildPrimitive* first = primitives + part.begin;
    std::sort(first, first + part.count, CentroidLess{widest_axis(part.centroids)});
  }
  CHECK(middle > 0 && middle < part.count);
  CHECK_LE(leaves_for(middle) + leaves_for(part.count - middle), part.leaf_max);
  std::uint32_t right_count = part.count - middle, spare = part.leaf_max - leaves_for(middle) - leaves_for(right_count);
  std::uint32_t left_spare =
      static_cast<std::uint32_t>((2 * std::uint64_t(spare) * middle + part.count) / (2 * std::uint64_t(part.count)));
  std::uint32_t begin = part.begin;
  *left = make_part(primitives, begin, middle, leaves_for(middle) + left_spare);
  *right = make_part(primitives, begin + middle, right_count, leaves_for(right_count) + spare - left_spare);
  CHECK_EQ(left->leaf_max + right->leaf_max, part.leaf_max);
}

}  // namespace pocketray
