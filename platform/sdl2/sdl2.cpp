#include "platform/sdl2/sdl2.h"

#define SDL_MAIN_HANDLED
#include <SDL.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <thread>

#include "platform/check.h"

namespace platform {
namespace {

struct KeyButton {
  SDL_Scancode key;
  Button button;
};
// By position on the keyboard, whatever is printed there; as in evdev.
constexpr KeyButton kKeys[] = {
    {SDL_SCANCODE_UP, Button::up},
    {SDL_SCANCODE_DOWN, Button::down},
    {SDL_SCANCODE_LEFT, Button::left},
    {SDL_SCANCODE_RIGHT, Button::right},
    {SDL_SCANCODE_X, Button::a},
    {SDL_SCANCODE_Z, Button::b},
    {SDL_SCANCODE_S, Button::x},
    {SDL_SCANCODE_A, Button::y},
    {SDL_SCANCODE_Q, Button::l},
    {SDL_SCANCODE_W, Button::r},
    {SDL_SCANCODE_RETURN, Button::start},
    {SDL_SCANCODE_RSHIFT, Button::select},
    {SDL_SCANCODE_F1, Button::hud},
    {SDL_SCANCODE_F12, Button::screenshot},
    {SDL_SCANCODE_F5, Button::reload},
    {SDL_SCANCODE_PRINTSCREEN, Button::screenshot},
    {SDL_SCANCODE_EQUALS, Button::finer},
    {SDL_SCANCODE_KP_PLUS, Button::finer},
    {SDL_SCANCODE_PAGEUP, Button::finer},
    {SDL_SCANCODE_MINUS, Button::faster},
    {SDL_SCANCODE_KP_MINUS, Button::faster},
    {SDL_SCANCODE_PAGEDOWN, Button::faster},
    {SDL_SCANCODE_V, Button::side_by_side},
    {SDL_SCANCODE_T, Button::traced},
    {SDL_SCANCODE_N, Button::animation},
};

struct ControllerButton {
  SDL_GameControllerButton code;
  Button button;
};
constexpr ControllerButton kControllerButtons[] = {
    {SDL_CONTROLLER_BUTTON_DPAD_UP, Button::up},
    {SDL_CONTROLLER_BUTTON_DPAD_DOWN, Button::down},
    {SDL_CONTROLLER_BUTTON_DPAD_LEFT, Button::left},
    {SDL_CONTROLLER_BUTTON_DPAD_RIGHT, Button::right},
    {SDL_CONTROLLER_BUTTON_A, Button::a},
    {SDL_CONTROLLER_BUTTON_B, Button::b},
    {SDL_CONTROLLER_BUTTON_X, Button::x},
    {SDL_CONTROLLER_BUTTON_Y, Button::y},
    {SDL_CONTROLLER_BUTTON_LEFTSHOULDER, Button::l},
    {SDL_CONTROLLER_BUTTON_RIGHTSHOULDER, Button::r},
    {SDL_CONTROLLER_BUTTON_START, Button::start},
    {SDL_CONTROLLER_BUTTON_BACK, Button::select},
};

constexpr int kControllerCountMax = 8;
constexpr int kQueueCapacity = 2 * kButtonCount;

struct State {
  SDL_Window* window = nullptr;
  SDL_Renderer* renderer = nullptr;
  SDL_Texture* texture = nullptr;
  SDL_GameController* controllers[kControllerCountMax] = {};
  int stick[2] = {};  // −1, 0, 1
  unsigned char* page = nullptr;
  ScreenFormat format;
  int view_width = 0, view_height = 0;  // shown by the window: the screen, or the screen rotated back
  int turn = 0;                         // degrees clockwise of that rotation
  bool shown = false;                   // a frame was shown
  std::uint32_t held = 0;               // one bit per button
  Event queue[kQueueCapacity];
  int first = 0, count = 0;
  char dropped_path[1024] = {};
};
State state;

std::uint64_t now_ns() {
  auto now = std::chrono::steady_clock::now().time_since_epoch();
  return static_cast<std::uint64_t>(std::chrono::duration_cast<std::chrono::nanoseconds>(now).count());
}
void sleep_ns(std::uint64_t duration) { std::this_thread::sleep_for(std::chrono::nanoseconds(duration)); }

bool is_set(const char* variable) {
  const char* value = std::getenv(variable);
  return value && value[0];
}
bool usable() { return is_set("DISPLAY") || is_set("WAYLAND_DISPLAY") || is_set("SDL_VIDEODRIVER"); }

void close() {
  for (SDL_GameController*& controller : state.controllers) {
    if (controller) SDL_GameControllerClose(controller);
    controller = nullptr;
  }
  if (state.texture) SDL_DestroyTexture(state.texture);
  if (state.renderer) SDL_DestroyRenderer(state.renderer);
  if (state.window) SDL_DestroyWindow(state.window);
  if (SDL_WasInit(SDL_INIT_VIDEO)) SDL_Quit();
  state = State();
}

// The largest whole scale that leaves a quarter of the desktop free.
int comfortable_scale(int width, int height) {
  SDL_Rect bounds;
  if (SDL_GetDisplayUsableBounds(0, &bounds) != 0) return 1;
  int scale = 1;
  while ((scale + 1) * width <= bounds.w * 3 / 4 && (scale + 1) * height <= bounds.h * 3 / 4) ++scale;
  return scale;
}

bool open_window(const ScreenOptions& options, const char** what) {
  SDL_SetHint(SDL_HINT_NO_SIGNAL_HANDLERS, "1");  // the program handles Ctrl-C
  SDL_SetHint(SDL_HINT_RENDER_SCALE_QUALITY, "nearest");
  *what = "start SDL";
  if (SDL_Init(SDL_INIT_VIDEO) != 0) return false;
  // Without a display, SDL draws invisibly, which is only for those who ask for it.
  const char* driver = SDL_GetCurrentVideoDriver();
  if (!is_set("SDL_VIDEODRIVER") && driver && (!std::strcmp(driver, "offscreen") || !std::strcmp(driver, "dummy"))) {
    SDL_SetError("no display answers at DISPLAY or WAYLAND_DISPLAY");
    return false;
  }
  SDL_InitSubSystem(SDL_INIT_GAMECONTROLLER);  // without controllers the keyboard still works
  int scale = options.scale > 0 ? options.scale : comfortable_scale(state.view_width, state.view_height);
  *what = "open a window";
  state.window = SDL_CreateWindow(options.title, SDL_WINDOWPOS_CENTERED, SDL_WINDOWPOS_CENTERED,
                                  state.view_width * scale, state.view_height * scale, SDL_WINDOW_RESIZABLE);
  if (!state.window) return false;
  SDL_SetWindowMinimumSize(state.window, state.view_width, state.view_height);
  // Without waiting for the vertical blank: a hidden window would wait forever.
  *what = "draw in the window";
  state.renderer = SDL_CreateRenderer(state.window, -1, 0);
  if (!state.renderer) return false;
  if (SDL_RenderSetLogicalSize(state.renderer, state.view_width, state.view_height) != 0) return false;
  if (SDL_RenderSetIntegerScale(state.renderer, SDL_TRUE) != 0) return false;
  const ScreenFormat& format = state.format;
  bool blue_first = format.blue.offset > format.red.offset;
  Uint32 pixels = format.bits_per_pixel == 16 ? (blue_first ? SDL_PIXELFORMAT_BGR565 : SDL_PIXELFORMAT_RGB565)
                                              : (blue_first ? SDL_PIXELFORMAT_BGR888 : SDL_PIXELFORMAT_RGB888);
  state.texture = SDL_CreateTexture(state.renderer, pixels, SDL_TEXTUREACCESS_STREAMING, format.width, format.height);
  return state.texture != nullptr;
}

void show() {
  SDL_SetRenderDrawColor(state.renderer, 0, 0, 0, 255);
  SDL_RenderClear(state.renderer);
  SDL_Rect screen = {(state.view_width - state.format.width) / 2, (state.view_height - state.format.height) / 2,
                     state.format.width, state.format.height};
  SDL_RenderCopyEx(state.renderer, state.texture, nullptr, &screen, state.turn, nullptr, SDL_FLIP_NONE);
  SDL_RenderPresent(state.renderer);
}

int line_bytes() { return state.format.width * (state.format.bits_per_pixel / 8); }

Page begin_frame() { return {state.page, line_bytes(), state.shown ? 1 : 0}; }

void end_frame(int row_begin, int row_end) {
  PLATFORM_CHECK(state.texture != nullptr);  // it is open
  if (row_begin < 0) row_begin = 0;
  if (row_end > state.format.height) row_end = state.format.height;
  if (row_begin < row_end) {
    SDL_Rect rows = {0, row_begin, state.format.width, row_end - row_begin};
    SDL_UpdateTexture(state.texture, &rows, state.page + static_cast<std::ptrdiff_t>(row_begin) * line_bytes(),
                      line_bytes());
  }
  state.shown = true;
  show();
}

Event* push(EventType type) {
  if (state.count == kQueueCapacity) --state.count;  // the newest one is dropped
  Event* event = &state.queue[(state.first + state.count++) % kQueueCapacity];
  *event = Event();
  event->type = type;
  event->time_ns = now_ns();
  return event;
}

void set_button(Button button, bool down) {
  PLATFORM_CHECK_LT(static_cast<int>(button), kButtonCount);
  std::uint32_t bit = 1u << static_cast<int>(button);
  if (((state.held & bit) != 0) == down) return;
  state.held ^= bit;
  push(down ? EventType::button_down : EventType::button_up)->button = button;
}

void take_key(SDL_Scancode key, bool down) {
  if (down && key == SDL_SCANCODE_ESCAPE) push(EventType::quit);
  for (const KeyButton& entry : kKeys)
    if (entry.key == key) set_button(entry.button, down);
}

void take_stick(int axis, int value) {
  PLATFORM_CHECK(axis == 0 || axis == 1);
  int direction = value <= -16384 ? -1 : value >= 16384 ? 1 : 0;
  if (direction == state.stick[axis]) return;
  Button negative = axis ? Button::up : Button::left, positive = axis ? Button::down : Button::right;
  if (state.stick[axis]) set_button(state.stick[axis] < 0 ? negative : positive, false);
  if (direction) set_button(direction < 0 ? negative : positive, true);
  state.stick[axis] = direction;
}

void add_controller(int index) {
  for (SDL_GameController*& controller : state.controllers) {
    if (controller) continue;
    controller = SDL_GameControllerOpen(index);
    return;
  }
}

void remove_controller(SDL_JoystickID id) {
  SDL_GameController* gone = SDL_GameControllerFromInstanceID(id);
  for (SDL_GameController*& controller : state.controllers) {
    if (!gone || controller != gone) continue;
    SDL_GameControllerClose(controller);
    controller = nullptr;
  }
  state.stick[0] = state.stick[1] = 0;
  for (int i = 0; i < kButtonCount; ++i) set_button(static_cast<Button>(i), false);
}

void take_drop(char* path) {
  if (!path) return;
  if (std::strlen(path) < sizeof state.dropped_path) {
    std::strcpy(state.dropped_path, path);
    push(EventType::file_drop)->path = state.dropped_path;
  }
  SDL_free(path);
}

void take(const SDL_Event& event) {
  switch (event.type) {
    case SDL_QUIT:
      push(EventType::quit);
      break;
    case SDL_KEYDOWN:
      if (!event.key.repeat) take_key(event.key.keysym.scancode, true);
      break;
    case SDL_KEYUP:
      take_key(event.key.keysym.scancode, false);
      break;
    case SDL_CONTROLLERBUTTONDOWN:
    case SDL_CONTROLLERBUTTONUP:
      for (const ControllerButton& entry : kControllerButtons)
        if (entry.code == event.cbutton.button) set_button(entry.button, event.type == SDL_CONTROLLERBUTTONDOWN);
      break;
    case SDL_CONTROLLERAXISMOTION:
      if (event.caxis.axis == SDL_CONTROLLER_AXIS_LEFTX) take_stick(0, event.caxis.value);
      if (event.caxis.axis == SDL_CONTROLLER_AXIS_LEFTY) take_stick(1, event.caxis.value);
      break;
    case SDL_CONTROLLERDEVICEADDED:
      add_controller(event.cdevice.which);
      break;
    case SDL_CONTROLLERDEVICEREMOVED:
      remove_controller(event.cdevice.which);
      break;
    case SDL_DROPFILE:
      take_drop(event.drop.file);
      break;
    case SDL_WINDOWEVENT:
      if (state.shown &&
          (event.window.event == SDL_WINDOWEVENT_EXPOSED || event.window.event == SDL_WINDOWEVENT_SIZE_CHANGED))
        show();
      break;
    default:
      break;
  }
}

// Processes SDL's events until one of them matters.
void pump() {
  SDL_Event next;
  while (state.count == 0 && SDL_PollEvent(&next)) take(next);
}

bool open(const ScreenOptions& options, ScreenFormat* format, Error* error) {
  PLATFORM_CHECK(format != nullptr && error != nullptr);
  close();
  bool turned = options.rotation == 90 || options.rotation == 270;
  int width = turned ? options.height : options.width, height = turned ? options.width : options.height;
  state.format = screen_format(width, height, options.bits_per_pixel, options.blue_first);
  state.view_width = options.upright ? options.width : width;
  state.view_height = options.upright ? options.height : height;
  state.turn = options.upright ? (360 - options.rotation) % 360 : 0;
  std::size_t bytes = page_bytes_max(width, height);
  if (!options.memory || options.memory_bytes < bytes) {
    std::snprintf(error->text, sizeof error->text, "the back page needs %zu bytes but %zu were given", bytes,
                  options.memory_bytes);
    return false;
  }
  state.page = static_cast<unsigned char*>(options.memory);
  const char* what = "";
  if (!open_window(options, &what)) {
    std::snprintf(error->text, sizeof error->text, "cannot %s: %s (without a display, write a file instead)", what,
                  SDL_GetError());
    close();
    return false;
  }
  // Shows a first, black frame and polls once, so that SDL takes the memory for both now.
  std::memset(state.page, 0, bytes);
  SDL_UpdateTexture(state.texture, nullptr, state.page, line_bytes());
  show();
  pump();
  *format = state.format;
  return true;
}

bool poll(Event* event) {
  PLATFORM_CHECK(event != nullptr);
  pump();
  if (state.count == 0) return false;
  *event = state.queue[state.first];
  state.first = (state.first + 1) % kQueueCapacity;
  --state.count;
  return true;
}

}  // namespace

const Backend kSdl2Backend = {
    "sdl2", "a display, DISPLAY or WAYLAND_DISPLAY", usable, open, begin_frame, end_frame, poll, now_ns, sleep_ns,
    close};

}  // namespace platform
