#include <doctest/doctest.h>
#include <zlib.h>

#include <cstring>
#include <map>
#include <string>

#include "base/fmath.h"
#include "builtin_helpers.h"
#include "support/hard_case.h"

using namespace pocketray;

namespace {

// Material of the nearest triangle along the camera ray through (x, y), each from -1 (left, bottom) to 1 in a 4:3
// picture; kNone if there is none. Brute force in double.
std::uint32_t material_seen(const Scene& scene, double x, double y) {
  auto wide = [](const Vec3& v) { return Vec3d{v.x, v.y, v.z}; };
  const Camera& camera = scene.cameras[0];
  Vec3d eye = wide(camera.eye), forward = normalize(wide(camera.target) - eye);
  Vec3d right = normalize(cross(forward, wide(camera.up))), up = cross(right, forward);
  double half = static_cast<double>(camera.vertical_fov) / 2, scale = det_sin(half) / det_cos(half);
  Vec3d d = forward + right * (x * scale * 4 / 3) + up * (y * scale);
  double nearest = 1e300;
  std::uint32_t seen = kNone;
  for (const Triangle& t : scene.triangles) {
    Vec3d a = wide(scene.positions[t.vertex(0)]);
    Vec3d ab = wide(scene.positions[t.vertex(1)]) - a, ac = wide(scene.positions[t.vertex(2)]) - a;
    Vec3d p = cross(d, ac), s = eye - a, q = cross(s, ab);
    double det = dot(ab, p), u = dot(s, p) / det, v = dot(d, q) / det, along = dot(ac, q) / det;
    if (u >= 0 && v >= 0 && u + v <= 1 && along > 0 && along < nearest) nearest = along, seen = t.material();
  }
  return seen;
}

template <class T>
std::uint32_t add_crc(std::uint32_t crc, Array<T> array) {
  if (array.empty()) return crc;  // zlib restarts at a null pointer
  return static_cast<std::uint32_t>(
      crc32(crc, reinterpret_cast<const Bytef*>(array.data), static_cast<uInt>(array.bytes())));
}
std::uint32_t geometry_crc(const Scene& scene) {
  // Moving parts come last and are posed by animate.cpp, which has its own tests: their rest pose counts here.
  std::uint32_t still = scene.moving_meshes.empty() ? scene.positions.count : scene.moving_meshes[0].vertex_begin;
  std::uint32_t crc = add_crc(0, Array<const Vec3>{scene.positions.data, still});
  crc = add_crc(crc, Array<const Vec3>{scene.normals.data, still});
  for (const Triangle& t : scene.triangles) {
    const std::uint32_t values[4] = {t.vertex(0), t.vertex(1), t.vertex(2), t.material()};
    crc = add_crc(crc, Array<const std::uint32_t>{values, 4});
  }
  crc = add_crc(crc, scene.key_values);
  crc = add_crc(crc, scene.rest_positions);
  return add_crc(crc, scene.skin_weights);
}

}  // namespace

// Goal: the same bits from every compiler and CPU. Method: CRC-32 of the arrays of numbers against constants, built in
// memory filled with two different patterns.
TEST_CASE("hard_63_builtin_scenes_are_the_same_bits_everywhere") {
  count_assertions("the same bits in every build");
  const std::map<std::string, std::uint32_t> expected = {{"cornell", 436609683u},  {"statue", 2731962623u},
                                                         {"seesaw", 3685938664u},  {"cube", 2660268395u},
                                                         {"furnace", 1365366145u}, {"lanterns", 3854817036u}};
  int count;
  const BuiltinScene* list = builtin_list(&count);
  for (int i = 0; i < count; ++i) {
    for (int fill : {0, 255}) {
      std::vector<std::uint8_t> block(list[i].need() + kArenaAlignment);
      std::memset(block.data(), fill, block.size());
      Arena arena = make_arena("scene", block.data(), block.size());
      Scene scene;
      list[i].build(&arena, &scene);
      CAPTURE(std::string(list[i].name));
      CHECK(geometry_crc(scene) == expected.at(list[i].name));
    }
  }
}

