#include "temporal/ray_tables.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "base/check.h"
#include "base/limits.h"

namespace pocketray {
namespace {

std::uint32_t words_for(std::uint32_t side) { return (side * side + 31) / 32; }

// A position in voxels, and how far off rounding may put it.
struct GridPlace {
  Vec3 at;
  float slack;
};

constexpr float kLeastSlack = 1.0f / 64;  // of a voxel: more than the rounding of the walk below

GridPlace grid_place(const RayTables& t, const Vec3& p) {
  Vec3 at, size;
  const float far = max_component(max(abs(t.bounds.low), abs(t.bounds.high)));  // triangles are hit as far off
  for (int axis = 0; axis < 3; ++axis) {
    at[axis] = (p[axis] - t.bounds.low[axis]) * t.scale[axis];
    size[axis] = (std::fabs(p[axis]) + std::fabs(t.bounds.low[axis]) + far) * t.scale[axis];
  }
  return {at, kLeastSlack + max_component(size) * 0x1p-20f};
}

int voxel_index(float at) {
  constexpr float last = kVoxelSide - 1;
  return static_cast<int>(at > 0 ? at < last ? at : last : 0);  // 0 for NaN
}

void set_bit(const RayTables& t, std::uint32_t voxel, std::uint32_t block) {
  std::atomic<std::uint32_t>& word = t.words[std::size_t(voxel) * t.words_per_voxel + block / 32];
  std::uint32_t bit = 1u << (block % 32);
  if (!(word.load(std::memory_order_relaxed) & bit)) word.fetch_or(bit, std::memory_order_relaxed);
}

std::uint32_t voxel_number(const int* v) {
  return (static_cast<std::uint32_t>(v[2]) * kVoxelSide + static_cast<std::uint32_t>(v[1])) * kVoxelSide +
         static_cast<std::uint32_t>(v[0]);
}

// Calls visit(voxel) for all voxels in a range of the grid, inclusive.
template <class Visit>
void for_each_voxel(const int* low, const int* high, Visit visit) {
  int v[3];
  for (v[2] = low[2]; v[2] <= high[2]; ++v[2])
    for (v[1] = low[1]; v[1] <= high[1]; ++v[1])
      for (v[0] = low[0]; v[0] <= high[0]; ++v[0]) visit(voxel_number(v));
}

}  // namespace

std::size_t ray_tables_need(std::uint32_t width, std::uint32_t height, std::uint32_t side) {
  return size_sum(arena_need(std::uint64_t(kVoxelCount) * words_for(side) * 4),
                  arena_need<std::uint32_t>(words_for(side)) + arena_need<std::uint16_t>(width) +
                      arena_need<std::uint16_t>(height));
}

RayTables make_ray_tables(std::uint32_t width, std::uint32_t height, std::uint32_t side, Arena* keep) {
  CHECK(side >= 1 && side <= kCoherenceTableSideMax);
  RayTables t;
  t.width = width, t.height = height, t.side = side;
  t.words_per_voxel = words_for(side);
  t.words = arena_array<std::atomic<std::uint32_t>>(keep, std::size_t(kVoxelCount) * t.words_per_voxel);
  t.dirty = arena_array_zeroed<std::uint32_t>(keep, t.words_per_voxel);
  t.block_column = arena_array<std::uint16_t>(keep, width);
  t.block_row = arena_array<std::uint16_t>(keep, height);
  for (std::uint32_t x = 0; x < width; ++x) t.block_column[x] = static_cast<std::uint16_t>(x * side / width);
  for (std::uint32_t y = 0; y < height; ++y) t.block_row[y] = static_cast<std::uint16_t>(y * side / height);
  return t;
}

void reset_tables(const Box& scene_bounds, RayTables* t) {
  CHECK_EQ(t->words.count, kVoxelCount * t->words_per_voxel);
  const Box b = is_empty(scene_bounds) ? Box{{0, 0, 0}, {0, 0, 0}} : scene_bounds;
  const bool is_placed = !is_empty(t->bounds) && contains(t->bounds, b);
  // Room for motion: an eighth on each side, and half once the scene has outgrown the grid, so that it rarely does
  // again. A grid that has grown shrinks once it is 8 times as large as the scene.
  const bool is_far_larger = max_component(extent(t->bounds)) > 8 * max_component(extent(b));
  if (!is_placed || is_far_larger) {
    const bool outgrown = !is_empty(t->bounds) && !is_far_larger;
    const Vec3 room = extent(b) * (outgrown ? 0.5f : 0.125f);
    const Box place = {b.low - room, b.high + room};
    t->bounds = is_far_larger ? place : merge(t->bounds, place);
  }
  for (int axis = 0; axis < 3; ++axis) {
    float size = t->bounds.high[axis] - t->bounds.low[axis];
    t->scale[axis] = size > 0x1p-100f ? kVoxelSide / size : 0;  // flat: a single layer of voxels
  }
  for (std::atomic<std::uint32_t>& word : t->words) word.store(0, std::memory_order_relaxed);
}

void mark_ray(const RayTables& t, const Ray& ray, float t_end, std::uint32_t block) {
  if (!is_finite(ray.origin) || !is_finite(ray.direction)) return;  // hits nothing (HARDCASES row 9)
  GridPlace from = grid_place(t, ray.origin);
  Vec3 step;
  int longest = 0;
  float begin = 0, end = t_end, slack = from.slack;
  for (int axis = 0; axis < 3; ++axis) {
    step[axis] = ray.direction[axis] * t.scale[axis];
    if (std::fabs(step[axis]) > std::fabs(step[longest])) longest = axis;
  }
  bool inside = true;
  for (int axis = 0; axis < 3; ++axis) {
    float low = -slack, high = kVoxelSide + slack;
    if (step[axis] == 0) {
      inside &= from.at[axis] >= low && from.at[axis] <= high;
      continue;
    }
    float a = (low - from.at[axis]) / step[axis], b = (high - from.at[axis]) / step[axis];
    begin = std::max(begin, std::min(a, b));
    end = std::min(end, std::max(a, b));
  }
  if (!inside || !(begin * (1 - 0x1p-20f) <= end)) return;
  end = std::min(end, std::numeric_limits<float>::max());
  auto at = [&](int axis, float s) { return step[axis] == 0 ? from.at[axis] : from.at[axis] + step[axis] * s; };
  // Layer by layer along the longest axis; in each the ray stays within a small rectangle of voxels.
  float first = at(longest, begin), last = at(longest, end);
  int layer_low = voxel_index(std::min(first, last) - slack), layer_high = voxel_index(std::max(first, last) + slack);
  for (int layer = layer_low; layer <= layer_high; ++layer) {
    float enter = begin, leave = end;
    if (step[longest] != 0) {
      float a = (static_cast<float>(layer) - slack - from.at[longest]) / step[longest];
      float b = (static_cast<float>(layer + 1) + slack - from.at[longest]) / step[longest];
      enter = std::max(enter, std::min(a, b));
      leave = std::min(leave, std::max(a, b));
      if (enter > leave) enter = leave = std::min(std::max(enter, begin), end);
    }
    int low[3], high[3];
    for (int axis = 0; axis < 3; ++axis) {
      if (axis == longest) {
        low[axis] = high[axis] = layer;
        continue;
      }
      float p = at(axis, enter), q = at(axis, leave);
      low[axis] = voxel_index(std::min(p, q) - slack);
      high[axis] = voxel_index(std::max(p, q) + slack);
    }
    for_each_voxel(low, high, [&](std::uint32_t voxel) { set_bit(t, voxel, block); });
  }
}

void begin_dirty(RayTables* t) { std::memset(t->dirty.data, 0, t->dirty.bytes()); }

void add_dirty(RayTables* t, const Box& changed) {
  if (is_empty(changed)) return;
  GridPlace low = grid_place(*t, changed.low), high = grid_place(*t, changed.high);
  int first[3], last[3];
  for (int axis = 0; axis < 3; ++axis) {
    first[axis] = voxel_index(low.at[axis] - low.slack);
    last[axis] = voxel_index(high.at[axis] + high.slack);
  }
  auto add = [&](std::uint32_t voxel) {
    for (std::uint32_t i = 0; i < t->words_per_voxel; ++i)
      t->dirty[i] |= t->words[std::size_t(voxel) * t->words_per_voxel + i].load(std::memory_order_relaxed);
  };
  for_each_voxel(first, last, add);
}

void clear_dirty(RayTables* t) {
  std::uint32_t any = 0;
  for (std::uint32_t word : t->dirty) any |= word;
  if (!any) return;
  for (std::uint32_t voxel = 0; voxel < kVoxelCount; ++voxel) {
    std::atomic<std::uint32_t>* words = t->words.data + std::size_t(voxel) * t->words_per_voxel;
    for (std::uint32_t i = 0; i < t->words_per_voxel; ++i) {
      std::uint32_t before = words[i].load(std::memory_order_relaxed);
      if (before & t->dirty[i]) words[i].store(before & ~t->dirty[i], std::memory_order_relaxed);
    }
  }
}

}  // namespace pocketray
