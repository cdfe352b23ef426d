// The scenes of a server, and fetching them.
#include "remote/server/scene_store.h"

#include <doctest/doctest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdio>
#include <cstring>
#include <fstream>

#include "scene/baked.h"
#include "scene/builtin/builtin.h"
#include "session/open_scene.h"
#include "session/picture.h"
#include "session/scene_identity.h"
#include "support/cache_folder.h"
#include "support/scripted_client.h"

using namespace pocketray;

namespace {

// A temporary folder, removed with its contents.
struct Folder {
  std::string path = "scene_store_test";
  std::vector<std::string> files;
  Folder() { REQUIRE(mkdir(path.c_str(), 0777) == 0); }
  ~Folder() {
    for (const std::string& file : files) std::remove((path + "/" + file).c_str());
    rmdir(path.c_str());
  }
  void write(const std::string& name, const std::string& content) {
    std::ofstream(path + "/" + name, std::ios::binary) << content;
    files.push_back(name);
  }
};

const char* const kTriangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

const StoredScene* named(const SceneStore& store, const std::string& name) {
  for (const StoredScene& stored : store.scenes)
    if (name == stored.name) return &stored;
  return nullptr;
}

}  // namespace

// Goal: the store has every scene of a folder, identified as by a device; it skips unreadable scenes with one line, and
// other files silently. Method: a folder with a .pray file, a copy of it, a damaged one, a model, an empty model and a
// text.
TEST_CASE("scene_store_has_the_scenes_of_a_folder") {
  const StoredScene* cube = named(builtin_store(), "cube");
  REQUIRE(cube != nullptr);
  Scene scene = cube->scene;
  std::memcpy(scene.info.name, "cube with its accelerator", 26);
  std::string baked(baked_size(scene), 0);
  baked_write(scene, reinterpret_cast<std::uint8_t*>(&baked[0]));
  Folder folder;
  folder.write("a.pray", baked);
  folder.write("b.pray", baked);
  folder.write("damaged.pray", baked.substr(0, 300));
  folder.write("notes.txt", "nothing");
  folder.write("none.obj", "");
  folder.write("triangle.obj", kTriangle);
  SceneStoreOptions options;
  options.folder = folder.path;
  SceneStore store;
  REQUIRE(open_scene_store(options, &store).ok);
  REQUIRE(named(store, "a.pray") != nullptr);
  CHECK(named(store, "a.pray")->hash == content_hash(baked.data(), baked.size()));
  CHECK(named(store, "a.pray")->accel_bytes == 0);
  CHECK(named(store, "b.pray") == nullptr);  // has the same content
  CHECK(named(store, "cube")->hash == cube->hash);
#ifdef POCKETRAY_HAVE_IMPORT
  REQUIRE(store.warnings.size() == 2);
  CHECK(store.warnings[1].find("none.obj is skipped: ") == 0);
  std::vector<std::uint8_t> block(8u << 20);
  Renderer renderer;
  start_renderer(block.data(), block.size(), Settings(), &renderer);
  SceneSource source;
  SceneStorage storage;
  ContentHash hash;
  REQUIRE(load_scene(folder.path + "/triangle.obj", &renderer, &source, &storage).ok);
  REQUIRE(identify_scene(source, &renderer, &hash).ok);
  REQUIRE(named(store, "triangle.obj") != nullptr);
  CHECK(named(store, "triangle.obj")->hash == hash);
#else
  REQUIRE(store.warnings.size() == 1);
#endif
  CHECK(store.warnings[0].find("damaged.pray is skipped: ") == 0);
}

#ifdef POCKETRAY_HAVE_RADIOSITY
// Goal: a room is there as desktops and as devices open it, found by name as the former; other scenes once. Method: the
// identity of a cube opened by a command, and of one that is loaded; a store without room for both.
TEST_CASE("scene_store_has_rooms_lit_and_plain") {
  light_of_rooms();
  CommonOptions options;
  options.scene = "cube", options.size = "8x6";
  OpenScene opened;
  REQUIRE(open_scene(options, {picture_bytes}, &opened).ok);
  ContentHash lit;
  REQUIRE(identify_scene(opened.source, &opened.renderer, &lit).ok);
  const StoredScene* plain = named(builtin_store(), "cube");
  SceneStore store;
  REQUIRE(store_scene("cube", "cube", true, 1 << 30, &store).ok);
  REQUIRE(store_scene("seesaw", "seesaw", true, 1 << 30, &store).ok);
  REQUIRE(store.scenes.size() == 3);
  CHECK(named(store, "cube")->hash == lit);
  CHECK(named(store, "cube (for devices)")->hash == plain->hash);
  SceneStore small;
  REQUIRE(store_scene("cube", "cube", true, plain->byte_count + plain->accel_bytes + 1000, &small).ok);
  REQUIRE(small.scenes.size() == 1);
  CHECK(named(small, "cube")->hash == plain->hash);
}
#endif

