// Scenes opened in memory that has no room for all levels of their textures.
#include <doctest/doctest.h>

#include <cstdio>
#include <cstring>
#include <fstream>
#include <string>
#include <vector>

#include "scene/baked_file.h"
#include "session/open_scene.h"
#include "session/scene_identity.h"
#include "support/generated_scene.h"

using namespace pocketray;

namespace {

// A .pray file with one texture of noise, removed at the end.
struct NoiseFile {
  std::string path;
  std::size_t byte_count;
  ContentHash hash;
  NoiseFile(const char* name, int side, int columns) : path(name) {
    auto s = generate_scene(bit(Feature::texture) | bit(Feature::point_light) | bit(Feature::ambient), 4);
    Rng rng = make_rng(8);
    std::vector<std::array<int, 4>> noise(static_cast<std::size_t>(side) * static_cast<std::size_t>(side));
    for (auto& texel : noise) texel = {int(next_u32(&rng) & 255), int(next_u32(&rng) & 255), 90, 255};
    const std::uint32_t texture = add_texture(s.get(), side, side, noise);
    add_levels(s.get(), texture);
    for (Material& m : s->materials) m.diffuse_texture.texture = texture;
    if (columns > 0) add_sphere(s.get(), {0, 1, 0}, 0.5f, columns, columns, 0);
    s->bind();
    const BakedFile file = bake(s->scene);
    byte_count = file.size();
    hash = content_hash(file.data(), file.size());
    std::ofstream(path, std::ios::binary)
        .write(reinterpret_cast<const char*>(file.data()), static_cast<std::streamsize>(file.size()));
  }
  ~NoiseFile() { std::remove(path.c_str()); }
};

struct Opened {
  OpenScene scene;
  Status status;
  ContentHash identity;
  Opened(const NoiseFile& file, std::size_t kibibytes, std::uint32_t side_max = kTextureSideMax,
         std::uint32_t fast_side_max = 0) {
    CommonOptions o;
    o.scene = file.path, o.size = "80x60", o.threads = 1, o.texture_side_max = side_max;
    o.memory = std::to_string(kibibytes) + "K";
    OpenHooks hooks;
    hooks.output_bytes = [](const Settings&) { return OutputNeed(0); };
    hooks.loaded = [this](const SceneSource& source, Renderer* renderer) {
      return identify_scene(source, renderer, &identity);
    };
    if (fast_side_max > 0)  // the side from which the fast accelerator does not fit
      hooks.plan = [=](Renderer* renderer, const SceneStorage& storage, const OutputNeed& output) {
        const Status planned = plan_renderer(renderer, storage, output);
        renderer->accel.is_fallback = renderer->settings.texture_side_max > fast_side_max;
        return planned;
      };
    status = open_scene(o, hooks, &scene);
    if (status.ok) status = start_scene(&scene, o);
  }
  std::uint32_t side() const { return scene.renderer.scene.textures[1].width; }
  Picture picture() {
    Renderer* r = &scene.renderer;
    REQUIRE(render_frame(r, 0).ok);
    return Picture(r->image.begin(), r->image.end());
  }
};

}  // namespace

// Goal: a scene opens wherever it fits without some levels, as if it had been asked for without them, and servers know
// it by its file. Method: every amount of memory from the least, in small steps.
TEST_CASE("open_scene_leaves_out_levels_that_do_not_fit") {
  const NoiseFile file("open_textures.pray", 256, 0);
  std::vector<Picture> by_side;
  std::uint32_t before = 0, side_count = 0;
  std::string refusal;
  for (std::size_t kibibytes = 64; kibibytes < 1024; kibibytes += 2) {
    CAPTURE(kibibytes);
    Opened opened(file, kibibytes);
    if (!opened.status.ok) {
      REQUIRE(before == 0);
      refusal = opened.status.message;
      continue;
    }
    REQUIRE(opened.side() >= before);
    CHECK(opened.identity == file.hash);
    CHECK(opened.scene.renderer.memory.plan.total_bytes <= kibibytes << 10);
    if (opened.side() == before) continue;
    before = opened.side(), ++side_count;
    Opened asked(file, 4096, before);
    REQUIRE(asked.status.ok);
    CHECK(asked.side() == before);
    CHECK(asked.identity == file.hash);
    CHECK(same_picture(opened.picture(), asked.picture()));
    if (!by_side.empty()) CHECK(!same_picture(by_side.back(), asked.picture()));
    by_side.push_back(asked.picture());
  }
  CHECK(before == 256);
  CHECK(side_count >= 4);
  CHECK(refusal.find("needs ") != std::string::npos);
  CHECK(refusal.find("MiB") != std::string::npos);
}

// Goal: levels beyond 512 texels make way for the fast accelerator. Method: amounts of memory around what the whole
// scene takes with it.
TEST_CASE("open_scene_prefers_the_fast_accelerator_to_large_levels") {
  const NoiseFile file("open_accelerator.pray", 1024, 120);
  bool is_whole = false, is_shrunk = false;
  for (std::size_t kibibytes = file.byte_count >> 10; kibibytes < (file.byte_count >> 10) + 8192; kibibytes += 256) {
    CAPTURE(kibibytes);
    Opened opened(file, kibibytes);
    REQUIRE(opened.status.ok);
    CHECK(!opened.scene.renderer.accel.is_fallback);
    CHECK(opened.side() >= 512);
    (opened.side() == 1024 ? is_whole : is_shrunk) = true;
  }
  CHECK(is_whole);
  CHECK(is_shrunk);
}

// Goal: levels make way only if that helps. Method: an accelerator that fits from 1,024 texels, from 512, or never.
TEST_CASE("open_scene_keeps_levels_that_would_make_way_in_vain") {
  const NoiseFile file("open_vain.pray", 2048, 0);
  const std::uint32_t fast[] = {1024, 512, 256}, expected[] = {1024, 512, 2048};
  for (int i = 0; i < 3; ++i) {
    Opened opened(file, 65536, kTextureSideMax, fast[i]);
    REQUIRE(opened.status.ok);
    CHECK(opened.side() == expected[i]);
    CHECK(opened.scene.renderer.accel.is_fallback == (expected[i] == 2048));
  }
}

// Goal: a limit by hand costs no memory for what it leaves out, and one that leaves nothing out changes nothing.
TEST_CASE("open_scene_takes_textures_as_small_as_asked") {
  const NoiseFile file("open_limited.pray", 256, 0);
  Opened whole(file, 4096), limited(file, 4096, 64), same(file, 4096, 256);
  REQUIRE(whole.status.ok);
  REQUIRE(limited.status.ok);
  REQUIRE(same.status.ok);
  CHECK(limited.side() == 64);
  CHECK(limited.scene.renderer.memory.plan.total_bytes + 300'000 < whole.scene.renderer.memory.plan.total_bytes);
  CHECK(same_picture(whole.picture(), same.picture()));
  CHECK(!same_picture(whole.picture(), limited.picture()));
}
