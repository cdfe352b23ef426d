#if defined(POCKETRAY_HAVE_SDL2)
#include "platform/sdl2/sdl2.h"
#include "platform/button_name.h"

#include <SDL.h>
#include <doctest/doctest.h>

#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

using namespace platform;

namespace {

struct Window {
  std::vector<std::uint32_t> memory = std::vector<std::uint32_t>(320 * 240);
  ScreenOptions options;
  ScreenFormat format;
  Error error;
  Window() {
    setenv("SDL_VIDEODRIVER", "dummy", 1);
    setenv("SDL_AUDIODRIVER", "dummy", 1);
    options.title = "test";
    options.memory = memory.data();
    options.memory_bytes = memory.size() * 4;
    options.scale = 2;
  }
  ~Window() { kSdl2Backend.close(); }
  bool open() { return kSdl2Backend.open(options, &format, &error); }
};

SDL_Window* window() { return SDL_GetWindowFromID(1) ? SDL_GetWindowFromID(1) : SDL_GetWindowFromID(2); }

void push_key(SDL_Scancode key, bool down, bool repeated = false) {
  SDL_Event event = {};
  event.type = down ? SDL_KEYDOWN : SDL_KEYUP;
  event.key.repeat = repeated;
  event.key.keysym.scancode = key;
  SDL_PushEvent(&event);
}

std::string taken() {
  std::string text;
  Event event;
  while (kSdl2Backend.poll(&event)) {
    if (!text.empty()) text += ' ';
    if (event.type == EventType::quit)
      text += "quit";
    else if (event.type == EventType::file_drop)
      text += std::string("drop:") + event.path;
    else
      text += (event.type == EventType::button_down ? "+" : "-") + std::string(button_name(event.button));
  }
  return text;
}

}  // namespace

// Goal: the window shows the picture at an integer scale, with black around it. Method: SDL's dummy driver; read the
// pixels back.
TEST_CASE("sdl2_window_shows_the_picture_by_whole_numbers") {
  Window screen;
  REQUIRE_MESSAGE(screen.open(), screen.error.text);
  CHECK(screen.format.width == 320);
  CHECK(screen.format.bits_per_pixel == 32);
  Page page = kSdl2Backend.begin_frame();
  CHECK(page.age == 0);
  for (int i = 0; i < 320 * 240; ++i)
    screen.memory[static_cast<std::size_t>(i)] = static_cast<std::uint32_t>(i * 2654435761u) & 0xffffff;
  CHECK(page.pixels == screen.memory.data());
  kSdl2Backend.end_frame(0, 240);
  CHECK(kSdl2Backend.begin_frame().age == 1);

  int width, height;
  SDL_GetWindowSize(window(), &width, &height);
  CHECK(width == 640);
  CHECK(height == 480);
  SDL_Renderer* renderer = SDL_GetRenderer(window());
  REQUIRE(renderer != nullptr);
  std::vector<std::uint32_t> shown(640 * 480);
  SDL_Rect whole = {0, 0, 640, 480};
  SDL_RenderSetLogicalSize(renderer, 0, 0);
  REQUIRE(SDL_RenderReadPixels(renderer, &whole, SDL_PIXELFORMAT_RGB888, shown.data(), 640 * 4) == 0);
  int wrong = 0;
  for (std::size_t y = 0; y < 480; ++y)
    for (std::size_t x = 0; x < 640; ++x)
      wrong += (shown[y * 640 + x] & 0xffffff) != screen.memory[y / 2 * 320 + x / 2];
  CHECK(wrong == 0);
}

