// Adopts the bytes of a BVH from a file. They are hostile until checked. Afterwards no index leaves the data, no path
// exceeds the traversal stack, every vertex is the scene's and every box encloses what is under it.
#include <algorithm>
#include <atomic>
#include <cstring>

#include "accel/bvh.h"
#include "accel/denormals.h"
#include "accel/node_check.h"
#include "base/check.h"

namespace pocketray {
namespace {

struct Visit {
  std::uint32_t node, depth;
};

// The next free numbers, as the walk assigns them.
struct Walk {
  const BvhHeader& header;
  const BvhNode* nodes;
  std::uint32_t node_next, leaf_next, triangle_count;
};

bool same_box(const Box& a, const Box& b) { return a.low == b.low && a.high == b.high; }

bool leaf_is_sound(const CheckedTree& tree, std::uint32_t reference, const Box& box) {
  const std::uint8_t* leaf = tree.leaves + std::size_t(tree.kind.bytes) * (reference & kLeafIndexMask);
  std::uint32_t ids[kBvhLeafSize], count = leaf_triangle_count(reference);
  for (std::uint32_t i = 0; i < count; ++i) {
    ids[i] = leaf_ids(tree.kind, leaf)[i] & ~kUnhittableBit;
    if (ids[i] >= tree.triangles.count) return false;
  }
  TriangleBlock expected;  // the larger of the two kinds
  Box bounds = tree.kind.fill(tree.positions, tree.triangles, ids, count, &expected);
  return std::memcmp(&expected, leaf, tree.kind.bytes) == 0 && same_box(bounds, box);
}

// Checks boxes and leaves one by one; the indices of children are in range.
bool children_are_sound(const CheckedTree& tree, const BvhNode& node) {
  for (int lane = 0; lane < 4; ++lane) {
    const std::uint32_t child = node.child[lane];
    const Box box = child_box(node, lane);
    const bool sound = child == kNoChild  ? same_box(box, no_child_box())
                       : child & kLeafBit ? leaf_is_sound(tree, child, box)
                                          : same_box(box, node_box(tree.nodes[child]));
    if (!sound) return false;
  }
  return true;
}

// Returns whether the children are numbered as the walk assigns numbers, and pushes the inner ones onto the stack.
bool children_are_numbered(Walk* walk, const Visit& visit, Visit* stack, std::uint32_t* stack_count) {
  const BvhNode& node = walk->nodes[visit.node];
  bool sound = (node.still | node.reserved[0] | node.reserved[1] | node.reserved[2]) == 0, ended = false;
  for (std::uint32_t child : node.child) {
    ended = ended || child == kNoChild;
    if (ended) {
      sound = sound && child == kNoChild;
    } else if (child & kLeafBit) {
      sound = sound && walk->leaf_next < walk->header.leaf_count && (child & kLeafIndexMask) == walk->leaf_next;
      ++walk->leaf_next;
      walk->triangle_count += leaf_triangle_count(child);
    } else {
      sound = sound && walk->node_next < walk->header.node_count && child == walk->node_next;
      ++walk->node_next;
      stack[(*stack_count)++] = {child, visit.depth + 1};
    }
  }
  return sound;
}

Status damaged(std::uint32_t node) { return failure("accelerator: node %u is damaged; bake the scene again", node); }

// Checks that nodes and leaves form a tree, each with the number that the walk assigns to it.
Status check_numbers(const BvhHeader& header, const BvhNode* nodes, std::uint32_t triangle_count) {
  Walk walk = {header, nodes, 1, 0, 0};
  Visit stack[kBvhStackSize];
  std::uint32_t stack_count = 0;
  stack[stack_count++] = {0, 1};
  while (stack_count > 0) {
    const Visit visit = stack[--stack_count];
    CHECK_LT(visit.node, header.node_count);
    if (visit.depth > kBvhDepthMax)
      return failure("accelerator: deeper than %u nodes; bake the scene again", kBvhDepthMax);
    CHECK_LE(stack_count + 4, std::uint32_t(kBvhStackSize));
    if (!children_are_numbered(&walk, visit, stack, &stack_count)) return damaged(visit.node);
  }
  if (walk.node_next != header.node_count || walk.leaf_next != header.leaf_count ||
      walk.triangle_count > triangle_count)
    return failure("accelerator: nodes or leaves that nothing refers to; bake the scene again");
  return success();
}

// Checks boxes and leaves, part by part. The faulty node found is the first, whatever the number of threads.
Status check_nodes(const CheckedTree& tree, std::uint32_t node_count, const ParallelLoop& loop) {
  constexpr std::uint32_t kPartSize = 1024;  // chosen: nodes of about 1 MiB with their leaves
  const bool is_plain = has_only_valid_triangles(tree.positions, tree.triangles);
  std::atomic<std::uint32_t> first_fault{kNone};
  auto check = [&](std::uint32_t part) {
    const std::uint32_t begin = part * kPartSize, end = begin + std::min(kPartSize, node_count - begin);
    std::uint32_t i = begin;
    while (i < end && ((is_plain && is_plainly_sound(tree, tree.nodes[i])) || children_are_sound(tree, tree.nodes[i])))
      ++i;
    for (std::uint32_t known = first_fault; i < end && i < known && !first_fault.compare_exchange_weak(known, i);) {
    }
  };
  run_loop(loop, (node_count - 1) / kPartSize + 1, check);
  return first_fault == kNone ? success() : damaged(first_fault);
}

}  // namespace

// Does not check that every triangle is in exactly one leaf: a file that omits one shows a scene without it.
Status bvh_adopt(const LeafKind& kind, Accel* accel, Array<const std::uint8_t> data, const ParallelLoop& loop) {
  CHECK_LE(kind.bytes, sizeof(TriangleBlock));  // a leaf is compared with one of these
  CHECK_EQ(kind.bytes, kind.magic == kBvhMagic ? sizeof(TriangleBlock) : sizeof(CompactLeaf));
  CHECK(accel != nullptr && (data.data != nullptr || data.empty()));
  if (reinterpret_cast<std::uintptr_t>(data.data) % alignof(BvhNode) != 0)
    return failure("accelerator: not aligned to %zu bytes", alignof(BvhNode));
  if (data.bytes() < bvh_bytes(1, 0)) return failure("accelerator: cut off; bake the scene again");
  const BvhHeader& header = *BvhView(data.data).header;
  std::uint32_t reserved = 0;
  for (std::uint32_t word : header.reserved) reserved |= word;
  if (header.magic != kind.magic || reserved != 0 || header.triangle_count != accel->triangles.count ||
      header.node_count < 1 || header.node_count > kTriangleCountMax || header.leaf_count > kTriangleCountMax ||
      data.bytes() != bvh_bytes(header.node_count, header.leaf_count, kind.bytes))
    return failure("accelerator: its header does not fit the scene; bake the scene again");
  const BvhNode* nodes = BvhView(data.data).nodes;
  RETURN_IF_ERROR(check_numbers(header, nodes, accel->triangles.count));
  const CheckedTree tree = {kind, nodes, leaf_at(kind, data.data, 0), accel->positions, accel->triangles};
  RETURN_IF_ERROR(check_nodes(tree, header.node_count, loop));
  accel->data = data;
  accel->bounds = node_box(nodes[0]);
  accel->least_coordinate = least_coordinate(accel->positions);
  return success();
}

}  // namespace pocketray
