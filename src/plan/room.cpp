#include "plan/room.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "accel/triangle.h"
#include "base/check.h"
#include "base/fmath.h"

namespace pocketray {
namespace {

struct Corners {
  Vec3 a, b, c;
};
// Relative to a point.
Corners corners(const Scene& scene, const Triangle& t, const Vec3& from) {
  return {scene.positions[t.vertex(0)] - from, scene.positions[t.vertex(1)] - from,
          scene.positions[t.vertex(2)] - from};
}

// By the divergence theorem, ∑ (corner · area vector) / 3 is the enclosed volume, negative if normals point inward.
double enclosed_volume(const Scene& scene, const Vec3& middle) {
  CHECK(is_finite(middle));
  double volume = 0;
  for (const Triangle& t : scene.triangles) {
    const Corners k = corners(scene, t, middle);
    volume += static_cast<double>(dot(k.a, cross(k.b, k.c))) / 6;
  }
  return volume;
}

// Returns whether a shell that encloses its middle is empty: no light, and no surface that is turned away from the
// middle, as every piece of furniture has. `volume`: the enclosed one.
bool holds_nothing(const Scene& scene, const Vec3& middle, double volume) {
  constexpr double kShareMax = 1e-5;  // chosen: of a room's volume, the part between its middle and the back of a book
  if (scene.lights.count) return false;
  double turned_away = 0;
  for (const Triangle& t : scene.triangles) {
    if (!is_zero(scene.materials[t.material()].emission)) return false;
    const Corners k = corners(scene, t, middle);
    turned_away += std::max(static_cast<double>(dot(k.a, cross(k.b, k.c))) / 6, 0.0);
  }
  return turned_away <= kShareMax * std::fabs(volume);
}

// Solid angle of all triangles that face a point, as if each were small: more than all directions if surfaces surround
// the point, almost zero inside a solid.
float facing_solid_angle(const Scene& scene, const Vec3& from) {
  float sum = 0;
  for (const Triangle& t : scene.triangles) {
    const Corners k = corners(scene, t, from);
    const Vec3 centroid = (k.a + k.b + k.c) * (1.0f / 3);
    const float facing = -dot(cross(k.b - k.a, k.c - k.a), centroid) * 0.5f, distance = length(centroid);
    if (facing > 0 && distance > 0) sum += facing / distance / distance / distance;
  }
  return sum;
}

constexpr int kLooks = 26;     // towards the neighbours in a cube of cubes
constexpr int kWallsMin = 20;  // chosen: five pass through a missing wall (tests/plan/room_test.cpp); one more may miss

struct Look {
  Ray ray;
  ShearedRay sheared;
  std::uint32_t from = kNoTriangle;  // triangle to ignore
  float distance = std::numeric_limits<float>::infinity();
  std::uint32_t triangle = kNoTriangle;
  bool is_front = false, is_square = false;  // square: a wall across an axis, a floor or a ceiling
};

// Finds the first triangle along each ray.
void look_around(const Scene& scene, Array<Look> looks) {
  CHECK(looks.data != nullptr);
  for (std::uint32_t i = 0; i < scene.triangles.count; ++i) {
    const Triangle& t = scene.triangles[i];
    if (!is_hittable(scene.positions, t)) continue;
    const Vec3 &a = scene.positions[t.vertex(0)], &b = scene.positions[t.vertex(1)], &c = scene.positions[t.vertex(2)];
    for (Look& look : looks) {
      Hit hit;
      if (look.from == i) continue;
      if (!intersect_triangle(look.sheared, a, b, c, &hit) || !(hit.t > 0 && hit.t < look.distance)) continue;
      const Vec3 normal = normalize(cross(b - a, c - a));
      look.distance = hit.t, look.triangle = i, look.is_front = dot(normal, look.ray.direction) < 0;
      look.is_square = max_component(abs(normal)) > 0.99f;  // within 8°
    }
  }
}

bool make_look(const Vec3& from, const Vec3& direction, Look* look) {
  look->ray = {from, direction, std::numeric_limits<float>::infinity()};
  return make_sheared_ray(look->ray, &look->sheared);
}

// Distance from the middle of a box to its sides.
float distance_to_sides(const Box& box, const Vec3& direction) {
  CHECK(!is_empty(box) && !is_zero(direction));
  const Vec3 half = extent(box) * 0.5f, along = abs(direction);
  float distance = std::numeric_limits<float>::infinity();
  for (int k = 0; k < 3; ++k)
    if (along[k] > 0) distance = std::min(distance, half[k] / along[k]);
  return distance;
}

// Returns whether nearly all rays from the middle hit the front of a surface, on average near the bounds rather than
// close by, as in a thicket; and most of them a floor, a ceiling or a straight wall, unlike in a vessel. The thresholds
// are chosen; tests/plan/room_test.cpp has rooms and other things on either side.
bool has_walls_around(const Scene& scene, const Box& bounds) {
  const Vec3 middle = center(bounds);
  if (!(facing_solid_angle(scene, middle) > 0.6f * 4 * kPiF)) return false;
  Look looks[kLooks];
  std::uint32_t count = 0;
  for (int i = 0; i < 27; ++i) {
    const Vec3 to = {static_cast<float>(i % 3 - 1), static_cast<float>(i / 3 % 3 - 1), static_cast<float>(i / 9 - 1)};
    if (is_zero(to)) continue;
    // Turned a little: many rooms' edges align with the cube's.
    if (!make_look(middle, normalize(to + Vec3{0.05f, 0.03f, -0.04f}), &looks[count++])) return false;
  }
  CHECK_EQ(count, static_cast<std::uint32_t>(kLooks));
  look_around(scene, {looks, count});
  int walls = 0, square = 0;
  float reach = 0;
  for (const Look& look : looks) {
    if (!look.is_front) continue;
    ++walls, square += look.is_square, reach += look.distance / distance_to_sides(bounds, look.ray.direction);
  }
  return walls >= kWallsMin && 2 * square > walls && reach > 0.5f * static_cast<float>(walls);
}

}  // namespace

float free_distance(const Scene& scene, const Vec3& from, const Vec3& direction) {
  CHECK(is_finite(from) && is_finite(direction));
  Look look;
  if (!make_look(from, direction, &look)) return look.distance;
  look_around(scene, {&look, 1});
  return look.distance;
}

bool lamps_light_up(const Scene& scene) {
  auto emits = [&](const Triangle& t) {
    const Material& m = scene.materials[t.material()];
    return !is_zero(m.emission) && !m.unlit && m.emission_texture.texture == kNone && is_hittable(scene.positions, t);
  };
  auto area_vector = [&](const Triangle& t) {
    const Corners k = corners(scene, t, scene.positions[t.vertex(0)]);
    return cross(k.b, k.c) * 0.5f;
  };
  double area = 0, before = 0;
  for (const Triangle& t : scene.triangles)
    if (emits(t)) area += static_cast<double>(length(area_vector(t)));
  if (!(area > 0)) return false;
  constexpr int kLampLooks = 64, kLitMin = 6;  // chosen: a lit object catches less of its own glow
  Look looks[kLampLooks];
  std::uint32_t count = 0;
  int next = 0;
  for (std::uint32_t i = 0; i < scene.triangles.count && next < kLampLooks; ++i) {
    const Triangle& t = scene.triangles[i];
    if (!emits(t)) continue;
    const Vec3 outward = area_vector(t);
    before += static_cast<double>(length(outward));
    const Corners k = corners(scene, t, {0, 0, 0});
    Vec3 normal = normalize(outward), tangent, bitangent;
    make_basis(normal, &tangent, &bitangent);
    for (; next < kLampLooks && (next + 0.5) / kLampLooks * area <= before; ++next) {
      const double square = (next * 29 % kLampLooks + 0.5) / kLampLooks, angle = next * 2.399963;  // the golden angle
      const float out = static_cast<float>(std::sqrt(square)), up = static_cast<float>(std::sqrt(1 - square));
      const Vec3 direction = tangent * (out * static_cast<float>(det_cos(angle))) +
                             bitangent * (out * static_cast<float>(det_sin(angle))) +
                             normal * (scene.materials[t.material()].double_sided && next % 2 ? -up : up);
      const float u = static_cast<float>(next * 13 % 32 + 1) / 66, v = static_cast<float>(next * 7 % 32 + 1) / 66;
      Look& look = looks[count];
      if (!make_look(k.a * (1 - u - v) + k.b * u + k.c * v, direction, &look)) continue;
      look.from = i, ++count;
    }
  }
  look_around(scene, {looks, count});
  int lit = 0;
  for (std::uint32_t i = 0; i < count; ++i) {
    if (looks[i].triangle == kNoTriangle) continue;
    const Material& m = scene.materials[scene.triangles[looks[i].triangle].material()];
    lit += !m.unlit && !(is_zero(m.diffuse) && is_zero(m.specular));
  }
  return lit >= kLitMin;
}

Vec3d shown_area(const Scene& scene, const Box& bounds) {
  CHECK(!is_empty(bounds));
  const Vec3 middle = center(bounds);
  Vec3d area = {0, 0, 0};
  for (const Triangle& t : scene.triangles) {
    const Corners k = corners(scene, t, middle);
    const Vec3 twice = cross(k.b - k.a, k.c - k.a);
    area += Vec3d{twice.x, twice.y, twice.z} * 0.5;
  }
  return area;
}

Room find_room(const Scene& scene, const Box& bounds) {
  Room room;
  if (is_empty(bounds)) return room;
  const Vec3 size = extent(bounds);
  const double box_volume = static_cast<double>(size.x) * static_cast<double>(size.y) * static_cast<double>(size.z);
  const double volume = enclosed_volume(scene, center(bounds));
  const bool encloses = -volume > 0.5 * box_volume;
  room.has_thick_walls = !encloses && box_volume > 0 && has_walls_around(scene, bounds);
  room.is_room = encloses || room.has_thick_walls;
  if (!encloses) return room;
  // The area vectors of a closed surface add up to zero; a remainder is the area vector of the missing side.
  // Less than 0.3 of one, chosen, is a door or a window.
  const Vec3d area = shown_area(scene, bounds);
  const double side = length(area), box_side = static_cast<double>(half_area(bounds)) / 3;
  // A closed shell around nothing is a body whose winding is reversed.
  if (side < 1e-3 * box_side && holds_nothing(scene, center(bounds), volume)) return Room();
  if (side > 0.3 * box_side)
    room.opening = {static_cast<float>(area.x / side), static_cast<float>(area.y / side),
                    static_cast<float>(area.z / side)};
  return room;
}

}  // namespace pocketray
