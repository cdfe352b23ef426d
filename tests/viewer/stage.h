// A viewer on the null screen.
#pragma once
#include <doctest/doctest.h>

#include <cstdlib>
#include <string>
#include <vector>

#include "platform/null/null.h"
#include "session/open_scene.h"
#include "support/cache_folder.h"
#include "viewer/viewer.h"

namespace pocketray {

// A viewer on an in-memory screen, with scripted buttons.
struct Stage {
  std::vector<platform::Event> script;
  std::vector<std::uint32_t> screen = std::vector<std::uint32_t>(kWidth * kHeight);
  Viewer viewer;
  QualityDial dial;
  std::string memory = "64M", quality;
  int rotation = 0, bits_per_pixel = 32;
  bool dither = false;
  static constexpr int kWidth = 320, kHeight = 60;

  void press(double seconds, platform::Button button, bool down = true) {
    platform::Event event;
    event.type = down ? platform::EventType::button_down : platform::EventType::button_up;
    event.button = button, event.time_ns = static_cast<std::uint64_t>(seconds * 1e9);
    script.push_back(event);
  }
  void leave(double seconds) {
    platform::Event event;
    event.time_ns = static_cast<std::uint64_t>(seconds * 1e9);
    script.push_back(event);
  }
  void open(const std::string& scene, const std::string& screenshots = ".") {
    platform::NullSettings settings;
    settings.screen = screen.data(), settings.screen_bytes = screen.size() * 4;
    settings.script = script.data(), settings.script_count = static_cast<int>(script.size());
    settings.format = platform::screen_format(screen_width(), screen_height(), bits_per_pixel, false);
    platform::null_configure(settings);
    ViewOptions options;
    options.backend = "null", options.rotation = rotation, options.screenshot_folder = screenshots;
    options.dither = dither;
    REQUIRE(open_viewer(options, scene.c_str(), kWidth, kHeight, &viewer).ok);
  }
  int screen_width() const { return rotation % 180 ? kHeight : kWidth; }
  int screen_height() const { return rotation % 180 ? kWidth : kHeight; }
  void load(const char* scene, const char* coherence, OpenScene* opened) {
    light_of_rooms();
    CommonOptions common;
    common.scene = scene, common.size = "320x60", common.threads = 1, common.coherence = coherence;
    common.memory = memory, common.quality = quality;
    const Status status = open_scene_with_dial(common, viewer_bytes, opened, &dial);
    REQUIRE_MESSAGE(status.ok, status.message);
    viewer.dial = &dial;
  }
  // Shows a built-in scene; true if a reload is due.
  bool show(const char* scene, OpenScene* opened, const char* coherence = "off") {
    load(scene, coherence, opened);
    bool again;
    REQUIRE(run_viewer(&viewer, &opened->renderer, &again).ok);
    return again;
  }
  ~Stage() {
    close_viewer(&viewer);
    platform::null_configure(platform::NullSettings());
  }
};

}  // namespace pocketray
