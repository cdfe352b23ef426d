#include "temporal/ray_tables.h"

#include <doctest/doctest.h>

#include <memory>

#include "base/rng.h"
#include "support/hard_case.h"

using namespace pocketray;

namespace {

struct OwnTables {
  std::unique_ptr<std::uint8_t[]> block;
  RayTables tables;
};

OwnTables own_tables(std::uint32_t side, const Box& bounds) {
  OwnTables own;
  std::size_t bytes = ray_tables_need(64, 48, side) + kArenaAlignment;
  own.block.reset(new std::uint8_t[bytes]);
  Arena arena = make_arena("tables", own.block.get(), bytes);
  own.tables = make_ray_tables(64, 48, side, &arena);
  CHECK(arena.used <= bytes);
  reset_tables(bounds, &own.tables);
  return own;
}

Vec3 point_in(Rng* rng, const Box& box) {
  Vec3 p;
  for (int axis = 0; axis < 3; ++axis) p[axis] = box.low[axis] + (box.high[axis] - box.low[axis]) * next_float(rng);
  return p;
}

std::uint32_t dirty_count(const RayTables& t) {
  std::uint32_t count = 0;
  for (std::uint32_t word : t.dirty) count += static_cast<std::uint32_t>(__builtin_popcount(word));
  return count;
}

}  // namespace

// Goal: no ray escapes the tables. Method: a random place on each of random rays, through grids of all sizes and
// places, flat ones too, from inside and outside; whatever changes there makes the ray's block dirty.
TEST_CASE("hard_59_a_change_on_a_ray_makes_its_block_dirty") {
  Rng rng = make_rng(59);
  std::uint64_t wrong = 0, tried = 0;
  const std::uint64_t count = static_cast<std::uint64_t>(gate_share(20000, 1000000));
  const Box grids[] = {{{-1, -1, -1}, {1, 2, 3}},
                       {{1e5f, 1e5f, 1e5f}, {1e5f + 1, 1e5f + 2, 1e5f + 3}},
                       {{-1e-9f, -1e-9f, -1e-9f}, {1e-9f, 2e-9f, 1e-9f}},
                       {{-3, 0, -3}, {3, 0, 3}},
                       {{0, 0, 0}, {0, 0, 0}},
                       {{-1e18f, -1e18f, -1e18f}, {1e18f, 1e18f, 1e18f}}};
  for (const Box& grid : grids) {
    OwnTables own = own_tables(16, grid);
    Vec3 room = extent(grid) * 2.0f;
    const Box around = {grid.low - room, grid.high + room};
    for (std::uint64_t i = 0; i < count / 6; ++i) {
      Ray ray;
      ray.origin = point_in(&rng, next_u32(&rng) % 2 ? grid : around);
      ray.direction = point_in(&rng, next_u32(&rng) % 2 ? grid : around) - ray.origin;
      if (next_u32(&rng) % 8 == 0) ray.direction[static_cast<int>(next_u32(&rng) % 3)] = 0;
      if (next_u32(&rng) % 2) ray.direction = normalize(ray.direction);
      if (is_zero(ray.direction)) continue;
      float t = length(extent(around)) / length(ray.direction) * next_float(&rng);
      if (next_u32(&rng) % 4 == 0) t *= 0.01f;
      ray.t_max = __builtin_inff();
      std::uint32_t block = next_u32(&rng) % 256;
      mark_ray(own.tables, ray, next_u32(&rng) % 2 ? t : ray.t_max, block);
      Vec3 place = ray.origin + ray.direction * t;
      if (!contains(own.tables.bounds, {place, place})) continue;
      ++tried;
      begin_dirty(&own.tables);
      add_dirty(&own.tables, {place, place});
      wrong += !is_dirty(own.tables, block);
      clear_dirty(&own.tables);
      begin_dirty(&own.tables);
      add_dirty(&own.tables, around);
      clear_dirty(&own.tables);
    }
  }
  count_hard(tried, wrong, "marked ⊇ changed");
  CHECK(wrong == 0);
  CHECK(tried > count / 8);
}

