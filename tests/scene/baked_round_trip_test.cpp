#include <doctest/doctest.h>

#include <cstring>
#include <memory>

#include "scene/baked.h"
#include "scene/baked_file.h"
#include "scene/full_scene.h"

using namespace pocketray;

namespace {

template <class T>
bool same_bytes(Array<const T> a, Array<const T> b) {
  return a.count == b.count && (a.count == 0 || std::memcmp(a.data, b.data, a.bytes()) == 0);
}

bool same_scene(const Scene& a, const Scene& b) {
  return std::memcmp(&a.info, &b.info, sizeof a.info) == 0 && same_bytes(a.positions, b.positions) &&
         same_bytes(a.normals, b.normals) && same_bytes(a.uvs, b.uvs) && same_bytes(a.colors, b.colors) &&
         same_bytes(a.triangles, b.triangles) && same_bytes(a.materials, b.materials) &&
         same_bytes(a.textures, b.textures) && same_bytes(a.texels, b.texels) && same_bytes(a.lights, b.lights) &&
         same_bytes(a.cameras, b.cameras) && same_bytes(a.nodes, b.nodes) && same_bytes(a.animations, b.animations) &&
         same_bytes(a.channels, b.channels) && same_bytes(a.key_times, b.key_times) &&
         same_bytes(a.key_values, b.key_values) && same_bytes(a.weights, b.weights) && same_bytes(a.skins, b.skins) &&
         same_bytes(a.joints, b.joints) && same_bytes(a.moving_meshes, b.moving_meshes) &&
         same_bytes(a.rest_positions, b.rest_positions) && same_bytes(a.rest_normals, b.rest_normals) &&
         same_bytes(a.skin_weights, b.skin_weights) && same_bytes(a.morph_positions, b.morph_positions) &&
         same_bytes(a.morph_normals, b.morph_normals) && same_bytes(a.accel, b.accel) &&
         same_bytes(a.material_maps, b.material_maps) && same_bytes(a.environment_info, b.environment_info) &&
         same_bytes(a.environment_texels, b.environment_texels) && same_bytes(a.grains, b.grains) &&
         same_bytes(a.tangents, b.tangents) && same_bytes(a.second_uvs, b.second_uvs) &&
         same_bytes(a.clear_coats, b.clear_coats) && same_bytes(a.default_view, b.default_view) &&
         same_bytes(a.animation_labels, b.animation_labels) && same_bytes(a.node_visible, b.node_visible) &&
         same_bytes(a.origin, b.origin) && same_bytes(a.sheens, b.sheens) && same_bytes(a.framings, b.framings) &&
         same_bytes(a.glass_maps, b.glass_maps) && same_bytes(a.iridescences, b.iridescences) &&
         same_bytes(a.diffuse_transmissions, b.diffuse_transmissions);
}

}  // namespace

// Goal: baking is lossless. Method: scenes with every array in use, seeds 1 to 20, compared byte by byte.
TEST_CASE("baked_round_trip_is_bit_identical") {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    CAPTURE(seed);
    FullScene full;
    make_full_scene(seed, 12 + static_cast<std::uint32_t>(seed) * 3, static_cast<std::uint32_t>(seed) * 7, &full);
    Status valid = validate_scene(full.scene);
    REQUIRE_MESSAGE(valid.ok, valid.message);
    BakedFile file = bake(full.scene);
    Scene opened;
    Status status = baked_open(file.data(), file.size(), &opened);
    REQUIRE_MESSAGE(status.ok, status.message);
    CHECK(same_scene(full.scene, opened));
    CHECK(scene_hash(opened) == scene_hash(full.scene));
  }
}

// Goal: the empty scene is a file like any other.
TEST_CASE("baked_round_trip_empty_scene") {
  Scene empty, opened;
  BakedFile file = bake(empty);
  Status status = baked_open(file.data(), file.size(), &opened);
  REQUIRE_MESSAGE(status.ok, status.message);
  CHECK(same_scene(empty, opened));
}

// Goal: every array lies at a multiple of 64 bytes, as structures and SIMD loads require.
TEST_CASE("baked_open_arrays_are_aligned_and_inside_the_file") {
  FullScene full;
  make_full_scene(3, 13, 5, &full);
  BakedFile file = bake(full.scene);
  Scene opened;
  REQUIRE(baked_open(file.data(), file.size(), &opened).ok);
  for (const void* data :
       {static_cast<const void*>(opened.normals.data), static_cast<const void*>(opened.triangles.data),
        static_cast<const void*>(opened.key_values.data), static_cast<const void*>(opened.accel.data)}) {
    CHECK(reinterpret_cast<std::uintptr_t>(data) % 64 == 0);
    CHECK(static_cast<const std::uint8_t*>(data) > file.data());
    CHECK(static_cast<const std::uint8_t*>(data) < file.data() + file.size());
  }
}

// Goal: baking is a function of the scene, whatever memory held before. Method: bake over two different fillings.
TEST_CASE("baked_write_is_deterministic") {
  FullScene full;
  make_full_scene(5, 17, 9, &full);
  BakedFile zeros = bake(full.scene), ones = bake(full.scene);
  std::memset(zeros.data(), 0x00, zeros.size());
  std::memset(ones.data(), 0xFF, ones.size());
  baked_write(full.scene, zeros.data());
  baked_write(full.scene, ones.data());
  CHECK(std::memcmp(zeros.data(), ones.data(), zeros.size()) == 0);
}

// Goal: the hash distinguishes scenes and ignores where they lie. Method: change each of a few arrays by one bit.
TEST_CASE("scene_hash_depends_on_content_alone") {
  FullScene a, b;
  make_full_scene(8, 15, 6, &a);
  make_full_scene(8, 15, 6, &b);
  CHECK(scene_hash(a.scene) == scene_hash(b.scene));
  b.triangles[5].set_material(b.triangles[5].material() ^ 1);
  CHECK(scene_hash(a.scene) != scene_hash(b.scene));
  b.triangles[5].set_material(b.triangles[5].material() ^ 1);
  b.accel[36] ^= 1;
  CHECK(scene_hash(a.scene) != scene_hash(b.scene));
  b.accel[36] ^= 1;
  b.scene.info.exposure = 2;
  CHECK(scene_hash(a.scene) != scene_hash(b.scene));
  b.scene.info.exposure = 1;
  CHECK(scene_hash(a.scene) == scene_hash(b.scene));
  std::swap(b.scene.positions, b.scene.rest_positions);
  CHECK(scene_hash(a.scene) != scene_hash(b.scene));
}