// Goal: scenes beyond the byte limit are skipped. Method: room for only the smallest ones.
TEST_CASE("scene_store_keeps_to_its_limit") {
  SceneStoreOptions options;
  options.bytes_max = 100'000;
  SceneStore store;
  REQUIRE(open_scene_store(options, &store).ok);
  CHECK(named(store, "cube") != nullptr);
  CHECK(named(store, "statue") == nullptr);
  CHECK(store.warnings.size() == 4);
  std::size_t bytes = 0;
  for (const StoredScene& stored : store.scenes) bytes += stored.byte_count + stored.accel_bytes;
  CHECK(bytes <= options.bytes_max);
  const StoredScene* cornell = named(builtin_store(), "cornell");
  options.bytes_max = cornell->byte_count + cornell->accel_bytes - 1;  // its file would fit
  SceneStore less;
  REQUIRE(open_scene_store(options, &less).ok);
  CHECK(named(less, "cornell") == nullptr);
  options.folder = "no/such/folder";
  SceneStore none;
  CHECK_FALSE(open_scene_store(options, &none).ok);
}

// Goal: a client can list the scenes and fetch one byte for byte. Method: every index and one beyond; every hash and an
// unknown one; the cube in pieces of 1000 bytes, the last one short, and one past the end.
TEST_CASE("server_lists_its_scenes_and_gives_their_bytes") {
  ServerRig rig;
  ScriptedClient client(&rig);
  const SceneStore& store = builtin_store();
  Message ask;
  for (std::size_t i = 0; i <= store.scenes.size(); ++i) {
    ask.type = MessageType::scene_list;
    ask.scene_list.index = static_cast<std::uint16_t>(i);
    client.send(ask);
    auto entry = client.wait_for(MessageType::scene_entry);
    CHECK(entry->message.scene_entry.count == store.scenes.size());
    CHECK((entry->message.scene_entry.byte_count == 0) == (i == store.scenes.size()));
    if (i == store.scenes.size()) break;
    CHECK(entry->message.scene_entry.hash == store.scenes[i].hash);
    CHECK(entry->message.scene_entry.byte_count == store.scenes[i].byte_count);
    ask.type = MessageType::scene_query;
    ask.scene_query.hash = store.scenes[i].hash;
    client.send(ask);
    entry = client.wait_for(MessageType::scene_entry);
    CHECK(std::strcmp(entry->message.scene_entry.name, store.scenes[i].name) == 0);
    CHECK(entry->message.scene_entry.index == i);
  }
  ask.type = MessageType::scene_query;
  ask.scene_query.hash = {1, 2};
  client.send(ask);
  CHECK(client.wait_for(MessageType::scene_entry)->message.scene_entry.byte_count == 0);
  ask.type = MessageType::scene_fetch;
  ask.scene_fetch.hash = {1, 2};
  client.send(ask);
  CHECK(client.wait_for(MessageType::error)->message.error.code == WireError::unknown_scene);

  const StoredScene* cube = named(store, "cube");
  std::vector<std::uint8_t> bytes;
  for (bool more = true; more;) {
    ask.scene_fetch = {cube->hash, bytes.size(), 1000};
    client.send(ask);
    auto piece = client.wait_for(MessageType::scene_piece);
    CHECK(piece->message.scene_piece.hash == cube->hash);
    CHECK(piece->message.scene_piece.offset == bytes.size());
    bytes.insert(bytes.end(), piece->message.scene_piece.bytes.begin(), piece->message.scene_piece.bytes.end());
    more = piece->message.scene_piece.bytes.count > 0;
  }
  REQUIRE(bytes.size() == cube->byte_count);
  CHECK(std::memcmp(bytes.data(), cube->bytes, bytes.size()) == 0);
}
