// Keys, buttons, hats and sticks of all /dev/input/event*, mapped to the handheld's buttons.
#pragma once
#include "platform/linux/driver.h"
#include "platform/platform.h"

namespace platform {

constexpr int kInputCountMax = 32;

struct Input {
  int file = -1, number = 0;  // of /dev/input/event…
  struct Axis {
    int low = 0, high = 0;  // beyond these it is pressed; equal: no such axis
    int direction = 0;      // −1, 0, 1
  } axes[4];                // stick X and Y, hat X and Y
};

struct InputQueue {
  const Driver* driver = nullptr;
  const std::uint16_t* keys = nullptr;
  Input inputs[kInputCountMax];
  int input_count = 0;
  std::uint32_t open_numbers = 0;  // one bit per device
  std::uint32_t lost_numbers = 0;  // devices that failed, until their files are gone
  std::uint64_t looked_ns = 0;     // time of the last scan for new devices
  std::uint32_t held = 0;          // one bit per button
  bool control_held = false;
  Event events[2 * kButtonCount];
  int first = 0, count = 0;
};

// Opens all devices, possibly none; later ones are opened within a second of polling. `keys`: key codes of the buttons
// up … select, or null for a keyboard.
void input_open(const Driver& driver, const std::uint16_t* keys, InputQueue* queue);
bool input_poll(InputQueue* queue, Event* event);
void input_close(InputQueue* queue);

}  // namespace platform
