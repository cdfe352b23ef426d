// What is special about the voxel grid: it is divided while rays pass, in a pool that may be full, by several threads.
#include "accel/grid.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <chrono>
#include <thread>

#include "accel/accel_world.h"
#include "accel/grid_pool.h"
#include "support/effort.h"

using namespace pocketray;

namespace {

constexpr std::uint64_t kUsualPool = 1u << 16;

// Dense clusters, each for a few voxels of the root grid, which are then divided.
Mesh clusters(int count, std::uint64_t seed) {
  Mesh mesh;
  Rng rng = make_rng(seed);
  for (int i = 0; i < count; ++i) {
    Vec3 middle = random_vec3(&rng, 1);
    for (int k = 0; k < 60; ++k) {
      Vec3 p = middle + random_vec3(&rng, 0.05f);
      add_triangle(&mesh, p, p + random_vec3(&rng, 0.015f), p + random_vec3(&rng, 0.015f));
    }
  }
  return mesh;
}

// A grid with a pool of that many words.
std::unique_ptr<World> make_grid_world(const Mesh& mesh, std::uint64_t pool_words) {
  static AccelInfo info;
  static std::uint64_t words;
  words = pool_words, info = kGridAccel;
  info.need = [](std::uint32_t triangle_count) { return grid_need(triangle_count, words); };
  info.build = [](Accel* accel, Arena* keep, Arena* scratch) { grid_build(accel, keep, scratch, words); };
  return make_world(mesh, &info);
}

const GridHeader& header_of(const World& world) { return Grid(world.accel).header(); }

// Rays across the scene from one of its sides to the other; `part` moves them from top to bottom.
Ray ray_across(Rng* rng, float part) {
  Vec3 from = random_vec3(rng, 1), to = random_vec3(rng, 1);
  from.z = -3, to.z = 3, from.y = to.y = 2 * part - 1;
  return {from, to - from, next_u32(rng) % 4 ? kInfinity : 0.7f};
}

struct Asked {
  std::vector<Ray> rays;
  std::vector<Hit> hits;
};

// Rays as of a picture, rendered from top to bottom `rounds` times, and the answers of brute force.
Asked ask_brute_force(const Mesh& mesh, int ray_count, int rounds, std::uint64_t seed) {
  auto oracle = make_world(mesh, &kBruteAccel);
  Rng rng = make_rng(seed);
  Asked asked;
  for (int i = 0; i < ray_count; ++i) {
    float place = static_cast<float>(i) * static_cast<float>(rounds) / static_cast<float>(ray_count);
    asked.rays.push_back(ray_across(&rng, place - std::floor(place)));
    asked.hits.push_back(closest(*oracle, asked.rays.back()));
  }
  return asked;
}

int wrong_answers(const World& world, const Asked& asked) {
  int wrong = 0;
  for (std::size_t i = 0; i < asked.rays.size(); ++i) {
    bool found = asked.hits[i].triangle != kNoTriangle;
    Hit hit = closest(world, asked.rays[i]);
    wrong += found ? !same_hit(hit, asked.hits[i]) : hit.triangle != kNoTriangle;
    wrong += kGridAccel.occluded(world.accel, asked.rays[i], nullptr, nullptr) != found;
  }
  return wrong;
}

// Whether every voxel that names a grid is named by it, every list is within its grid and holds hittable ids in order,
// and the pool's blocks fill it. Counts the grids that voxels name.
bool is_consistent(const World& world, std::uint32_t* reached) {
  Grid grid(world.accel);
  GridHeader& h = grid.header();
  bool sound = true;
  std::uint32_t in_use = 0;
  *reached = 0;
  auto check_cells = [&](std::uint32_t place) {
    GridNode& node = grid.node(place);
    const GridCell* cells = cells_of(node);
    for (std::uint32_t i = 0; i < cell_count_of(node.shape); ++i) {
      std::uint32_t child = cells[i].child;
      sound = sound && cells[i].begin <= cells[i + 1].begin;
      for (std::uint32_t k = cells[i].begin; k < cells[i + 1].begin; ++k) {
        sound = sound && ids_of(node)[k] < world.triangles.size();
        sound = sound && (k == cells[i].begin || ids_of(node)[k - 1] < ids_of(node)[k]);
      }
      if (child <= kSubdividedWithoutGrid) continue;
      ++*reached;
      const GridNode& below = grid.node(child);
      sound = sound && child >= h.pool_begin && child < h.pool_end && (below.block & kBlockInUse) &&
              below.parent == place && below.cell == i && below.depth == node.depth + 1;
    }
  };
  check_cells(kRootPlace);
  std::uint32_t place = h.pool_begin;
  for (; sound && place < h.pool_end; place += grid.node(place).block & ~kBlockInUse) {
    if (!(grid.node(place).block & kBlockInUse)) continue;
    ++in_use;
    check_cells(place);
  }
  return sound && place == h.pool_end && in_use == *reached && in_use == h.grid_count - h.given_up_count;
}

}  // namespace

