// Adopts the bytes of a BVH from a file. They are hostile until checked. Afterwards no index leaves the data, no path
// exceeds the traversal stack, every vertex is the scene's and every box encloses what is under it.
#include <cstring>

#include "accel/bvh.h"
#include "accel/denormals.h"
#include "base/check.h"

namespace pocketray {
namespace {

struct Visit {
  std::uint32_t node, depth;
};

// The next free numbers, as the walk assigns them.
struct Walk {
  const LeafKind& kind;
  const std::uint8_t* data;
  BvhView bvh;
  Array<const Vec3> positions;
  Array<const Triangle> triangles;
  std::uint32_t node_next, leaf_next, triangle_count;
};

bool same_box(const Box& a, const Box& b) { return a.low == b.low && a.high == b.high; }

bool leaf_is_sound(const Walk& walk, std::uint32_t reference, const Box& box) {
  const std::uint8_t* leaf = leaf_at(walk.kind, walk.data, reference & kLeafIndexMask);
  std::uint32_t ids[kBvhLeafSize], count = leaf_triangle_count(reference);
  for (std::uint32_t i = 0; i < count; ++i) {
    ids[i] = leaf_ids(walk.kind, leaf)[i] & ~kUnhittableBit;
    if (ids[i] >= walk.triangles.count) return false;
  }
  TriangleBlock expected;  // the larger of the two kinds
  Box bounds = walk.kind.fill(walk.positions, walk.triangles, ids, count, &expected);
  return std::memcmp(&expected, leaf, walk.kind.bytes) == 0 && same_box(bounds, box);
}

// Checks the children of a node and pushes the inner ones onto the stack.
Status check_node(Walk* walk, const Visit& visit, Visit* stack, std::uint32_t* stack_count) {
  CHECK_LT(visit.node, walk->bvh.header->node_count);
  const BvhNode& node = walk->bvh.nodes[visit.node];
  if (visit.depth > kBvhDepthMax)
    return failure("accelerator: deeper than %u nodes; bake the scene again", kBvhDepthMax);
  CHECK_LE(*stack_count + 4, std::uint32_t(kBvhStackSize));
  bool ended = false;
  for (int lane = 0; lane < 4; ++lane) {
    std::uint32_t child = node.child[lane];
    Box box = child_box(node, lane), none = no_child_box();
    ended = ended || child == kNoChild;
    bool sound = (lane == 0 ? node.still : node.reserved[lane - 1]) == 0;
    if (ended) {
      sound = sound && child == kNoChild && same_box(box, none);
    } else if (child & kLeafBit) {
      sound = sound && walk->leaf_next < walk->bvh.header->leaf_count && (child & kLeafIndexMask) == walk->leaf_next &&
              leaf_is_sound(*walk, child, box);
      ++walk->leaf_next;
      walk->triangle_count += leaf_triangle_count(child);
    } else {
      sound = sound && walk->node_next < walk->bvh.header->node_count && child == walk->node_next;
      if (sound) {
        Box inner = node_box(walk->bvh.nodes[child]);
        sound = same_box(box, inner);
      }
      ++walk->node_next;
      stack[(*stack_count)++] = {child, visit.depth + 1};
    }
    if (!sound) return failure("accelerator: node %u is damaged; bake the scene again", visit.node);
  }
  return success();
}

}  // namespace

// Does not check that every triangle is in exactly one leaf: a file that omits one shows a scene without it.
Status bvh_adopt(const LeafKind& kind, Accel* accel, Array<const std::uint8_t> data) {
  CHECK_LE(kind.bytes, sizeof(TriangleBlock));  // a leaf is compared with one of these
  if (reinterpret_cast<std::uintptr_t>(data.data) % alignof(BvhNode) != 0)
    return failure("accelerator: not aligned to %zu bytes", alignof(BvhNode));
  if (data.bytes() < bvh_bytes(1, 0)) return failure("accelerator: cut off; bake the scene again");
  Walk walk = {kind, data.data, BvhView(data.data), accel->positions, accel->triangles, 1, 0, 0};
  const BvhHeader& header = *walk.bvh.header;
  std::uint32_t reserved = 0;
  for (std::uint32_t word : header.reserved) reserved |= word;
  if (header.magic != kind.magic || reserved != 0 || header.triangle_count != accel->triangles.count ||
      header.node_count < 1 || header.node_count > kTriangleCountMax || header.leaf_count > kTriangleCountMax ||
      data.bytes() != bvh_bytes(header.node_count, header.leaf_count, kind.bytes))
    return failure("accelerator: its header does not fit the scene; bake the scene again");
  Visit stack[kBvhStackSize];
  std::uint32_t stack_count = 0;
  stack[stack_count++] = {0, 1};
  while (stack_count > 0) {
    Visit visit = stack[--stack_count];
    RETURN_IF_ERROR(check_node(&walk, visit, stack, &stack_count));
  }
  if (walk.node_next != header.node_count || walk.leaf_next != header.leaf_count ||
      walk.triangle_count > accel->triangles.count)
    return failure("accelerator: nodes or leaves that nothing refers to; bake the scene again");
  accel->data = data;
  accel->bounds = node_box(walk.bvh.nodes[0]);
  accel->least_coordinate = least_coordinate(accel->positions);
  return success();
}

}  // namespace pocketray
