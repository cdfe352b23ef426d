// The triangles of a frame for the reference: a bounding volume hierarchy in double precision that shares nothing with
// the renderer's accelerators, so that neither inherits the other's errors.
#pragma once
#include "base/arena.h"
#include "shade/frame_data.h"

namespace pocketray {

struct ReferenceNode {
  Vec3d low, high;
  std::uint32_t first, count;  // count 0: the children are nodes first and first + 1; else so many of `order`
};

struct ReferenceWorld {
  const FrameData* frame = nullptr;
  Array<ReferenceNode> nodes;
  Array<std::uint32_t> order;  // triangles
};

struct ReferenceRay {
  Vec3d origin, direction;
  double t_min, t_max;  // open interval
};

// Hits have an order: by t, then by triangle. The one behind the last is the same with kNoTriangle and infinite t.
struct ReferenceHit {
  double t, u, v;  // u, v: weights of the triangle's vertices 1 and 2
  std::uint32_t triangle;
};

// Bytes of arena that the hierarchy takes.
std::size_t reference_world_need(std::uint32_t triangle_count);
// Over the frame's posed triangles; the frame has to outlive it.
ReferenceWorld make_reference_world(const FrameData& frame, Arena* arena);

// The first hit behind `after` in the order of hits (null: of all) that cut-outs leave: their holes are no hits.
ReferenceHit next_hit(const ReferenceWorld& world, const ReferenceRay& ray, const ReferenceHit* after);

}  // namespace pocketray