// Goal: a voxel is divided when a ray first enters it, never before and never again. Method: no grids after the build;
// rays through one half of a scene make some, the same rays no further ones, rays through the other half do.
TEST_CASE("grid_is_divided_where_a_ray_first_enters") {
  Mesh mesh = clusters(100, 151);
  auto world = make_grid_world(mesh, kUsualPool);
  CHECK(header_of(*world).grid_count == 0);
  auto trace = [&](float low) {
    Rng rng = make_rng(152);
    for (int i = 0; i < 200; ++i) closest(*world, ray_across(&rng, low + 0.4f * next_float(&rng)));
    return header_of(*world).grid_count;
  };
  std::uint32_t upper = trace(0), again = trace(0), both = trace(0.6f), reached;
  CHECK(upper > 20);
  CHECK(again == upper);
  CHECK(both > upper + 20);
  CHECK(header_of(*world).given_up_count == 0);
  CHECK(is_consistent(*world, &reached));
  CHECK(reached == both);
}

// Goal: division pays: fewer triangles are tested. Method: the counted work with and without room for grids.
TEST_CASE("grid_tests_fewer_triangles_where_it_is_divided") {
  Mesh mesh = soup("small among large", 4000, 0.1f, 0.01f, 153);
  for (const Vec3& p : soup("", 10, 1, 1, 154).positions) mesh.positions.push_back(p);
  for (std::uint32_t i = 12000; i < 12030; i += 3) mesh.triangles.emplace_back(i, i + 1, i + 2, 0);
  TraceStats divided, undivided;
  auto roomy = make_grid_world(mesh, kUsualPool), full = make_grid_world(mesh, 1);
  Rng rng = make_rng(155);
  for (int i = 0; i < 300; ++i) {
    Vec3 origin = random_vec3(&rng, 2), target = random_vec3(&rng, 0.1f);
    closest(*roomy, {origin, target - origin, kInfinity}, &divided);
    closest(*full, {origin, target - origin, kInfinity}, &undivided);
  }
  CHECK(header_of(*full).grid_count == 0);
  CHECK(3 * divided.triangles < undivided.triangles);
}

// Goal: without room in the pool, hits are the same, nothing is written beyond it, and grids that rays have left are
// given up for those they enter. Method: pools of one word and more, rays from top to bottom several times, against
// brute force; the list of blocks and every voxel are consistent afterwards. Each world has exactly the planned bytes.
TEST_CASE("grid_gives_up_inactive_grids_when_the_pool_is_full_and_answers_alike") {
  Mesh mesh = clusters(60, 156);
  Asked asked = ask_brute_force(mesh, effort(4000), 3, 157);
  for (std::uint64_t pool : {1, 17, 100, 400, 1500, 6000}) {
    auto world = make_grid_world(mesh, pool);
    INFO("pool of " << pool << " words");
    CHECK(wrong_answers(*world, asked) == 0);
    std::uint32_t reached;
    CHECK(is_consistent(*world, &reached));
    const GridHeader& h = header_of(*world);
    CHECK(h.walks == 0);
    CHECK(h.lock == 0);
    if (pool < 50) CHECK(h.grid_count == 0);
    INFO(h.grid_count << " grids, " << h.given_up_count << " given up");
    if (pool >= 1500 && kEffortDivisor == 1) CHECK(h.given_up_count > 10);
    CHECK(world->keep.used_max <= grid_need(3600, pool));
  }
}

// Goal: what rays enter again and again stays, what they left is given up. Method: one beam at every other ray, others
// from top to bottom through a small pool: the beam's voxels are still divided when asked at the end.
TEST_CASE("grid_keeps_what_rays_keep_entering") {
  Mesh mesh = clusters(60, 158);
  auto world = make_grid_world(mesh, 6000);
  Rng rng = make_rng(159);
  const Ray beam = {{0.01f, 0.02f, -3}, {0, 0, 1}, kInfinity};
  for (int i = 0; i < 3000; ++i) {
    closest(*world, ray_across(&rng, static_cast<float>(i % 1000) / 1000));
    closest(*world, beam);
  }
  std::uint32_t given_up = header_of(*world).given_up_count, made = header_of(*world).grid_count;
  closest(*world, beam);
  CHECK(given_up > 50);
  CHECK(header_of(*world).grid_count == made);
}

