#include "platform/null/null.h"

#include <doctest/doctest.h>

#include <cstring>
#include <vector>

using namespace platform;

namespace {

ScreenOptions options_with(std::vector<std::uint32_t>* memory, int width, int height) {
  memory->assign(page_bytes_max(width, height) / 4, 0);
  ScreenOptions options;
  options.width = width;
  options.height = height;
  options.memory = memory->data();
  options.memory_bytes = memory->size() * 4;
  return options;
}

}  // namespace

// Goal: a backend is found by name; null is last, and there is always one. Method: the list.
TEST_CASE("platform_finds_every_backend_and_null_last") {
  REQUIRE(kBackendCount >= 1);
  CHECK(kBackends[kBackendCount - 1] == &kNullBackend);
  for (int i = 0; i < kBackendCount; ++i) CHECK(platform_find(kBackends[i]->name) == kBackends[i]);
  CHECK(platform_find("telegraph") == nullptr);
  for (int i = 0; i < kBackendCount; ++i) CHECK(kBackends[i]->needs[0] != 0);
}

// Goal: events come in order, each at its time. Method: a script and the virtual clock.
TEST_CASE("null_plays_its_script_by_the_virtual_clock") {
  Event script[3];
  script[0] = {EventType::button_down, Button::left, nullptr, 0};
  script[1] = {EventType::button_up, Button::left, nullptr, 20'000'000};
  script[2] = {EventType::quit, Button::up, nullptr, 50'000'000};
  NullSettings settings;
  settings.script = script;
  settings.script_count = 3;
  settings.clock_step_ns = 0;
  settings.frame_ns = 10'000'000;
  null_configure(settings);
  std::vector<std::uint32_t> memory;
  ScreenFormat format;
  Error error;
  REQUIRE(kNullBackend.open(options_with(&memory, 32, 24), &format, &error));
  CHECK(null_record().open);
  Event event;
  CHECK(kNullBackend.poll(&event));
  CHECK(event.type == EventType::button_down);
  CHECK_FALSE(kNullBackend.poll(&event));
  kNullBackend.end_frame(0, 24);
  CHECK_FALSE(kNullBackend.poll(&event));
  kNullBackend.end_frame(0, 24);
  CHECK(kNullBackend.now_ns() == 20'000'000);
  CHECK(kNullBackend.poll(&event));
  CHECK(event.type == EventType::button_up);
  CHECK_FALSE(kNullBackend.poll(&event));
  kNullBackend.sleep_ns(30'000'000);
  CHECK(kNullBackend.poll(&event));
  CHECK(event.type == EventType::quit);
  CHECK_FALSE(kNullBackend.poll(&event));
  kNullBackend.close();
  CHECK_FALSE(null_record().open);
  null_configure(NullSettings());
}

// Goal: the screen shows the drawing, in the rows named, with any format and padding. Method: RGB565, two frames.
TEST_CASE("null_shows_the_changed_rows_of_a_configured_screen") {
  constexpr int kLine = 16 * 2 + 6;
  std::vector<std::uint8_t> screen(kLine * 8, 0);
  NullSettings settings;
  settings.format = {16, 8, 16, {11, 5}, {5, 6}, {0, 5}, {}};
  settings.line_padding_bytes = 6;
  settings.screen = screen.data();
  settings.screen_bytes = screen.size();
  null_configure(settings);
  std::vector<std::uint32_t> memory;
  ScreenFormat format;
  Error error;
  REQUIRE(kNullBackend.open(options_with(&memory, 16, 12), &format, &error));
  CHECK(format.height == 8);
  CHECK(format.red.offset == 11);
  Page page = kNullBackend.begin_frame();
  CHECK(page.line_bytes == kLine);
  CHECK(page.age == 0);
  std::memset(page.pixels, 0x11, screen.size());
  kNullBackend.end_frame(0, 8);
  CHECK(screen[0] == 0x11);
  CHECK(screen[screen.size() - 1] == 0x11);
  page = kNullBackend.begin_frame();
  CHECK(page.age == 1);
  std::memset(page.pixels, 0x22, screen.size());
  kNullBackend.end_frame(3, 5);
  CHECK(screen[3 * kLine - 1] == 0x11);
  CHECK(screen[3 * kLine] == 0x22);
  CHECK(screen[5 * kLine - 1] == 0x22);
  CHECK(screen[5 * kLine] == 0x11);
  CHECK(null_record().frames_shown == 2);
  kNullBackend.close();
  null_configure(NullSettings());
}

// Goal: nothing is drawn beyond the given memory. Method: too little memory, and a rotated screen.
TEST_CASE("null_refuses_too_little_memory_and_turns_the_screen") {
  null_configure(NullSettings());
  std::vector<std::uint32_t> memory;
  ScreenOptions options = options_with(&memory, 20, 10);
  ScreenFormat format;
  Error error;
  options.memory_bytes -= 4;
  CHECK_FALSE(kNullBackend.open(options, &format, &error));
  CHECK(std::strstr(error.text, "800 bytes") != nullptr);
  options.memory_bytes += 4;
  options.rotation = 90;
  CHECK(kNullBackend.open(options, &format, &error));
  CHECK(format.width == 10);
  CHECK(format.height == 20);
  kNullBackend.close();
}
