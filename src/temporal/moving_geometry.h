// The triangles that can move, in their last and their present positions.
#pragma once
#include "accel/accel.h"
#include "shade/frame_data.h"
#include "temporal/beam.h"

namespace pocketray {

// Which of 32 triangles of the scene can move, and how many before them can.
struct MovingPlaces {
  std::uint32_t bits, before;
};

struct MovingGeometry {
  Array<Triangle> triangles;
  Array<std::uint32_t> ids;                 // of the scene's triangles, ascending
  Array<MovingPlaces> places;               // indices of the scene's triangles among these
  Array<std::uint32_t> run_begin, run_end;  // vertices of moving meshes
  Array<Vec3> positions, normals;           // copies of these vertices; no normals if the scene has none
  Array<std::uint32_t> vertex_changed;      // a bit for each vertex of the scene
  Array<std::uint8_t> triangle_changed;
  Array<std::uint8_t> node_changed;  // for each node of the BVHs, bit i: a triangle below child i has changed
  Array<std::uint8_t> data[2];
  Accel last, now;  // BVHs of the triangles with equal nodes; their ids are indices into `ids`
  bool changed = false;
};

// Bytes from the arena that keeps it and from scratch memory that is released; 0 if nothing can move.
std::size_t moving_geometry_need(const Scene& scene, EffectMask mask);
std::size_t moving_geometry_scratch_need(const Scene& scene, EffectMask mask);
// Makes it for the frame's geometry, in which nothing has changed.
MovingGeometry make_moving_geometry(const FrameData& frame, Arena* keep, Arena* scratch);

// Follows the frame: its geometry becomes the last frame's.
void follow_geometry(const FrameData& frame, MovingGeometry* moving);

// Index of a scene triangle among the moving ones, or kNoTriangle.
inline std::uint32_t moving_index(const MovingGeometry& moving, std::uint32_t triangle) {
  if (triangle / 32 >= moving.places.count) return kNoTriangle;
  const MovingPlaces& places = moving.places[triangle / 32];
  const std::uint32_t bit = 1u << (triangle % 32);
  if (!(places.bits & bit)) return kNoTriangle;
  return places.before + static_cast<std::uint32_t>(__builtin_popcount(places.bits & (bit - 1)));
}

// Returns whether a ray of the beam can meet a changed triangle, in its last or present position.
bool meets_change(const MovingGeometry& moving, const Beam& beam);

// Calls visit(context, box) for boxes that together contain every changed triangle in its last and present position.
void for_each_changed_box(const MovingGeometry& moving, void (*visit)(void* context, const Box& box), void* context);

}  // namespace pocketray
