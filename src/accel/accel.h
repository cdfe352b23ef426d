// The interface of an accelerator. Closest hit means smallest t, then smallest triangle id, whatever the structure or
// SIMD width; all accelerators return the same bits. `brute` is the oracle that the others are tested against.
#pragma once
#include <cstddef>

#include "accel/ray.h"
#include "base/arena.h"
#include "base/parallel_loop.h"
#include "base/status.h"
#include "scene/scene.h"

namespace pocketray {

// The geometry of an accelerator and its own data, which lies in an arena or in a baked file.
struct Accel {
  Array<const Vec3> positions;
  Array<const Triangle> triangles;
  Box bounds = empty_box();
  float least_coordinate = 0;      // smallest magnitude of a coordinate other than 0; 0: unknown
  Array<const MovingMesh> moving;  // after settle(): the vertices that can move
  float least_still = 0;           // after settle(): least_coordinate over all other vertices
  Array<const std::uint8_t> data;  // the structure itself; queries change that of `grid`: grid.h
};

// A valuation of triangles. The value of a box bounds those of all triangles in it, rounding included.
struct TriangleQuery {
  const void* context;
  float (*box_value)(const void* context, const Box& box);
  float (*triangle_value)(const void* context, std::uint32_t triangle);
};

// How rays traverse an accelerator.
struct AccelTraversal {
  // Nearest hit in (0, ray.t_max). Without one, hit->triangle is kNoTriangle and t is unchanged. `filter` and `stats`
  // may be null.
  void (*closest)(const Accel& accel, const Ray& ray, const HitFilter* filter, Hit* hit, TraceStats* stats);
  // closest() for every ray of the packet, with the same bits, into hits[0 .. rays.count). by_rays.h has one for any
  // accelerator.
  void (*closest_packet)(const Accel& accel, const RayPacket& rays, const HitFilter* filter, Hit* hits,
                         TraceStats* stats);
  // Returns whether the ray hits anything in (0, ray.t_max) except the triangles where it begins and ends.
  bool (*occluded)(const Accel& accel, const Ray& ray, const HitFilter* filter, TraceStats* stats);
  // occluded() for every ray of the packet: bit i for ray i.
  std::uint64_t (*occluded_packet)(const Accel& accel, const SegmentPacket& rays, const HitFilter* filter,
                                   TraceStats* stats);
};

struct AccelInfo : AccelTraversal {
  const char* name;
  const char* help;     // how it differs from the others; may be empty
  bool is_automatic;    // taken by default when the ones before it in the list do not fit
  std::uint32_t magic;  // first word of its data; 0 if it has none
  // Upper bounds of the bytes that build() keeps in its arena and of the scratch memory that it releases. At the end,
  // build() returns the unused part of the former, but it needs all of it while it runs.
  std::size_t (*need)(std::uint32_t triangle_count);
  std::size_t (*scratch_need)(std::uint32_t triangle_count);
  // Builds over the triangles of `accel` (positions and triangles are set). Keeps data in `keep`; uses and releases
  // `scratch`. Never fails, since sizes are planned.
  void (*build)(Accel* accel, Arena* keep, Arena* scratch);
  // Marks in writable data what refit() can skip: triangles without a vertex in these runs, which must outlive the
  // accelerator. Null: refit() skips nothing.
  void (*settle)(Accel* accel, Array<std::uint8_t> data, Array<const MovingMesh> moving);
  // Adapts writable data to moved positions with unchanged topology. Null: build() again for every frame.
  void (*refit)(Accel* accel, Array<std::uint8_t> data);
  // Adopts baked data, aligned to 64, after checking every index, bound and vertex in it against the geometry.
  Status (*adopt)(Accel* accel, Array<const std::uint8_t> data, const ParallelLoop& loop);
  // Largest value of a triangle that rays can hit; 0 if none is positive.
  float (*largest)(const Accel& accel, const TriangleQuery& query);
  bool packets_by_rays = false;  // packets are traced ray by ray: neighbours share no work
};

}  // namespace pocketray
