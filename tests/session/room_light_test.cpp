#include "session/room_light.h"

#include <doctest/doctest.h>
#include <stdlib.h>

#include <cstring>
#include <fstream>
#include <iterator>

#include "scene/baked.h"
#include "session/light_file.h"
#include "session/open_scene.h"
#include "session/picture.h"
#include "session/scene_identity.h"
#include "support/cache_folder.h"
#include "support/generated_scene.h"

using namespace pocketray;

namespace {

std::string only_file(const CacheFolder& cache) {
  const std::vector<std::string> found = cache.names();
  REQUIRE(found.size() == 1);
  return cache.kept() + "/" + found[0];
}

CommonOptions of(const char* scene) {
  CommonOptions o;
  o.scene = scene, o.size = "16x12";
  return o;
}

// Opens a scene and returns its values of stored light, all arrays in a row.
std::string light_of(const CommonOptions& options) {
  OpenScene opened;
  const Status status = open_scene(options, {picture_bytes}, &opened);
  REQUIRE_MESSAGE(status.ok, status.message);
  CHECK(validate_scene(opened.renderer.scene).ok);
  std::string bytes;
  visit_radiosity(&opened.renderer.scene, [&](const auto& array) {
    if (!array.empty()) bytes.append(reinterpret_cast<const char*>(array.data), array.bytes());
  });
  return bytes;
}

std::string content(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return std::string(std::istreambuf_iterator<char>(file), {});
}

}  // namespace

#ifdef POCKETRAY_HAVE_RADIOSITY
// Goal: a lit room is opened with radiosity, the second time from the cache, and as `--indirect radiosity` solves it
// with as many patches. Method: all bytes that it stores.
TEST_CASE("rooms_are_lit_once") {
  const CacheFolder cache;
  const std::string first = light_of(of("cube"));
  CHECK(first.size() > 100000);
  const std::string kept = content(only_file(cache));
  CHECK(light_of(of("cube")) == first);
  CHECK(content(only_file(cache)) == kept);
  CommonOptions asked = of("cube");
  asked.settings["indirect"].choice = "radiosity";
  CHECK(light_of(asked) == first);
}

// Goal: nothing else is. Method: a scene outdoors, one that asks for other light, a room whose light is nobody's.
TEST_CASE("only_rooms_are_lit_unasked") {
  const CacheFolder cache;
  CHECK(light_of(of("seesaw")).empty());
  CommonOptions other = of("cube");
  other.settings["indirect"].choice = "ambient";
  CHECK(light_of(other).empty());
  CHECK(cache.names().empty());
}

// Goal: a room whose surfaces reflect nothing is opened as it is, not refused. Method: a lit box of grey walls, of
// unlit and of black ones.
TEST_CASE("rooms_that_reflect_nothing_are_not_lit") {
  auto calls = [](const Material& m) {
    GeneratedScene s;
    add_box(&s, {-1, -1, -1}, {1, 1, 1}, add_material(&s, m), true);
    aim(&s, {0, 0, 0}, {0, 0, -1}, 60);
    s.lights.resize(1);
    s.bind();
    return calls_for_radiosity(s.scene);
  };
  Material grey, unlit, black;
  unlit.unlit = 1, black.diffuse = black.specular = {0, 0, 0};
  CHECK(calls(grey));
  CHECK_FALSE(calls(unlit));
  CHECK_FALSE(calls(black));
}

