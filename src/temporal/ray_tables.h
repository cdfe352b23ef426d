// Records which rays passed where [Jevans92] secs. 3.2, 3.3: a voxel grid around the scene with a bit-table per voxel.
// A bit stands for the rays of a block of pixels. In the paper the tracer's own voxels keep them; this grid is only for
// marking, so that any accelerator can trace.
#pragma once
#include <atomic>

#include "accel/ray.h"
#include "base/arena.h"
#include "base/box.h"

namespace pocketray {

constexpr std::uint32_t kVoxelSide = 16;  // voxels along each axis
constexpr std::uint32_t kVoxelCount = kVoxelSide * kVoxelSide * kVoxelSide;

struct RayTables {
  std::uint32_t width = 0, height = 0, side = 0;  // pixels; blocks along each side of the picture
  std::uint32_t words_per_voxel = 0;
  Box bounds = empty_box();                      // of the grid
  Vec3 scale = {0, 0, 0};                        // voxels per unit
  Array<std::atomic<std::uint32_t>> words;       // by voxel
  Array<std::uint32_t> dirty;                    // blocks whose rays passed a changed voxel
  Array<std::uint16_t> block_column, block_row;  // of a pixel
};

// Bytes from the arena. `side`² bits per voxel.
std::size_t ray_tables_need(std::uint32_t width, std::uint32_t height, std::uint32_t side);
// The grid has no position until the tables are reset.
RayTables make_ray_tables(std::uint32_t width, std::uint32_t height, std::uint32_t side, Arena* keep);
// Empties the tables, and places the grid anew if it does not contain the bounds. Otherwise it contains everything that
// can change.
void reset_tables(const Box& scene_bounds, RayTables* tables);

inline std::uint32_t block_of(const RayTables& t, std::uint32_t column, std::uint32_t row) {
  return t.block_row[row] * t.side + t.block_column[column];
}
inline bool is_dirty(const RayTables& t, std::uint32_t block) { return t.dirty[block / 32] >> (block % 32) & 1; }

// Sets the block's bit in each voxel that the ray may pass up to t_end, which may be infinite. Threads may mark
// concurrently.
void mark_ray(const RayTables& tables, const Ray& ray, float t_end, std::uint32_t block);

// Finds the blocks whose rays passed a voxel that the boxes touch: begin, add each box, and read `dirty`.
void begin_dirty(RayTables* tables);
void add_dirty(RayTables* tables, const Box& changed);
// Deletes the records of the dirty blocks, which are traced again (sec. 3.3.1).
void clear_dirty(RayTables* tables);

}  // namespace pocketray
