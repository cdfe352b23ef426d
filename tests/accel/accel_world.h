// Accelerators over generated meshes.
#pragma once
#include <cstring>
#include <limits>
#include <memory>
#include <vector>

#include "accel/accel_list.h"
#include "accel/meshes.h"

namespace pocketray {

// An accelerator over a mesh, in its own memory of exactly the planned size.
struct World {
  std::vector<Vec3> positions;
  std::vector<Triangle> triangles;
  std::unique_ptr<std::uint8_t[]> keep_block, scratch_block;
  Arena keep, scratch;
  const AccelInfo* info = nullptr;
  Accel accel;
};

inline std::unique_ptr<World> make_world(const Mesh& mesh, const AccelInfo* info) {
  std::unique_ptr<World> world(new World);
  world->positions = mesh.positions, world->triangles = mesh.triangles, world->info = info;
  std::uint32_t count = static_cast<std::uint32_t>(mesh.triangles.size());
  std::size_t keep = info->need(count) + kArenaAlignment, scratch = info->scratch_need(count) + kArenaAlignment;
  world->keep_block.reset(new std::uint8_t[keep]);
  world->scratch_block.reset(new std::uint8_t[scratch]);
  world->keep = make_arena("keep", world->keep_block.get(), keep);
  world->scratch = make_arena("scratch", world->scratch_block.get(), scratch);
  world->accel.positions = {world->positions.data(), static_cast<std::uint32_t>(world->positions.size())};
  world->accel.triangles = {world->triangles.data(), count};
  info->build(&world->accel, &world->keep, &world->scratch);
  return world;
}

// Builds again in the same memory, for moved positions, as a renderer does without refit().
inline void rebuild(World* world) {
  arena_release(&world->keep, 0);
  world->info->build(&world->accel, &world->keep, &world->scratch);
}

inline Hit closest(const World& world, const Ray& ray, TraceStats* stats = nullptr, const HitFilter* filter = nullptr) {
  Hit hit = {-1, -1, -1, 0};
  world.info->closest(world.accel, ray, filter, &hit, stats);
  return hit;
}

inline bool same_bits(float a, float b) { return std::memcmp(&a, &b, sizeof a) == 0; }
inline bool same_hit(const Hit& a, const Hit& b) {
  return a.triangle == b.triangle && same_bits(a.t, b.t) && same_bits(a.u, b.u) && same_bits(a.v, b.v);
}

constexpr float kInfinity = std::numeric_limits<float>::infinity();

}  // namespace pocketray