// Goal: blocks of the pool never overlap, however it is searched. Method: random requests, successful and in vain, and
// random blocks given up; after each, the blocks fill the pool, and those taken are where they were.
TEST_CASE("grid_pool_keeps_blocks_apart") {
  for (std::uint64_t seed = 1; seed <= static_cast<std::uint64_t>(effort(300)); ++seed) {
    auto world = make_grid_world(clusters(1, 171), 1000);
    Grid grid(world->accel);
    GridHeader& h = grid.header();
    const GridVisit visit(&h);
    Rng rng = make_rng(seed);
    std::vector<std::pair<std::uint32_t, std::uint32_t>> taken;  // place and size
    bool sound = true;
    for (int i = 0; i < 200 && sound; ++i) {
      const auto [limit, size] = std::pair(next_u32(&rng) % 3 ? 60u : 600u, next_u32(&rng));
      const std::uint32_t words = 16 + size % limit;
      h.rest = 0;
      // Whatever is taken counts as just entered: nothing is given up but by this test.
      h.clock.store(0), h.words_since_tick = 0;
      if (std::uint32_t place = take_block(grid, kRootPlace, words)) {
        GridNode& node = grid.node(place);
        node.parent = kRootPlace, node.cell = 0, node.stamp.store(0);
        taken.emplace_back(place, node.block & ~kBlockInUse);
        sound = taken.back().second >= words;
      }
      while (!taken.empty() && next_u32(&rng) % 2) {
        const std::size_t n = next_u32(&rng) % taken.size();
        grid.node(taken[n].first).block &= ~kBlockInUse;
        taken.erase(taken.begin() + static_cast<std::ptrdiff_t>(n));
      }
      std::size_t found = 0;
      std::uint32_t at = h.pool_begin;
      while (sound && at < h.pool_end) {
        const std::uint32_t block = grid.node(at).block, length = block & ~kBlockInUse;
        if (block & kBlockInUse) {
          ++found;
          sound = std::find(taken.begin(), taken.end(), std::pair(at, length)) != taken.end();
        }
        sound = sound && length > 0 && length <= h.pool_end - at;
        at += length;
      }
      sound = sound && at == h.pool_end && found == taken.size();
    }
    CAPTURE(seed);
    CHECK(sound);
  }
}

// Goal: threads that divide and give up voxels of one grid at the same time get the answers of brute force. Method: a
// roomy and a small pool, threads that start together on rays in different order.
TEST_CASE("grid_is_divided_by_several_threads_at_once_with_the_same_answers") {
  Mesh mesh = clusters(60, 160);
  Asked asked = ask_brute_force(mesh, effort(3000), 2, 161);
  for (std::uint64_t pool : {std::uint64_t(1500), std::uint64_t(6000), kUsualPool})
    for (int round = 0; round < 4; ++round) {
      auto world = make_grid_world(mesh, pool);
      constexpr int kThreads = 3;
      std::thread threads[kThreads];
      int wrong[kThreads];
      for (int n = 0; n < kThreads; ++n)
        threads[n] = std::thread([&, n] {
          Asked mine = asked;
          if (n == 1)
            std::reverse(mine.rays.begin(), mine.rays.end()), std::reverse(mine.hits.begin(), mine.hits.end());
          wrong[n] = wrong_answers(*world, mine);
        });
      for (std::thread& thread : threads) thread.join();
      INFO("pool of " << pool << " words, round " << round);
      for (int n : wrong) CHECK(n == 0);
      std::uint32_t reached;
      CHECK(is_consistent(*world, &reached));
      CHECK(header_of(*world).walks == 0);
    }
}

namespace {

// A query that stays under way until another thread waits for its end, or has not had to.
struct Pause {
  GridHeader& header;
  std::atomic<bool>& other_done;
  mutable std::uint32_t given_up_count = 0;
  static bool accept(const void* context, std::uint32_t, float, float) {
    const Pause& pause = *static_cast<const Pause*>(context);
    while (pause.header.walks < 1u << 31 && !pause.other_done) std::this_thread::yield();
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    pause.given_up_count = pause.header.given_up_count;
    return true;
  }
};

}  // namespace

// Goal: no grid is given up while another thread's query may be in it. Method: a query whose filter waits; the other
// thread fills the pool meanwhile, and gives up grids only after the query has ended.
TEST_CASE("grid_is_not_given_up_while_a_query_is_under_way") {
  Mesh mesh = clusters(60, 163);
  mesh.positions.push_back({-2, -2, 0}), mesh.positions.push_back({2, -2, 0}), mesh.positions.push_back({0, 3, 0});
  mesh.triangles.emplace_back(10800, 10801, 10802, 0);
  auto world = make_grid_world(mesh, 6000);
  std::atomic<bool> done{false};
  Pause pause = {Grid(world->accel).header(), done};
  HitFilter filter = {Pause::accept, &pause};
  std::thread other([&] {
    while (pause.header.walks == 0) std::this_thread::yield();
    Rng rng = make_rng(164);
    for (int i = 0; i < 3000; ++i) closest(*world, ray_across(&rng, static_cast<float>(i % 1000) / 1000));
    done = true;
  });
  Hit hit = closest(*world, {{0.3f, 0.2f, -2}, {0, 0, 1}, kInfinity}, nullptr, &filter);
  CHECK(hit.triangle != kNoTriangle);
  other.join();
  CHECK(pause.given_up_count == 0);
  CHECK(header_of(*world).given_up_count > 0);
}

// Goal: a grid is not taken from a file. Method: its own data, and none.
TEST_CASE("grid_is_not_adopted") {
  auto world = make_world(soup("soup", 50, 1, 0.1f, 162), &kGridAccel);
  Accel copy = world->accel;
  CHECK_FALSE(kGridAccel.adopt(&copy, world->accel.data, {}).ok);
  CHECK_FALSE(kGridAccel.adopt(&copy, {}, {}).ok);
  CHECK(accel_of(world->accel.data) == nullptr);
}