// Goal: the picture is the familiar one: red left, green right, light above, statue left of the mirror sphere.
// Method: one ray each, recognised by the material.
TEST_CASE("builtin_cornell_looks_like_the_photograph") {
  const BuiltScene* built = shared_builtin("cornell");
  const Scene& scene = built->scene;
  auto seen = [&](double x, double y) {
    std::uint32_t material = material_seen(scene, x, y);
    REQUIRE(material != kNone);
    return scene.materials[material];
  };
  Material left = seen(-.62, 0), right = seen(.62, 0), light = seen(0, .71), ball = seen(.27, -.5),
           statue = seen(-.17, 0);
  CHECK(left.diffuse.x > 3 * left.diffuse.y);
  CHECK(right.diffuse.y > 3 * right.diffuse.x);
  CHECK(max_component(light.emission) > 1);
  CHECK(max_component(ball.mirror) > .5f);
  CHECK(max_component(statue.specular) > 0);
  CHECK(material_seen(scene, -.9, 0) == kNone);  // beside the box there is nothing
}

// Goal: cameras see something, and in closed scenes no ray escapes. Method: a grid of rays through the picture.
TEST_CASE("builtin_cameras_see_the_scene") {
  int count;
  const BuiltinScene* list = builtin_list(&count);
  for (int i = 0; i < count; ++i) {
    CAPTURE(std::string(list[i].name));
    const BuiltScene* built = shared_builtin(list[i]);
    int hits = 0;
    for (int y = -2; y <= 2; ++y)
      for (int x = -2; x <= 2; ++x) hits += material_seen(built->scene, .43 * x, .43 * y + .01) != kNone;
    const std::string name = list[i].name;
    CHECK(hits >= (name == "cornell" || name == "lanterns" ? 15 : 25));
  }
}

// Goal: every material is used, and every scene can be lit. Method: count uses.
TEST_CASE("builtin_materials_are_all_used_and_something_shines") {
  int count;
  const BuiltinScene* list = builtin_list(&count);
  for (int i = 0; i < count; ++i) {
    CAPTURE(std::string(list[i].name));
    const BuiltScene* built = shared_builtin(list[i]);
    const Scene& scene = built->scene;
    std::vector<int> uses(scene.materials.count);
    for (const Triangle& t : scene.triangles) ++uses[t.material()];
    for (std::uint32_t m = 0; m < scene.materials.count; ++m) {
      CAPTURE(m);
      CHECK(uses[m] > 0);
    }
    bool shines = scene.lights.count > 0;
    for (const Material& material : scene.materials) shines = shines || !is_zero(material.emission);
    CHECK(shines);
  }
}

// Goal: the furnace's closed form applies: one material, emission Le and albedo ρ with Le/(1 − ρ) = 1. Method: read
// them.
TEST_CASE("builtin_furnace_has_radiance_1_after_full_interreflection") {
  const BuiltScene* built = shared_builtin("furnace");
  REQUIRE(built->scene.materials.count == 1);
  const Material& wall = built->scene.materials[0];
  for (int c = 0; c < 3; ++c) CHECK(wall.emission[c] / (1 - wall.diffuse[c]) == 1.0f);
  CHECK(is_zero(wall.specular));
  CHECK(is_zero(wall.mirror));
}

// Goal: `lanterns` is lit by 200 point lights and 12 area lights, and no light hides in its own shade. Method: counts;
// each light lies below a lantern, outside of it.
TEST_CASE("builtin_lanterns_hang_above_their_lights") {
  const BuiltScene* built = shared_builtin("lanterns");
  const Scene& scene = built->scene;
  CHECK(scene.lights.count == 200);
  int windows = 0;
  for (const Material& m : scene.materials) windows += !is_zero(m.emission);
  CHECK(windows == 12);
  int below = 0;
  for (const Light& light : scene.lights) {
    float nearest = 1e30f;  // height of the nearest paper above the light
    for (const Triangle& t : scene.triangles) {
      if (!scene.materials[t.material()].unlit) continue;
      const Vec3 way = scene.positions[t.vertex(0)] - light.position;
      if (length(way) < .3f && way.y < nearest) nearest = way.y;
    }
    below += nearest > 0 && nearest < .2f;
  }
  CHECK(below == 200);
}
