// A framebuffer, a console and input devices recorded from real ones, behind the Linux backend's system calls. One at a
// time.
#pragma once
#include <linux/fb.h>
#include <linux/input.h>

#include <atomic>
#include <cstdint>
#include <deque>
#include <vector>

#include "platform/linux/driver.h"

namespace recorded {

enum class Vsync { absent, works, at_once, never };

struct Geometry {
  const char* name;
  std::uint32_t width, height, virtual_height, bits, line_bytes;
  fb_bitfield red, green, blue, alpha;
  std::uint32_t pan_step = 0;
  bool blind_until_put = false;  // stride 0 and no colour fields before FBIOPUT_VSCREENINFO: PL11x without fbcon
  bool refuses_put = false;
  std::uint32_t map_offset = 0;  // smem_start within its memory page
  std::uint32_t yoffset = 0;     // of a driver that always displays from there
};

struct InputDevice {
  bool stick = false, hat = false, gone = false, absent = false;  // gone: fails; absent: has no file
  std::deque<input_event> events;
};

struct Machine {
  Geometry geometry;
  Vsync vsync = Vsync::absent;
  int pans_accepted = 1 << 30;  // after that many the driver refuses
  bool has_console = true;
  std::vector<std::uint8_t> memory;  // mapped as a whole; the pixels start at map_offset
  std::vector<InputDevice> inputs;

  bool put = false;
  std::uint32_t yoffset = 0;
  int pans = 0, puts = 0, restores = 0;
  std::atomic<int> vsync_calls{0};
  std::atomic<std::uint64_t> clock_ns{1'000'000'000};
  std::atomic<bool> release{false};  // releases a wait that never returns
  std::atomic<bool> stuck{false};
  std::uint64_t slept_ns = 0;
  int console_mode = 0, keyboard_mode = 3;  // KD_TEXT, K_UNICODE
  int files_open = 0, maps = 0;
};

extern Machine* machine;
extern const platform::Driver kDriver;

// A machine with that screen; memory filled with 0xee.
void reset(Machine* fresh, const Geometry& geometry, Vsync vsync = Vsync::absent);
// The pixel visible at (x, y) of the panel, after panning.
const std::uint8_t* shown(int x, int y);

}  // namespace recorded