// Goal: the window of an emulated device shows 16-bit pixels in its order, and a screen mounted sideways upright.
// Method: as above, with each order and rotation; a picture of levels common to both formats, rotated by its position.
TEST_CASE("sdl2_window_shows_an_emulated_screen_upright") {
  for (bool blue_first : {false, true})
    for (int rotation : {0, 90, 180, 270}) {
      CAPTURE(blue_first);
      CAPTURE(rotation);
      Window screen;
      screen.options.width = 64;
      screen.options.height = 48;
      screen.options.rotation = rotation;
      screen.options.bits_per_pixel = 16;
      screen.options.blue_first = blue_first;
      screen.options.upright = true;
      REQUIRE_MESSAGE(screen.open(), screen.error.text);
      CHECK(screen.format.bits_per_pixel == 16);
      CHECK(screen.format.red.offset == (blue_first ? 0 : 11));
      CHECK(screen.format.width == (rotation % 180 == 0 ? 64 : 48));
      Page page = kSdl2Backend.begin_frame();
      CHECK(page.line_bytes == 2 * screen.format.width);
      for (int y = 0; y < 48; ++y)
        for (int x = 0; x < 64; ++x) {
          int to_x = x, to_y = y;  // clockwise
          if (rotation == 90) to_x = 47 - y, to_y = x;
          if (rotation == 180) to_x = 63 - x, to_y = 47 - y;
          if (rotation == 270) to_x = y, to_y = 63 - x;
          int value = x / 2 << screen.format.red.offset | y / 2 << screen.format.blue.offset;
          static_cast<std::uint16_t*>(page.pixels)[to_y * screen.format.width + to_x] =
              static_cast<std::uint16_t>(value);
        }
      kSdl2Backend.end_frame(0, screen.format.height);
      SDL_Renderer* renderer = SDL_GetRenderer(window());
      REQUIRE(renderer != nullptr);
      std::vector<std::uint32_t> shown(128 * 96);
      SDL_Rect whole = {0, 0, 128, 96};
      SDL_RenderSetLogicalSize(renderer, 0, 0);
      REQUIRE(SDL_RenderReadPixels(renderer, &whole, SDL_PIXELFORMAT_RGB888, shown.data(), 128 * 4) == 0);
      int wrong = 0;
      for (int y = 0; y < 96; ++y)
        for (int x = 0; x < 128; ++x) {
          std::uint32_t pixel = shown[static_cast<std::size_t>(y * 128 + x)];
          wrong += static_cast<int>(pixel >> 19 & 31) != x / 4 || static_cast<int>(pixel >> 3 & 31) != y / 4;
        }
      CHECK(wrong == 0);
    }
}

// Goal: keys map to the handheld's buttons, once each. Method: pushed events.
TEST_CASE("sdl2_keys_are_the_handhelds_buttons") {
  Window screen;
  REQUIRE(screen.open());
  taken();
  push_key(SDL_SCANCODE_LEFT, true);
  push_key(SDL_SCANCODE_LEFT, true, true);
  push_key(SDL_SCANCODE_X, true);
  push_key(SDL_SCANCODE_LEFT, false);
  push_key(SDL_SCANCODE_F1, true);
  push_key(SDL_SCANCODE_9, true);
  CHECK(taken() == "+left +a -left +hud");
  push_key(SDL_SCANCODE_ESCAPE, true);
  push_key(SDL_SCANCODE_ESCAPE, true, true);
  CHECK(taken() == "quit");
  SDL_Event event = {};
  event.type = SDL_QUIT;
  SDL_PushEvent(&event);
  CHECK(taken() == "quit");
}

// Goal: controllers map to the handheld's buttons, and a dropped file is reported. Method: pushed events.
TEST_CASE("sdl2_controllers_and_dropped_files_are_events") {
  Window screen;
  REQUIRE(screen.open());
  taken();
  SDL_Event event = {};
  event.type = SDL_CONTROLLERBUTTONDOWN;
  event.cbutton.button = SDL_CONTROLLER_BUTTON_BACK;
  SDL_PushEvent(&event);
  event = {};
  event.type = SDL_CONTROLLERAXISMOTION;
  event.caxis.axis = SDL_CONTROLLER_AXIS_LEFTY;
  event.caxis.value = -30000;
  SDL_PushEvent(&event);
  event.caxis.value = 100;
  SDL_PushEvent(&event);
  CHECK(taken() == "+select +up -up");
  event = {};
  event.type = SDL_DROPFILE;
  event.drop.file = SDL_strdup("scene.glb");
  SDL_PushEvent(&event);
  CHECK(taken() == "drop:scene.glb");
}

// Goal: a rotated picture gets a rotated window; too little memory is refused; the window may be opened again. Method:
// each.
TEST_CASE("sdl2_window_opens_turned_and_again") {
  Window screen;
  screen.options.rotation = 270;
  REQUIRE(screen.open());
  CHECK(screen.format.width == 240);
  CHECK(screen.format.height == 320);
  REQUIRE(screen.open());
  kSdl2Backend.close();
  kSdl2Backend.close();
  screen.options.memory_bytes -= 1;
  CHECK_FALSE(screen.open());
  CHECK(std::strstr(screen.error.text, "307200 bytes") != nullptr);
}
#endif