// Goal: a broken file is not used, and mended. Method: every header byte and some others changed, the end cut off.
TEST_CASE("hostile_light_files_are_solved_anew") {
  const CacheFolder cache;
  const std::string light = light_of(of("cube")), path = only_file(cache), kept = content(path);
  Scene plain, scene;
  OpenScene opened;
  CommonOptions ambient = of("cube");
  ambient.settings["indirect"].choice = "ambient";
  REQUIRE(open_scene(ambient, {picture_bytes}, &opened).ok);
  plain = opened.renderer.scene;
  ContentHash identity;
  REQUIRE(identify_scene(opened.source, &opened.renderer, &identity).ok);
  REQUIRE(light_path("cube", identity) == path);
  auto read = [&](const std::string& bytes) {
    REQUIRE(write_file(path, bytes).ok);
    SolvedRadiosity solved;
    scene = plain;
    return read_light(path, identity, &scene, &solved);
  };
  CHECK(read(kept) == KeptLight::solved);
  for (std::size_t at = 0; at < kept.size(); at += at < 200 ? 1 : 997) {
    std::string bad = kept;
    bad[at] = static_cast<char>(bad[at] ^ 0x40);
    INFO(at);
    CHECK(read(bad) == KeptLight::none);
    CHECK(scene.radiosity_triangles.empty());
  }
  for (std::size_t size : {std::size_t(1), std::size_t(50), kept.size() / 2, kept.size() - 1})
    CHECK(read(kept.substr(0, size)) == KeptLight::none);
  CHECK(read(kept + "more") == KeptLight::none);
  CHECK(light_of(of("cube")) == light);
  CHECK(content(path) == kept);
  SolvedRadiosity solved;
  identity.low ^= 1;
  CHECK(read_light(path, identity, &scene, &solved) == KeptLight::none);
}

// Goal: a room whose light is too much is not divided again at every start.
TEST_CASE("unfit_rooms_are_remembered") {
  const CacheFolder cache;
  Scene scene;
  const ContentHash identity = {1, 2};
  const std::string path = light_path("cube", identity);
  SolvedRadiosity solved;
  CHECK(read_light(path, identity, &scene, &solved) == KeptLight::none);
  REQUIRE(write_light(path, identity, scene).ok);
  CHECK(read_light(path, identity, &scene, &solved) == KeptLight::unfit);
}

// Goal: where nothing can be kept, rooms are lit all the same.
TEST_CASE("rooms_are_lit_without_a_cache") {
  const CacheFolder cache;
  const std::string light = light_of(of("cube"));
  setenv("XDG_CACHE_HOME", "/dev/null", 1);
  CHECK(light_of(of("cube")) == light);
}

// Goal: the finest solution within a limit. Method: limits just above and below the cost of each.
TEST_CASE("fit_is_the_finest_within_its_limit") {
  OpenScene opened;
  CommonOptions ambient = of("cube");
  ambient.settings["indirect"].choice = "ambient";
  REQUIRE(open_scene(ambient, {picture_bytes}, &opened).ok);
  const Scene& scene = opened.renderer.scene;
  auto fit = [&](double pairs, std::size_t bytes) {
    RadiosityFit found;
    REQUIRE(fit_radiosity(1, scene, {pairs, 8000, bytes}, &found).ok);
    return found;
  };
  const RadiosityFit finest = fit(1e12, 1 << 30);
  CHECK(finest.patch_count == 1200);
  CHECK(fit(finest.pair_count, finest.bytes).patch_count == 1200);
  CHECK(fit(finest.pair_count - 1, finest.bytes).patch_count == 300);
  CHECK(fit(finest.pair_count, finest.bytes - 1).patch_count == 300);
  const RadiosityFit middle = fit(finest.pair_count - 1, finest.bytes);
  CHECK(middle.bytes < finest.bytes);
  CHECK(middle.pair_count < finest.pair_count / 4);
  CHECK(fit(middle.pair_count - 1, finest.bytes).patch_count == 75);
  CHECK(fit(1, finest.bytes).patch_count == 0);
}

// Goal: light never takes the memory that the picture needs.
TEST_CASE("small_memory_stays_unlit") {
  const CacheFolder cache;
  CommonOptions small = of("cube");
  small.memory = "900K";
  CHECK(light_of(small).empty());
  small.memory = "2M";
  CHECK_FALSE(light_of(small).empty());
}
#endif