// Goal: tables tell near from far. Method: parallel rays, each of its own block; a small change makes only few dirty.
TEST_CASE("ray_tables_leave_out_rays_that_are_far_away") {
  OwnTables own = own_tables(16, {{-1, -1, -1}, {1, 1, 1}});
  for (std::uint32_t block = 0; block < 256; ++block) {
    float x = -0.95f + 1.9f * static_cast<float>(block % 16) / 15,
          y = -0.95f + 1.9f * static_cast<float>(block / 16) / 15;
    mark_ray(own.tables, {{x, y, -2}, {0, 0, 1}, __builtin_inff()}, 3, block);
  }
  begin_dirty(&own.tables);
  add_dirty(&own.tables, {{0.01f, 0.01f, 0}, {0.02f, 0.02f, 0.1f}});
  CHECK(dirty_count(own.tables) >= 1);
  CHECK(dirty_count(own.tables) <= 9);
  begin_dirty(&own.tables);
  add_dirty(&own.tables, {{-1, -1, 1.15f}, {1, 1, 1.2f}});  // the rays end before it
  CHECK(dirty_count(own.tables) == 0);
}

// Goal: cleared blocks are forgotten, others are kept.
TEST_CASE("ray_tables_forget_dirty_blocks_alone") {
  OwnTables own = own_tables(4, {{-1, -1, -1}, {1, 1, 1}});
  mark_ray(own.tables, {{0.5f, 0.5f, -0.5f}, {0, 0, 1}, 1}, 1, 3);
  mark_ray(own.tables, {{-0.5f, -0.5f, -0.5f}, {0, 0, 1}, 1}, 1, 7);
  begin_dirty(&own.tables);
  add_dirty(&own.tables, {{0.4f, 0.4f, 0}, {0.6f, 0.6f, 0}});
  CHECK(is_dirty(own.tables, 3));
  CHECK(!is_dirty(own.tables, 7));
  clear_dirty(&own.tables);
  begin_dirty(&own.tables);
  add_dirty(&own.tables, {{-1, -1, -1}, {1, 1, 1}});
  CHECK(!is_dirty(own.tables, 3));
  CHECK(is_dirty(own.tables, 7));
}

// Goal: the paper's size. Method: 16 × 16 bits are 32 bytes for each voxel [Jevans92] sec. 3.2.
TEST_CASE("ray_tables_of_16_take_32_bytes_a_voxel") {
  CHECK(own_tables(16, {{0, 0, 0}, {1, 1, 1}}).tables.words_per_voxel * 4 == 32);
  CHECK(ray_tables_need(320, 240, 16) < kVoxelCount * 32 + 2048);
}

// Goal: the grid follows the scene. Method: bounds that grow, shrink a little, and shrink a lot.
TEST_CASE("ray_tables_grid_grows_and_shrinks_with_the_scene") {
  OwnTables own = own_tables(4, {{-1, -1, -1}, {1, 1, 1}});
  RayTables* t = &own.tables;
  CHECK(contains(t->bounds, {{-1, -1, -1}, {1, 1, 1}}));
  reset_tables({{-1, -1, -1}, {9, 1, 1}}, t);
  CHECK(contains(t->bounds, {{-1, -1, -1}, {9, 1, 1}}));
  reset_tables({{-1, -1, -1}, {2, 1, 1}}, t);
  CHECK(t->bounds.high.x > 9);
  reset_tables({{-1e6f, -1, -1}, {2, 1, 1}}, t);
  CHECK(t->bounds.low.x < -1e6f);
  reset_tables({{-1, -1, -1}, {1, 1, 1}}, t);
  CHECK(t->bounds.low.x > -2);
}

// Goal: a scene that keeps growing outgrows its grid in few frames. Method: closed form: it grows by a step a frame to
// ten times its size; each new grid has half of its size to spare, so the next is needed after that much, not a step.
TEST_CASE("ray_tables_grid_grows_by_halves") {
  OwnTables own = own_tables(4, {{0, 0, 0}, {1, 1, 1}});
  RayTables* t = &own.tables;
  CHECK(t->bounds.high.x == 1.125f);
  int outgrown = 0;
  for (int frame = 1; frame <= 900; ++frame) {
    const Box scene = {{0, 0, 0}, {1 + 0.01f * static_cast<float>(frame), 1, 1}};
    if (contains(t->bounds, scene)) continue;
    ++outgrown;
    reset_tables(scene, t);
    CHECK(t->bounds.high.x == doctest::Approx(1.5 * double(scene.high.x)));
  }
  CHECK(outgrown == 6);  // at 1.13, 1.70, 2.55, 3.83, 5.74 and 8.61
}
