// Servers of devices that have left out levels of textures.
#include <doctest/doctest.h>

#include <array>

#include "base/rng.h"
#include "scene/baked_file.h"
#include "session/baked_file.h"
#include "support/generated_scene.h"
#include "support/scripted_client.h"

using namespace pocketray;

// Goal: a device that left out levels of textures gets the pixels that it would render itself. Method: for every amount
// of memory down to textures of a single texel, the first frame of a new server and one after frames of other textures.
TEST_CASE("server_frames_lack_the_levels_that_the_device_has_left_out") {
  auto generated = generate_scene(bit(Feature::texture) | bit(Feature::point_light) | bit(Feature::ambient), 4);
  Rng rng = make_rng(8);
  std::vector<std::array<int, 4>> noise(64 * 64);
  for (auto& texel : noise)
    for (int c = 0; c < 4; ++c)
      texel[static_cast<std::size_t>(c)] = c == 3 ? 255 : static_cast<int>(next_u32(&rng) & 255);
  const std::uint32_t texture = add_texture(generated.get(), 64, 64, noise);
  add_levels(generated.get(), texture);
  for (Material& m : generated->materials) m.diffuse_texture.texture = texture;
  generated->bind();
  const BakedFile whole = bake(generated->scene);
  SceneStore store;
  REQUIRE(store_baked_scene("noise", whole.data(), whole.size(), 1u << 28, &store).ok);
  ServerRig old_rig(ServerOptions(), platform::NullLinkSettings(), platform::kNullLink, store);
  ScriptedClient old_client(&old_rig);
  std::vector<std::uint8_t> before;
  std::uint32_t frame = 0, seen = 0;
  for (std::uint32_t side = 64; side > 0; side /= 2) {
    CAPTURE(side);
    std::vector<std::uint8_t> block(whole.size() + kArenaAlignment);
    Arena arena = make_arena("scene", block.data(), block.size());
    FittedFile file;
    REQUIRE(read_fitted(bytes_in_memory(whole.data(), whole.size()), side, &arena, &file).ok);
    SceneStore device;
    device.scenes.resize(1);
    device.scenes[0].hash = store.scenes[0].hash;
    REQUIRE(baked_open(file.bytes, file.byte_count, &device.scenes[0].scene).ok);
    FrameRequest request = frame_request("cube", ++frame, 40, 30);
    request.scene = store.scenes[0].hash, request.settings.texture_side_max = side;
    const std::vector<std::uint8_t> expected = rendered_here(request, device);
    seen += expected != before, before = expected;
    ServerRig rig(ServerOptions(), platform::NullLinkSettings(), platform::kNullLink, store);
    ScriptedClient client(&rig);
    for (ScriptedClient* each : {&client, &old_client}) {
      each->request(request);
      each->wait_for_rows(30);
      CHECK(each->picture() == expected);
    }
  }
  CHECK(seen >= 5);
}
