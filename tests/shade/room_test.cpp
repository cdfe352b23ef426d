// Closed rooms: HARDCASES row 24.
#include <doctest/doctest.h>

#include <string>

#include "scene/builtin_helpers.h"
#include "shade/shade_helpers.h"
#include "shade/surface.h"
#include "support/hard_case.h"
#include "support/scaled_scene.h"

using namespace pocketray;

namespace {

float between(Rng* rng, float low, float high) { return low + (high - low) * next_float(rng); }
Vec3 random_direction(Rng* rng) {
  float x = between(rng, -1, 1), y = between(rng, -1, 1);
  return normalize(Vec3{x, y, between(rng, -1, 1)});
}

// The Cornell box with its open front closed. Its walls are the first 17 triangles and the last 3; walls share vertices
// and edges.
std::unique_ptr<ScaledScene> closed_cornell(const Scene& cornell, float scale) {
  auto room = scale_scene(cornell, scale);
  constexpr std::uint32_t kFront[3][3] = {{12, 0, 4}, {12, 4, 5}, {12, 5, 1}};  // floor, ceiling, the floor's middle
  for (const auto& f : kFront) room->triangles.push_back({f[0], f[1], f[2], 0});
  room->bind();
  return room;
}

struct Room {
  const Renderer* renderer;
  Box inside;  // where paths start
  std::uint32_t first_walls, last_walls;
};

// Traces paths that start inside, half of them aimed at an edge or a corner of a wall, and continue in random
// directions. Returns how many of `ray_count` rays leave the room.
int rays_that_escape(const Room& room, Rng* rng, int ray_count) {
  constexpr int kPath = 4;
  const Renderer& renderer = *room.renderer;
  int escaped = 0;
  Ray ray;
  for (int i = 0; i < ray_count; ++i) {
    if (i % kPath == 0) {
      Vec3 size = extent(room.inside);
      auto within = [&] { return room.inside.low + size * Vec3{next_float(rng), next_float(rng), next_float(rng)}; };
      Vec3 from = within(), to = within();
      std::uint32_t wall = next_u32(rng) % (room.first_walls + room.last_walls);
      if (wall >= room.first_walls) wall = renderer.scene.triangles.count - 1 - (wall - room.first_walls);
      const Triangle& triangle = renderer.scene.triangles[wall];
      Vec3 a = renderer.scene.positions[triangle.vertex(i / kPath % 3)],
           b = renderer.scene.positions[triangle.vertex((i / kPath + 1) % 3)];
      if (i % (2 * kPath) == 0) to = i % (8 * kPath) == 0 ? a : a + (b - a) * next_float(rng);
      ray = {from, normalize(to - from), __builtin_inff()};
    }
    Hit hit;
    renderer.accel.info->closest(renderer.accel.built, ray, nullptr, &hit, nullptr);
    if (hit.triangle == kNoTriangle) {
      ++escaped;
      i += kPath - 1 - i % kPath;
      continue;
    }
    Surface surface;
    renderer.frame.kernels.surface(renderer.frame, ray, hit, &surface);
    Vec3 out = random_direction(rng);
    if (dot(out, surface.geometric) < 0) out = -out;
    ray = {safe_origin(surface, 1), out, __builtin_inff()};
  }
  return escaped;
}

}  // namespace

// Goal: nothing escapes from a closed room, neither camera rays nor rays from its walls, not even through edges and
// corners. Method: paths in the Cornell box with its front closed, large and small, and in the built-in rooms.
TEST_CASE("hard_24_nothing_escapes_from_a_closed_room") {
  auto cornell = build_builtin("cornell"), cube = build_builtin("cube"), furnace = build_builtin("furnace");
  auto large = closed_cornell(cornell->scene, 1), small = closed_cornell(cornell->scene, 1e-3f);
  Box box = {{5, 5, 5}, {540, 540, 550}};
  struct {
    const char* name;
    const Scene* scene;
    Box inside;
    std::uint32_t first_walls, last_walls;
    int usual, whole;
  } rooms[] = {{"cornell", &large->scene, box, 17, 3, 200000, 100000000},
               {"small cornell", &small->scene, {box.low * 1e-3f, box.high * 1e-3f}, 17, 3, 100000, 10000000},
               {"cube", &cube->scene, {{-0.9f, -0.9f, -0.9f}, {0.9f, 0.9f, 0.9f}}, 12, 0, 100000, 10000000},
               {"furnace", &furnace->scene, {{-0.5f, -0.5f, -0.5f}, {0.5f, 0.5f, 0.5f}}, 1, 0, 100000, 10000000}};
  rooms[3].first_walls = furnace->scene.triangles.count;
  for (const auto& it : rooms) {
    Settings settings;
    settings.width = 4, settings.height = 3;
    auto t = make_renderer(*it.scene, settings);
    Room room = {&t->renderer, it.inside, it.first_walls, it.last_walls};
    std::uint64_t rays = gate_share(it.usual, it.whole);
    std::uint64_t escaped =
        count_wrong(rays, 24, [&](Rng* rng, int count) { return rays_that_escape(room, rng, count); });
    INFO(std::string(it.name));
    CHECK(escaped == 0);
    count_hard(rays, escaped, "0 escape");
  }
}
