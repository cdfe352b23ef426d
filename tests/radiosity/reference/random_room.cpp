#include <algorithm>
#include <cmath>

#include "radiosity/reference/room_light.h"

namespace pocketray {
namespace {

struct RoomMaker {
  Rng rng;
  GeneratedScene* s;
  Vec3 size;  // the room lies between zero and this

  float among(float low, float high) { return low + (high - low) * next_float(&rng); }
  bool chance(float share) { return next_float(&rng) < share; }

  std::uint32_t paint(bool two_sided) {
    Material m;
    const float grey = among(.25f, .8f);
    m.diffuse = {grey, grey, grey};
    if (chance(.3f)) m.diffuse = {among(.1f, .8f), among(.1f, .8f), among(.1f, .8f)};
    m.double_sided = two_sided;
    return add_material(s, m);
  }
  std::uint32_t lamp(float radiance, bool two_sided) {
    Material m;
    const float grey = chance(.5f) ? 0 : among(.2f, .8f);
    m.diffuse = {grey, grey, grey};
    m.emission = Vec3{1, among(.7f, 1), among(.4f, 1)} * radiance;
    m.double_sided = two_sided;
    return add_material(s, m);
  }
  void rectangle(const Vec3& corner, const Vec3& along, const Vec3& up, std::uint32_t material) {
    add_quad(s, corner, corner + along, corner + along + up, corner + up, material);
  }
  // Below the ceiling or beside a wall, facing into the room.
  void add_lamp(float gap, bool two_sided) {
    const float width = among(.1f, .3f) * size.x, depth = among(.1f, .3f) * size.z;
    const std::uint32_t material = lamp(among(4, 20), two_sided);
    if (chance(.7f)) {
      const float x = among(.1f, .9f) * (size.x - width), z = among(.1f, .9f) * (size.z - depth);
      rectangle({x, size.y - gap, z}, {width, 0, 0}, {0, 0, depth}, material);
    } else {
      const float height = among(.1f, .3f) * size.y, y = among(.3f, .8f) * (size.y - height),
                  z = among(.1f, .9f) * (size.z - depth);
      rectangle({gap, y, z}, {0, height, 0}, {0, 0, depth}, material);
    }
  }
  // An open box at the left wall with a point light in it.
  void add_niche() {
    const float depth = among(.1f, .2f) * size.x, width = among(.2f, .4f) * size.z, height = among(.2f, .4f) * size.y;
    const float y = among(.1f, .9f) * (size.y - height), z = among(.1f, .9f) * (size.z - width);
    const std::uint32_t material = paint(true);
    rectangle({0, y, z}, {depth, 0, 0}, {0, 0, width}, material);
    rectangle({0, y + height, z}, {depth, 0, 0}, {0, 0, width}, material);
    rectangle({0, y, z}, {depth, 0, 0}, {0, height, 0}, material);
    rectangle({0, y, z + width}, {depth, 0, 0}, {0, height, 0}, material);
    Light light;
    light.position = {depth * among(.3f, .7f), y + height * among(.3f, .7f), z + width * among(.3f, .7f)};
    light.intensity = Vec3{1, .9f, .8f} * among(2, 6);
    s->lights.push_back(light);
  }
  // No plate lies in the plane of a lamp (kGaps): where they overlap, light would be that of either.
  void add_things() {
    for (int i = static_cast<int>(next_u32(&rng) % 4); i > 0; --i) {
      const Vec3 extent = size * Vec3{among(.1f, .3f), among(.1f, .6f), among(.1f, .3f)};
      const Vec3 low = {among(.05f, .95f) * (size.x - extent.x), chance(.8f) ? 0 : .1f * size.y,
                        among(.05f, .5f) * (size.z - extent.z)};
      add_box(s, low, low + extent, paint(false));
    }
    for (int i = static_cast<int>(next_u32(&rng) % 3); i > 0; --i) {  // plates, some from floor to ceiling
      const float reach = among(.2f, .5f), at = among(.15f, .85f), height = chance(.4f) ? 1 : among(.3f, .8f);
      const std::uint32_t material = paint(true);
      if (chance(.5f))
        rectangle({at * size.x, 0, 0}, {0, 0, reach * size.z}, {0, height * size.y, 0}, material);
      else
        rectangle({chance(.5f) ? 0 : size.x * (1 - reach), std::min(height, .95f) * size.y * .7f, at * size.z * .6f},
                  {reach * size.x, 0, 0}, {0, 0, reach * size.z * .4f}, material);
    }
  }
};

constexpr float kGaps[] = {.5f, .3f, .1f, .05f, .02f, .01f, .005f, .002f, .001f};

void add_walls(GeneratedScene* s, const Vec3& size, const std::uint32_t (&paint)[6]) {
  const Vec3 x = {size.x, 0, 0}, y = {0, size.y, 0}, z = {0, 0, size.z};
  auto wall = [&](const Vec3& a, const Vec3& along, const Vec3& up, std::uint32_t material) {
    add_quad(s, a, a + along, a + along + up, a + up, material);
  };
  wall({0, 0, 0}, x, y, paint[0]), wall(z, y, x, paint[1]);
  wall({0, 0, 0}, y, z, paint[2]), wall(x, z, y, paint[3]);
  wall({0, 0, 0}, z, x, paint[4]), wall(y, x, z, paint[5]);
}

}  // namespace

std::unique_ptr<GeneratedScene> random_room(std::uint64_t seed) {
  auto s = std::make_unique<GeneratedScene>();
  RoomMaker room = {make_rng(71, seed), s.get(), {}};
  room.size = Vec3{room.among(2, 6), room.among(2, 3.5f), room.among(2, 6)} * std::ldexp(1.0f, int(seed % 5) - 2);
  const std::uint32_t common = room.paint(false);
  std::uint32_t paint[6];
  for (std::uint32_t& p : paint) p = room.chance(.6f) ? common : room.paint(false);
  add_walls(s.get(), room.size, paint);
  room.add_things();
  const float share = kGaps[next_u32(&room.rng) % (sizeof kGaps / sizeof kGaps[0])];
  if (room.chance(.25f))
    room.add_niche();
  else
    room.add_lamp(share * room.size.y, room.chance(.6f));
  if (room.chance(.3f)) room.add_lamp(.4f * room.size.y, room.chance(.5f));
  aim(s.get(), room.size * Vec3{.6f, .6f, .96f}, room.size * Vec3{.45f, .45f, 0}, 70);
  s->bind();
  return s;
}

std::unique_ptr<GeneratedScene> room_with_lamp(float gap, bool two_sided) {
  auto s = std::make_unique<GeneratedScene>();
  Material m;
  m.diffuse = {.7f, .7f, .7f}, m.double_sided = 0;
  const std::uint32_t white = add_material(s.get(), m);
  m.diffuse = {.6f, .1f, .1f};
  const std::uint32_t red = add_material(s.get(), m);
  m.diffuse = {.5f, .5f, .5f}, m.emission = {10, 10, 10}, m.double_sided = two_sided;
  const std::uint32_t lamp = add_material(s.get(), m);
  add_walls(s.get(), {2, 2, 2}, {white, white, red, white, white, white});
  const float y = 2 - 2 * gap;
  add_quad(s.get(), {.77f, y, .73f}, {1.25f, y, .73f}, {1.25f, y, 1.21f}, {.77f, y, 1.21f}, lamp);
  aim(s.get(), {1.1f, 1.1f, 1.96f}, {1, 1, 0}, 70);
  s->bind();
  return s;
}

std::unique_ptr<GeneratedScene> divided_room(float at, bool dark_side) {
  auto s = std::make_unique<GeneratedScene>();
  Material m;
  m.diffuse = {.7f, .7f, .7f}, m.double_sided = 0;
  const std::uint32_t white = add_material(s.get(), m);
  m.double_sided = 1;
  const std::uint32_t plate = add_material(s.get(), m);
  m.emission = {10, 10, 10}, m.double_sided = 0;
  const std::uint32_t lamp = add_material(s.get(), m);
  add_walls(s.get(), {4, 2, 2}, {white, white, white, white, white, white});
  add_quad(s.get(), {at, 0, 0}, {at, 2, 0}, {at, 2, 2}, {at, 0, 2}, plate);
  add_quad(s.get(), {.5f, 1.9f, .8f}, {1, 1.9f, .8f}, {1, 1.9f, 1.2f}, {.5f, 1.9f, 1.2f}, lamp);
  if (dark_side)
    aim(s.get(), {3.9f, 1.1f, 1}, {at, 1, 1}, 80);
  else
    aim(s.get(), {.1f, 1.1f, 1}, {at, 1, 1}, 80);
  s->bind();
  return s;
}

}  // namespace pocketray
