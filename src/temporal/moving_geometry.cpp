#include "temporal/moving_geometry.h"

#include <algorithm>
#include <cstring>
#include <utility>

#include "accel/accel_list.h"
#include "accel/bvh.h"
#include "base/check.h"
#include "scene/animate.h"
#include "scene/moving.h"
#include "temporal/beam_search.h"

namespace pocketray {
namespace {

bool is_in(const std::uint32_t* bits, std::uint32_t i) { return bits[i / 32] >> (i % 32) & 1; }
void put_in(std::uint32_t* bits, std::uint32_t i) { bits[i / 32] |= 1u << (i % 32); }

bool can_move(const Scene& scene, EffectMask mask) {
  return has(mask, Effect::animation) && is_animated(scene) && scene.moving_meshes.count > 0;
}

struct Sizes {
  std::uint32_t triangles = 0, vertices = 0;
};

Sizes sizes_of(const Scene& scene) {
  Sizes sizes;
  for (const Triangle& t : scene.triangles) sizes.triangles += moves(scene.moving_meshes, t);
  for (const MovingMesh& mesh : scene.moving_meshes) sizes.vertices += mesh.vertex_count;
  return sizes;
}

std::size_t place_count(const Scene& scene) { return (std::size_t(scene.triangles.count) + 31) / 32; }

// Copies the moving vertices' positions or normals and marks those that differ from the copy.
void follow(const MovingGeometry& moving, Array<const Vec3> from, Array<Vec3> copy, std::uint32_t* changed) {
  std::uint32_t k = 0;
  for (std::uint32_t run = 0; run < moving.run_begin.count; ++run) {
    for (std::uint32_t v = moving.run_begin[run]; v < moving.run_end[run]; ++v, ++k) {
      if (std::memcmp(&from[v], &copy[k], sizeof(Vec3)) == 0) continue;
      put_in(changed, v);
      copy[k] = from[v];
    }
  }
  CHECK_EQ(k, copy.count);
}

// Marks the children of the nodes below which a triangle has changed.
void mark_nodes(MovingGeometry* m) {
  BvhView bvh(m->now.data.data);
  CHECK_EQ(bvh.header->node_count, m->node_changed.count);
  for (std::uint32_t i = bvh.header->node_count; i-- > 0;) {  // children come after their parents
    std::uint8_t changed = 0;
    for (int lane = 0; lane < 4 && bvh.nodes[i].child[lane] != kNoChild; ++lane) {
      const std::uint32_t child = bvh.nodes[i].child[lane];
      bool any = false;
      if (child & kLeafBit) {
        any = changed_lanes(*m, bvh.leaves[child & kLeafIndexMask], leaf_triangle_count(child)) != 0;
      } else {
        any = m->node_changed[child] != 0;
      }
      changed |= static_cast<std::uint8_t>(any << lane);
    }
    m->node_changed[i] = changed;
  }
}

}  // namespace

std::size_t moving_geometry_need(const Scene& scene, EffectMask mask) {
  if (!can_move(scene, mask)) return 0;
  Sizes n = sizes_of(scene);
  std::size_t bytes = arena_need<Triangle>(n.triangles) + arena_need<std::uint32_t>(n.triangles) +
                      arena_need<MovingPlaces>(place_count(scene)) + arena_need<std::uint8_t>(n.triangles) +
                      2 * arena_need<std::uint32_t>(scene.moving_meshes.count) +
                      arena_need<std::uint32_t>(scene.positions.count / 32 + 1);
  for (Array<const Vec3> each : {scene.positions, scene.normals})
    if (each.count) bytes = size_sum(bytes, arena_need<Vec3>(n.vertices));
  std::size_t bvh = kBvhAccel.need(n.triangles);
  return size_sum(size_sum(bytes, bvh), size_sum(bvh, arena_need(bvh / sizeof(BvhNode))));
}

std::size_t moving_geometry_scratch_need(const Scene& scene, EffectMask mask) {
  return can_move(scene, mask) ? kBvhAccel.scratch_need(sizes_of(scene).triangles) : 0;
}

MovingGeometry make_moving_geometry(const FrameData& frame, Arena* keep, Arena* scratch) {
  MovingGeometry m;
  const Scene& scene = *frame.scene;
  if (!can_move(scene, frame.mask)) return m;
  Sizes n = sizes_of(scene);
  m.triangles = arena_array<Triangle>(keep, n.triangles);
  m.ids = arena_array<std::uint32_t>(keep, n.triangles);
  m.triangle_changed = arena_array_zeroed<std::uint8_t>(keep, n.triangles);
  m.places = arena_array<MovingPlaces>(keep, place_count(scene));
  std::uint32_t count = 0;
  for (std::uint32_t i = 0; i < scene.triangles.count; ++i) {
    if (i % 32 == 0) m.places[i / 32] = {0, count};
    if (!moves(scene.moving_meshes, scene.triangles[i])) continue;
    m.places[i / 32].bits |= 1u << (i % 32);
    m.triangles[count] = scene.triangles[i], m.ids[count++] = i;
  }
  CHECK_EQ(count, n.triangles);
  m.run_begin = arena_array<std::uint32_t>(keep, scene.moving_meshes.count);
  m.run_end = arena_array<std::uint32_t>(keep, scene.moving_meshes.count);
  for (std::uint32_t i = 0; i < scene.moving_meshes.count; ++i) {
    m.run_begin[i] = scene.moving_meshes[i].vertex_begin;
    m.run_end[i] = m.run_begin[i] + scene.moving_meshes[i].vertex_count;
  }
  m.vertex_changed = arena_array_zeroed<std::uint32_t>(keep, scene.positions.count / 32 + 1);
  m.positions = arena_array_zeroed<Vec3>(keep, n.vertices);
  if (scene.normals.count) m.normals = arena_array_zeroed<Vec3>(keep, n.vertices);
  m.now.positions = frame.geometry.positions;
  m.now.triangles = m.triangles;
  kBvhAccel.build(&m.now, keep, scratch);
  m.last = m.now;
  m.data[0] = {const_cast<std::uint8_t*>(m.now.data.data), m.now.data.count};  // lies in our arena
  m.data[1] = arena_array<std::uint8_t>(keep, m.now.data.count);
  std::memcpy(m.data[1].data, m.data[0].data, m.data[0].bytes());
  m.last.data = m.data[1];
  m.node_changed = arena_array_zeroed<std::uint8_t>(keep, BvhView(m.now.data.data).header->node_count);
  follow_geometry(frame, &m);  // everything has changed ...
  follow_geometry(frame, &m);  // ... and nothing since
  return m;
}

void follow_geometry(const FrameData& frame, MovingGeometry* m) {
  m->changed = false;
  if (m->triangles.empty()) return;
  CHECK_EQ(frame.geometry.positions.count, frame.scene->positions.count);
  std::memset(m->vertex_changed.data, 0, m->vertex_changed.bytes());
  follow(*m, frame.geometry.positions, m->positions, m->vertex_changed.data);
  if (m->normals.count && frame.geometry.normals.count)
    follow(*m, frame.geometry.normals, m->normals, m->vertex_changed.data);
  for (std::uint32_t i = 0; i < m->triangles.count; ++i) {
    bool changed = false;
    for (std::uint32_t v : m->triangles[i].vertices()) changed |= is_in(m->vertex_changed.data, v);
    m->triangle_changed[i] = changed;
    m->changed |= changed;
  }
  if (!m->changed) return;  // `last` is not read
  std::swap(m->last, m->now);
  std::swap(m->data[0], m->data[1]);
  m->now.positions = frame.geometry.positions;
  kBvhAccel.refit(&m->now, m->data[0]);
  mark_nodes(m);
}

bool meets_change(const MovingGeometry& m, const Beam& beam) {
  if (!m.changed) return false;
  const BoundedBeam bounded = bounded_beam(beam, merge(m.last.bounds, m.now.bounds));
#if defined(POCKETRAY_HAVE_NEON32)
  if (active_isa() == Isa::kNeon && bounded.is_tame) return meets_change_neon(m, bounded);
#endif
  return meets_change(m, bounded);
}

void for_each_changed_box(const MovingGeometry& m, void (*visit)(void* context, const Box& box), void* context) {
  if (!m.changed) return;
  BvhView last(m.last.data.data), now(m.now.data.data);
  for (std::uint32_t i = 0; i < now.header->node_count; ++i) {
    for (int lane = 0; lane < 4; ++lane) {
      if (!(m.node_changed[i] >> lane & 1) || !(now.nodes[i].child[lane] & kLeafBit)) continue;
      visit(context, child_box(last.nodes[i], lane));
      visit(context, child_box(now.nodes[i], lane));
    }
  }
}

}  // namespace pocketray
