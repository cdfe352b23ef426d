// Scene files that change while served or rendered: the checked data is the used data.
#include <doctest/doctest.h>
#include <unistd.h>

#include <cstdio>
#include <cstring>
#include <fstream>
#include <memory>

#include "engine/frame.h"
#include "remote/server/scene_store.h"
#include "scene/baked.h"
#include "scene/builtin_helpers.h"
#include "session/source.h"
#include "support/scripted_client.h"

using namespace pocketray;

namespace {

// A .pray file in the current folder, removed at the end.
struct SceneFile {
  std::string path = "changed_file_test.pray";
  std::vector<std::uint8_t> bytes;
  SceneFile() {
    std::unique_ptr<BuiltScene> built = build_builtin("cube");
    bytes.resize(baked_size(built->scene));
    baked_write(built->scene, bytes.data());
    std::ofstream file(path, std::ios::binary);
    file.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  }
  ~SceneFile() { std::remove(path.c_str()); }
  // Sets every vertex index of every triangle far out of range, like an attacker.
  void alter() {
    std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
    std::vector<char> high(bytes.size() / 2, 0x7f);
    file.seekp(static_cast<std::streamoff>(bytes.size() - high.size()));
    file.write(high.data(), static_cast<std::streamsize>(high.size()));
    REQUIRE(file.good());
  }
  void cut() { REQUIRE(truncate(path.c_str(), 100) == 0); }
};

}  // namespace

// Goal: a server sends and renders the scene it has checked, and nothing written to the file since. Method: alter, then
// truncate, a file that the store has read; check its bytes, hash and validity.
TEST_CASE("changed_file_leaves_a_served_scene_as_it_was") {
  SceneFile file;
  SceneStore store;
  Status status = store_scene("cube.pray", file.path, false, 1u << 26, &store);
  REQUIRE_MESSAGE(status.ok, status.message);
  const StoredScene& stored = store.scenes[0];
  for (int round = 0; round < 2; ++round) {
    round == 0 ? file.alter() : file.cut();
    REQUIRE(stored.byte_count == file.bytes.size());
    CHECK(std::memcmp(stored.bytes, file.bytes.data(), stored.byte_count) == 0);
    CHECK(stored.hash == content_hash(stored.bytes, stored.byte_count));
    CHECK(validate_scene(stored.scene).ok);
  }
}

// Goal: the same for frames of a scene file, in render and view alike: both go through load_scene(). Method: a frame,
// alter the file, a frame, truncate the file, a frame: all three are equal.
TEST_CASE("changed_file_leaves_a_rendered_scene_as_it_was") {
  SceneFile file;
  std::vector<std::uint8_t> block(16u << 20);
  Renderer renderer;
  Settings settings;
  settings.width = 32, settings.height = 24;
  start_renderer(block.data(), block.size(), settings, &renderer);
  SceneSource source;
  SceneStorage storage;
  Status status = load_scene(file.path, &renderer, &source, &storage);
  REQUIRE_MESSAGE(status.ok, status.message);
  CHECK(storage.arena_bytes >= file.bytes.size());  // the plan counts the copy
  REQUIRE(plan_renderer(&renderer, storage, 0).ok);
  CHECK(renderer.memory.plan.total_bytes <= block.size());
  REQUIRE(build_renderer(&renderer).ok);
  REQUIRE(render_frame(&renderer, 0).ok);
  std::vector<Vec3> first(renderer.image.begin(), renderer.image.end());
  for (int round = 0; round < 2; ++round) {
    round == 0 ? file.alter() : file.cut();
    REQUIRE(render_frame(&renderer, 0).ok);
    CHECK(std::memcmp(first.data(), renderer.image.data, renderer.image.bytes()) == 0);
  }
}

// Goal: a file too large for memory is hashed in parts, with the same result as whole. Method: lengths around the size
// of a part.
TEST_CASE("changed_file_hash_in_parts_is_the_hash") {
  const std::string path = "changed_file_test.bin";
  for (std::size_t count : {1, 15, 16, 17, 65535, 65536, 65537, 200'003}) {
    std::vector<std::uint8_t> bytes(count);
    for (std::size_t i = 0; i < count; ++i) bytes[i] = static_cast<std::uint8_t>(i * 7 + i / 251);
    std::ofstream(path, std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(count));
    ContentHash hash;
    REQUIRE(hash_file(path, &hash).ok);
    CHECK(hash == content_hash(bytes.data(), count));
  }
  std::remove(path.c_str());
  ContentHash hash;
  CHECK_FALSE(hash_file(path, &hash).ok);
}
