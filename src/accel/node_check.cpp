#include "base/isa.h"

#if defined(POCKETRAY_HAVE_NEON32)
#undef POCKETRAY_ISA
#define POCKETRAY_ISA neon
#define POCKETRAY_NEON32
#endif
#include "accel/fixed_area.h"
#include "accel/node_check.h"
#include "base/check.h"
#include "base/float_bits.h"
#include "base/scan.h"
#include "base/simd.h"
#include "base/soft_float.h"
#include "base/words4.h"
#include "scene/triangle_scan.h"

namespace pocketray {
namespace {

#define QUICK inline __attribute__((always_inline))

Words4 words_of(const Float4& a) {
  Words4 words;
  static_assert(sizeof words == sizeof a, "four lanes");
  std::memcpy(&words, &a, sizeof words);
  return words;
}

// Rows as in BvhNode::bounds of what is in a child's box: sortable words, those of high planes complemented, so that
// the lowest word is always the outermost.
struct OuterRows {
  FoldedWords row[6];
};

QUICK Words4 outer(Words4 word, int row) { return row < 3 ? sortable(word) : ~sortable(word); }

void set_rows(const BvhNode& node, OuterRows* rows) {
  for (int r = 0; r < 3; ++r) {
    rows->row[r] = fold(outer(words_at(node.bounds[r]), r));
    rows->row[3 + r] = fold(outer(words_at(node.bounds[3 + r]), 3 + r));
  }
}

void set_no_rows(OuterRows* rows) {
  const Box none = no_child_box();
  for (int r = 0; r < 6; ++r) {
    const float plane = r < 3 ? none.low[r] : none.high[r - 3];
    rows->row[r] = fold(outer(all_words(static_cast<std::int32_t>(float_bits(plane))), r));
  }
}

#if defined(POCKETRAY_HAS_NO_FPU)
// True only if no lane's triangle has collinear corners.
struct AreaFound {
  bool v = true;
};
QUICK void find_area(const Float4 (&a)[3], const Float4 (&b)[3], const Float4 (&c)[3], AreaFound* found) {
  for (int lane = 0; lane < 4; ++lane) {
    auto corner = [&](const Float4(&p)[3]) { return Vec3{p[0].v[lane], p[1].v[lane], p[2].v[lane]}; };
    found->v = found->v && surely_has_area(corner(a), corner(b), corner(c));
  }
}
bool in_all_lanes(const AreaFound& found) { return found.v; }
#else
// True only in lanes whose triangle does not have collinear corners. A component of the cross product, with rounding
// errors of less than 5 · 2^-24 of its two products and of less than 2^-60 where NEON flushes denormals, must exceed
// these.
struct AreaFound {
  Mask4 v = Float4::splat(0) == Float4::splat(0);
};
QUICK Mask4 exceeds(const Float4& first, const Float4& second) {
  return (abs(first) + abs(second)) * Float4::splat(0x1p-20f) + Float4::splat(0x1p-60f) < abs(first - second);
}
QUICK void find_area(const Float4 (&a)[3], const Float4 (&b)[3], const Float4 (&c)[3], AreaFound* found) {
  const Float4 ux = b[0] - a[0], uy = b[1] - a[1], uz = b[2] - a[2];
  const Float4 vx = c[0] - a[0], vy = c[1] - a[1], vz = c[2] - a[2];
  found->v = found->v & (exceeds(ux * vy, uy * vx) | exceeds(uy * vz, uz * vy) | exceeds(uz * vx, ux * vz));
}
bool in_all_lanes(const AreaFound& found) { return bits(found.v) == 15; }
#endif

// Corners of a leaf's triangles, one a lane.
struct LeafCorners {
  const float* at[3][4];
};

QUICK bool find_corners(const CheckedTree& tree, std::uint32_t id, std::uint32_t lane, LeafCorners* corners) {
  if (id >= tree.triangles.count) return false;
  const Triangle& triangle = tree.triangles[id];
  corners->at[0][lane] = &tree.positions[triangle.vertex(0)].x;
  corners->at[1][lane] = &tree.positions[triangle.vertex(1)].x;
  corners->at[2][lane] = &tree.positions[triangle.vertex(2)].x;
  return true;
}

// Faults of a node's leaves so far.
struct Findings {
  Words4 difference;  // bits that differ from what they should be
  AreaFound area;
};

// Which leaves are checked: of triangle blocks, with all four lanes in use.
template <bool kBlock, bool kFull>
struct LeafShape {
  static constexpr bool kIsBlock = kBlock, kIsFull = kFull;
};

// Loads corner i and adds the bits in which it differs from a leaf's.
template <class Shape>
QUICK void load_corner(const LeafCorners& corners, int i, const std::uint8_t* leaf, const Words4& used,
                       Float4 (&point)[3], Words4* difference) {
  load_points(corners.at[i], point);
  if (!Shape::kIsBlock) return;
  const auto& vertex = reinterpret_cast<const TriangleBlock*>(leaf)->vertex[i];
  auto expected = [&](int axis) { return Shape::kIsFull ? words_of(point[axis]) : words_of(point[axis]) & used; };
  *difference |= expected(0) ^ words_at(vertex[0]);
  *difference |= expected(1) ^ words_at(vertex[1]);
  *difference |= expected(2) ^ words_at(vertex[2]);
}

QUICK void set_bounds(const Float4& a, const Float4& b, const Float4& c, FoldedWords* low, FoldedWords* high) {
  const Words4 first = sortable(words_of(a)), second = sortable(words_of(b)), third = sortable(words_of(c));
  *low = fold(lower_of(lower_of(first, second), third));
  *high = fold(~higher_of(higher_of(first, second), third));
}

// Checks a leaf and sets the rows of its triangles' bounds. Unused lanes repeat the first in these.
template <class Shape>
QUICK bool check_leaf(const CheckedTree& tree, const std::uint8_t* leaf, std::uint32_t count, OuterRows* bounds,
                      Findings* findings) {
  constexpr std::size_t kIdsOffset = Shape::kIsBlock ? offsetof(TriangleBlock, triangle) : 0;
  const std::uint32_t* ids = reinterpret_cast<const std::uint32_t*>(leaf + kIdsOffset);
  LeafCorners corners;
  Words4 used = all_words(-1);
  if (!Shape::kIsFull)
    for (std::uint32_t lane = count; lane < kBvhLeafSize; ++lane) {
      if (ids[lane] != (Shape::kIsBlock ? kNoTriangle : ids[0])) return false;
      used[lane] = 0;
    }
  if (!find_corners(tree, ids[0], 0, &corners) ||
      !find_corners(tree, ids[Shape::kIsFull || count > 1 ? 1 : 0], 1, &corners) ||
      !find_corners(tree, ids[Shape::kIsFull || count > 2 ? 2 : 0], 2, &corners) ||
      !find_corners(tree, ids[Shape::kIsFull ? 3 : 0], 3, &corners))
    return false;
  Float4 a[3], b[3], c[3];
  load_corner<Shape>(corners, 0, leaf, used, a, &findings->difference);
  load_corner<Shape>(corners, 1, leaf, used, b, &findings->difference);
  load_corner<Shape>(corners, 2, leaf, used, c, &findings->difference);
  find_area(a, b, c, &findings->area);
  set_bounds(a[0], b[0], c[0], &bounds->row[0], &bounds->row[3]);
  set_bounds(a[1], b[1], c[1], &bounds->row[1], &bounds->row[4]);
  set_bounds(a[2], b[2], c[2], &bounds->row[2], &bounds->row[5]);
  return true;
}

template <int kRow>
QUICK Words4 difference_of(const BvhNode& node, const OuterRows (&children)[4]) {
  return outer(words_at(node.bounds[kRow]), kRow) ^
         lowest_of_each(children[0].row[kRow], children[1].row[kRow], children[2].row[kRow], children[3].row[kRow]);
}

template <bool kIsBlock>
bool node_is_plain(const CheckedTree& tree, const BvhNode& node) {
  constexpr std::size_t kLeafBytes = kIsBlock ? sizeof(TriangleBlock) : sizeof(CompactLeaf);
  OuterRows children[4];
  Findings findings = {all_words(0), AreaFound()};
  for (int lane = 0; lane < 4; ++lane) {
    const std::uint32_t child = node.child[lane];
    if (!(child & kLeafBit)) {
      set_rows(tree.nodes[child], &children[lane]);
    } else if (child == kNoChild) {
      set_no_rows(&children[lane]);
    } else {
      const std::uint8_t* leaf = tree.leaves + kLeafBytes * (child & kLeafIndexMask);
      const std::uint32_t count = leaf_triangle_count(child);
      const bool is_sound = count == kBvhLeafSize
                                ? check_leaf<LeafShape<kIsBlock, true>>(tree, leaf, count, &children[lane], &findings)
                                : check_leaf<LeafShape<kIsBlock, false>>(tree, leaf, count, &children[lane], &findings);
      if (!is_sound) return false;
    }
  }
  const Words4 difference = findings.difference | difference_of<0>(node, children) | difference_of<1>(node, children) |
                            difference_of<2>(node, children) | difference_of<3>(node, children) |
                            difference_of<4>(node, children) | difference_of<5>(node, children);
  return !any_bit(difference) && in_all_lanes(findings.area);
}

}  // namespace

bool has_only_valid_triangles(Array<const Vec3> positions, Array<const Triangle> triangles) {
  static_assert(sizeof(Vec3) == 12, "three words");
  constexpr std::int32_t kMagnitude = 0x7FFFFFFF;
  CHECK(positions.data != nullptr || positions.empty());
  CHECK(triangles.data != nullptr || triangles.empty());
  if (triangles.empty()) return true;
  return largest_vertex(triangles) < positions.count &&
         static_cast<std::uint32_t>(largest_word(positions.data, 3 * std::size_t(positions.count), kMagnitude)) <=
             float_bits(kCoordinateMax);
}

bool is_plainly_sound(const CheckedTree& tree, const BvhNode& node) {
  return tree.kind.magic == kBvhMagic ? node_is_plain<true>(tree, node) : node_is_plain<false>(tree, node);
}

}  // namespace pocketray
