// The adaptive voxel grid of [Jevans 1992, Object Space Temporal Coherence for Ray Tracing] sec. 3.1: a uniform grid of
// voxels, each with a list of the triangles that it touches; a voxel with many triangles is itself divided by a grid
// when a ray first enters it, so that nothing is spent on space that no ray sees. Its data is one block without
// pointers; places in it are counted in words of 32 bits:
//
//   GridHeader | root grid | pool of the grids that rays have called for
//
// A grid is a GridNode | GridCell[cells + 1] | triangle ids. The pool has a fixed size. When it is full, the grids that
// rays have not entered for longest are discarded, as in sec. 6.1; while none can be, voxels stay undivided and all
// their triangles are tested. Neither changes a hit.
//
// Rays change the data (our deviation from Accel): queries take a `const Accel&`, but divide voxels. So the data must
// lie in writable memory, is used by one Accel and its copies, and is not baked. Any number of threads may query
// concurrently: one at a time divides a voxel, while the others use it undivided; a finished grid is published by
// storing its position in the voxel. To discard grids, a thread waits until no other thread is in a query: grid_pool.h.
#pragma once
#include <atomic>
#include <cstring>

#include "accel/accel.h"

namespace pocketray {

// Granularity, "based on the number of objects in a voxel" (sec. 3.1): up to this many cells per triangle; a voxel of
// up to kVoxelTriangleMax triangles is not divided. Measured by the work and the time of seesaw, statue and cornell
// (`pocketray render SCENE --accel grid --aov cost`): 2 cells instead of 4 take up to 5 %
// longer, 8 overfill the pool; 12 triangles instead of 8 make no difference.
constexpr std::uint32_t kRootCellsPerTriangle = 1, kCellsPerTriangle = 4, kVoxelTriangleMax = 8;
// A triangle lies in several cells. Where the lists would exceed this many ids per triangle, cells are larger. Measured
// likewise: 2 at the root make seesaw take 1.3 times as long.
constexpr std::uint32_t kRootIdsPerTriangle = 3, kIdsPerTriangle = 4;
constexpr std::uint32_t kCellsPerAxisMax = 1024;
// Bounds the recursion of a walk. Only inseparable geometry, such as endlessly nested boxes, reaches it.
constexpr std::uint32_t kGridDepthMax = 8;
// Size of the pool in words. With the root grid this makes 52 bytes per triangle, as much as a BVH.
constexpr std::uint32_t kPoolWordsPerTriangle = 8, kPoolWordsMin = 4096;

// Values of a voxel's `child` that are not positions of grids. The paper's *not subdivided* and *subdivided*, the
// latter without a grid because there is nothing to gain.
constexpr std::uint32_t kNotSubdivided = 0, kSubdividedWithoutGrid = 1;

struct GridCell {
  std::uint32_t begin;  // first id in the grid's list; the ids end where the next cell's begin
  std::atomic<std::uint32_t> child;
};
static_assert(sizeof(GridCell) == 8 && sizeof(std::atomic<std::uint32_t>) == 4, "two words");

// How a grid divides its box: per axis the number of cells, the start of the first, their size, and its inverse.
struct GridShape {
  std::uint16_t cells[3];
  float low[3], size[3], inverse[3];
};

struct GridNode {
  std::uint32_t block;               // words taken from the pool; kBlockInUse while in use
  std::uint32_t parent, cell;        // grid whose voxel it divides, 0 for the root; index of that voxel
  std::atomic<std::uint32_t> stamp;  // value of header.clock when a ray last entered it
  GridShape shape;
  std::uint16_t depth;
};
static_assert(sizeof(GridNode) % 4 == 0, "whole words");
constexpr std::uint32_t kBlockInUse = 1u << 31;

struct alignas(64) GridHeader {
  std::uint32_t magic, triangle_count, pool_begin, pool_end;
  // Guarded by the lock:
  std::uint32_t next;                        // position at which to look for room first
  std::uint32_t words_since_tick;            // taken since the clock last advanced
  std::uint32_t rest;                        // requests to reject before the pool is searched again
  std::uint32_t grid_count, given_up_count;  // total made, total discarded
  std::atomic<std::uint32_t> lock, clock;
  alignas(64) std::atomic<std::uint32_t> walks;  // queries in progress; kGivingUp blocks further ones
};
constexpr std::uint32_t kGridMagic = 0x44495247;  // "GRID"
constexpr std::uint32_t kRootPlace = sizeof(GridHeader) / 4;

constexpr std::uint64_t grid_words(std::uint64_t cell_count, std::uint64_t id_count) {
  return sizeof(GridNode) / 4 + 2 * (cell_count + 1) + id_count;
}

// Typed access to the data. The only place that casts const away: see above.
struct Grid {
  std::uint32_t* words;
  explicit Grid(const Accel& accel)
      : words(reinterpret_cast<std::uint32_t*>(const_cast<std::uint8_t*>(accel.data.data))) {}
  GridHeader& header() const { return *reinterpret_cast<GridHeader*>(words); }
  GridNode& node(std::uint32_t place) const { return *reinterpret_cast<GridNode*>(words + place); }
};
inline GridCell* cells_of(GridNode& node) { return reinterpret_cast<GridCell*>(&node + 1); }
inline std::uint32_t cell_count_of(const GridShape& shape) {
  return std::uint32_t(shape.cells[0]) * shape.cells[1] * shape.cells[2];
}
inline std::uint32_t* ids_of(GridNode& node) {
  return reinterpret_cast<std::uint32_t*>(cells_of(node) + cell_count_of(node.shape) + 1);
}
inline std::uint32_t cell_number(const GridShape& shape, std::uint32_t x, std::uint32_t y, std::uint32_t z) {
  return (z * shape.cells[1] + y) * shape.cells[0] + x;
}

// Cell of a coordinate; coordinates outside the box map to the outermost cell. Monotonic in x, so a range of
// coordinates that holds x has a range of cells that holds the cell of x. No NaN and no overflow arises.
inline std::uint32_t cell_of(const GridShape& shape, int axis, double x) {
  double place = (x - double(shape.low[axis])) * double(shape.inverse[axis]);
  if (!(place > 0)) return 0;
  std::uint32_t last = shape.cells[axis] - 1u;
  return place < last ? static_cast<std::uint32_t>(place) : last;
}
// Start of cell i and end of cell i - 1, within 2^-22 of the grid's extent; callers pad it by more.
inline double cell_begin(const GridShape& shape, int axis, std::uint32_t i) {
  return double(shape.low[axis]) + i * double(shape.size[axis]);
}

std::size_t grid_need(std::uint32_t triangle_count, std::uint64_t pool_words);
// AccelInfo's build() with a pool of this size; tests make it small.
void grid_build(Accel* accel, Arena* keep, Arena* scratch, std::uint64_t pool_words);

}  // namespace pocketray
