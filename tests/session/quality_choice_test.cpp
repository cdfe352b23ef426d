#include "session/quality_choice.h"

#include <doctest/doctest.h>
#include <stdlib.h>
#include <unistd.h>

#include <cstdio>
#include <fstream>

#include "session/open_scene.h"
#include "session/picture.h"

using namespace pocketray;

namespace {

Settings settings_with(const CommonOptions& options) {
  setenv("XDG_CACHE_HOME", "/dev/null", 1);
  OpenScene opened;
  const Status status = open_scene(options, {picture_bytes}, &opened);
  REQUIRE_MESSAGE(status.ok, status.message);
  return opened.renderer.settings;
}

CommonOptions high() {
  CommonOptions o;
  o.scene = "seesaw", o.size = "16x12", o.quality = "high";
  return o;
}

}  // namespace

// Goal: --quality sets what the command line leaves open. Method: a setting that differs from its default, and one that
// was given at its default.
TEST_CASE("quality_leaves_settings_of_the_command_line") {
  CHECK(settings_with(high()).edge_samples == 8);
  CHECK(settings_with(high()).virtual_lights == 256);
  CommonOptions o = high();
  o.settings["virtual-lights"].count = 16;
  CHECK(settings_with(o).virtual_lights == 16);
  CHECK(settings_with(o).edge_samples == 8);
  o.settings["samples"].count = 2;
  CHECK(settings_with(o).edge_samples == 0);
  o.settings["samples"].count = 1, o.settings["edge-samples"].given = [] { return true; };
  CHECK(settings_with(o).edge_samples == 0);
  o.quality.clear();
  CHECK(settings_with(o).indirect == IndirectChoice::automatic);
}

// Goal: a level asks for nothing that the scene ignores. Method: seesaw has no environment; a model without lights has,
// but the lights added cast the shadows, and without these the environment does.
TEST_CASE("quality_asks_for_nothing_without_effect") {
  CHECK(settings_with(high()).environment_shadows == Quality().environment_shadows);
#ifdef POCKETRAY_HAVE_IMPORT
  char folder[] = "/tmp/pocketray-quality-XXXXXX";
  REQUIRE(mkdtemp(folder) != nullptr);
  CommonOptions o = high();
  o.scene = std::string(folder) + "/model.obj", o.environment = "studio";
  std::ofstream(o.scene) << "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 1\nf 1 2 3\nf 2 4 3\n";
  CHECK(settings_with(o).environment_shadows == Quality().environment_shadows);
  o.light = "none";
  CHECK(settings_with(o).environment_shadows > Quality().environment_shadows);
  CHECK(std::remove(o.scene.c_str()) == 0);
  CHECK(rmdir(folder) == 0);
#endif
}

// Goal: stated colours are shown as stated unless asked otherwise. Method: the tone of each name, and without one.
TEST_CASE("tone_clips_unless_named") {
  CommonOptions o = high();
  CHECK(settings_with(o).tone == Tone::clip);
  for (int i = 0; i < kToneCount; ++i) {
    o.tone = kToneNames[i];
    CHECK(settings_with(o).tone == static_cast<Tone>(i));
  }
  CHECK(Settings().tone == Tone::clip);
}

TEST_CASE("quality_must_be_a_level") {
  CommonOptions o = high();
  o.quality = "superb";
  OpenScene opened;
  const Status status = open_scene(o, {picture_bytes}, &opened);
  CHECK_FALSE(status.ok);
  CHECK(std::string(status.message).find("draft, low, medium, high or best") != std::string::npos);
}
