// The identity of a scene for device and server.
#include "session/scene_identity.h"

#include <doctest/doctest.h>

#include <cstdio>
#include <cstring>
#include <fstream>
#include <string>
#include <vector>

#include "scene/baked.h"
#include "scene/builtin/builtin.h"

using namespace pocketray;

namespace {

struct Loaded {
  std::vector<std::uint8_t> block;
  Renderer renderer;
  SceneSource source;
  Status status;
  explicit Loaded(const std::string& name, std::uint8_t before = 0, std::size_t memory_bytes = 16u << 20)
      : block(memory_bytes, before) {
    start_renderer(block.data(), block.size(), Settings(), &renderer);
    SceneStorage storage;
    status = load_scene(name, &renderer, &source, &storage);
  }
  ContentHash identity() {
    ContentHash hash;
    REQUIRE(identify_scene(source, &renderer, &hash).ok);
    return hash;
  }
};

std::vector<std::uint8_t> bake(const Scene& scene) {
  std::vector<std::uint8_t> bytes(baked_size(scene));
  baked_write(scene, bytes.data());
  return bytes;
}

void write_file(const std::string& path, const std::vector<std::uint8_t>& bytes) {
  std::ofstream file(path, std::ios::binary);
  file.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
}

}  // namespace

// Goal: a scene has the same identity however it was opened, and no two share one. Method: every built-in scene, in
// memory prefilled with ones and with zeros; the .pray file it bakes to without an accelerator; all compared.
TEST_CASE("scene_identity_is_of_the_content_alone") {
  int count;
  const BuiltinScene* list = builtin_list(&count);
  std::vector<ContentHash> all;
  for (int i = 0; i < count; ++i) {
    CAPTURE(list[i].name);
    Loaded ones(list[i].name, 0xff), zeros(list[i].name, 0);
    REQUIRE(ones.status.ok);
    ContentHash hash = ones.identity();
    CHECK(hash == zeros.identity());
    std::string path = std::string("identity_") + list[i].name + ".pray";
    write_file(path, bake(ones.renderer.scene));
    {
      Loaded file(path);
      REQUIRE(file.status.ok);
      CHECK(file.identity() == hash);
    }
    std::remove(path.c_str());
    for (const ContentHash& other : all) CHECK(other != hash);
    all.push_back(hash);
  }
}

// Goal: identifying a scene releases its memory, and says what is missing if it cannot. Method: the arena's mark before
// and after; a block that holds the scene only once.
TEST_CASE("scene_identity_gives_its_memory_back_or_says_what_it_needs") {
  Loaded loaded("statue");
  REQUIRE(loaded.status.ok);
  std::size_t used = loaded.renderer.memory.scene.used;
  loaded.identity();
  CHECK(loaded.renderer.memory.scene.used == used);
  Loaded tight("statue", 0, used + used / 2);
  REQUIRE(tight.status.ok);
  ContentHash hash;
  Status status = identify_scene(tight.source, &tight.renderer, &hash);
  CHECK_FALSE(status.ok);
  CHECK(std::strstr(status.message, "--memory") != nullptr);
}

#ifdef POCKETRAY_HAVE_IMPORT
// Goal: an imported model is identified by its baked form. Method: a triangle as OBJ, its bytes by import_model().
TEST_CASE("scene_identity_of_a_model_is_that_of_its_baked_file") {
  const std::string path = "identity_triangle.obj";
  std::ofstream(path) << "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
  ImportedScene imported;
  REQUIRE(import_model(path, ImportOptions(), &imported).ok);
  std::vector<std::uint8_t> bytes = bake(imported.scene);
  Loaded model(path);
  REQUIRE(model.status.ok);
  CHECK(model.identity() == content_hash(bytes.data(), bytes.size()));
  std::remove(path.c_str());
}
#endif
