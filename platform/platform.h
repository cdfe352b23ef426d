// The platform contract: a screen, buttons and a clock, as one struct of functions per backend. Standard types only.
// Only the rooms of src/ from session/ upward include it, and nothing under platform/ includes anything from src/.
// PORTING.md explains how to write a backend.
//
// All functions are called from one thread. After open() a backend takes no memory and has no unbounded waits.
#pragma once
#include <cstddef>
#include <cstdint>

namespace platform {

enum class Button : std::uint8_t {
  up,
  down,
  left,
  right,
  a,
  b,
  x,
  y,
  l,
  r,
  start,
  select,
  hud,
  screenshot,
  reload,
  finer,
  faster,
  side_by_side,
  traced,
  animation
};
constexpr int kPadButtonCount = 12;  // up … select: a handheld's
constexpr int kButtonCount = 20;     // with the keys of a desktop keyboard

enum class EventType : std::uint8_t { button_down, button_up, file_drop, quit };

struct Event {
  EventType type = EventType::quit;
  Button button = Button::up;  // for button_down and button_up; holding a button is reported once
  const char* path = nullptr;  // for file_drop; valid until the next poll()
  std::uint64_t time_ns = 0;   // by the backend's clock, now_ns()
};

// Position of a colour channel in a pixel: `length` bits from bit `offset` upward of the pixel read as one integer.
struct Channel {
  int offset = 0, length = 0;
};

// The hardware's screen, before any rotation. Pixels are 16 or 32 bits in the CPU's byte order, or 24 bits with the
// lowest byte first. Bits of no channel are written as zero, bits of alpha as one.
struct ScreenFormat {
  int width = 0, height = 0;  // pixels to draw into
  int bits_per_pixel = 0;
  Channel red, green, blue, alpha;
};

// Where to draw the next frame.
struct Page {
  void* pixels = nullptr;  // row 0, column 0
  int line_bytes = 0;      // from one row to the next, at least width × bytes per pixel
  int age = 0;             // it holds the frame shown this many frames ago; 0: unknown, draw every row
};

struct ScreenOptions {
  int width = 320,
      height = 240;         // requested picture, before rotation; a smaller screen reduces it, a larger one centres it
  int rotation = 0;         // 0, 90, 180, 270: degrees clockwise by which the caller rotates the picture on the screen
  int scale = 0;            // screen pixels per pixel; 0: in a window what fits comfortably, otherwise the maximum
  const char* title = "";   // of a window
  int bits_per_pixel = 0;   // of a window or of no screen: 16 or 32, as on the screen it represents; 0: 32
  bool blue_first = false;  // blue in the highest bits instead of red
  bool upright = false;     // of a window: rotates the screen back, as a user would hold the device
  const char* device = nullptr;         // of a framebuffer; null: the default one
  const std::uint16_t* keys = nullptr;  // of evdev: kPadButtonCount key codes, up … select; null: a keyboard's
  void* memory = nullptr;        // back page from the caller, until close(): at least page_bytes_max(width, height)
  std::size_t memory_bytes = 0;  //   bytes, aligned to 4
};

// Format of a screen of that size: 32 bits as 8-8-8, 16 as 5-6-5.
ScreenFormat screen_format(int width, int height, int bits_per_pixel, bool blue_first);

// Most bytes that a back page can take.
constexpr std::size_t page_bytes_max(int width, int height) {
  return static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * 4;
}

struct Error {
  char text[256] = {0};  // what is wrong and how to mend it
};

struct Backend {
  const char* name;
  // Requirement checked by usable(), to tell the user what is missing.
  const char* needs;
  // Returns whether open() might succeed here. Changes nothing.
  bool (*usable)();
  // Opens screen and buttons. On failure returns false with the reason in `error`, and changes nothing.
  bool (*open)(const ScreenOptions& options, ScreenFormat* format, Error* error);
  // Returns the page to draw the next frame into; valid until end_frame().
  Page (*begin_frame)();
  // Shows it. Rows [row_begin, row_end) may differ from the previous frame; the others are assumed to be unchanged.
  void (*end_frame)(int row_begin, int row_end);
  // Takes the next event, oldest first; returns false if there is none. Never waits.
  bool (*poll)(Event* event);
  std::uint64_t (*now_ns)();  // never runs backwards; its origin is arbitrary
  void (*sleep_ns)(std::uint64_t duration);
  // Restores screen and buttons. Does nothing if not open.
  void (*close)();
};

// All backends of this build, in order of preference; null, which works everywhere, comes last.
extern const Backend* const kBackends[];
extern const int kBackendCount;

// Returns the backend of that name, or null.
const Backend* platform_find(const char* name);

}  // namespace platform
