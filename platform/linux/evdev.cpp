#include "platform/linux/evdev.h"

#include <errno.h>
#include <fcntl.h>
#include <linux/input.h>
#include <stdio.h>

#include "platform/check.h"

namespace platform {
namespace {

// A keyboard as a gamepad: arrows, X Z S A Q W, Enter, right Shift; as in the SDL2 window.
constexpr std::uint16_t kKeyboard[kPadButtonCount] = {KEY_UP, KEY_DOWN, KEY_LEFT, KEY_RIGHT, KEY_X,     KEY_Z,
                                                      KEY_S,  KEY_A,    KEY_Q,    KEY_W,     KEY_ENTER, KEY_RIGHTSHIFT};

struct KeyButton {
  std::uint16_t code;
  Button button;
};
// Accepted in addition to the device's own keys.
constexpr KeyButton kMoreKeys[] = {
    {BTN_DPAD_UP, Button::up},
    {BTN_DPAD_DOWN, Button::down},
    {BTN_DPAD_LEFT, Button::left},
    {BTN_DPAD_RIGHT, Button::right},
    {BTN_A, Button::a},
    {BTN_B, Button::b},
    {BTN_X, Button::x},
    {BTN_Y, Button::y},
    {BTN_TL, Button::l},
    {BTN_TR, Button::r},
    {BTN_START, Button::start},
    {BTN_SELECT, Button::select},
    {KEY_F1, Button::hud},
    {KEY_F5, Button::reload},
    {KEY_F12, Button::screenshot},
    {KEY_SYSRQ, Button::screenshot},
    {KEY_EQUAL, Button::finer},
    {KEY_KPPLUS, Button::finer},
    {KEY_PAGEUP, Button::finer},
    {KEY_MINUS, Button::faster},
    {KEY_KPMINUS, Button::faster},
    {KEY_PAGEDOWN, Button::faster},
    {KEY_V, Button::side_by_side},
    {KEY_T, Button::traced},
    {KEY_N, Button::animation},
};

constexpr std::uint16_t kAxisCodes[4] = {ABS_X, ABS_Y, ABS_HAT0X, ABS_HAT0Y};

void push(InputQueue* queue, EventType type, Button button) {
  constexpr int kCapacity = sizeof queue->events / sizeof queue->events[0];
  if (queue->count == kCapacity) return;
  Event& event = queue->events[(queue->first + queue->count++) % kCapacity];
  event = Event();
  event.type = type;
  event.button = button;
  event.time_ns = queue->driver->now_ns();
}

void set_button(InputQueue* queue, Button button, bool down) {
  PLATFORM_CHECK_LT(static_cast<int>(button), kButtonCount);
  std::uint32_t bit = 1u << static_cast<int>(button);
  if (((queue->held & bit) != 0) == down) return;
  queue->held ^= bit;
  push(queue, down ? EventType::button_down : EventType::button_up, button);
  // Handhelds have no key to quit: start and select together do it.
  constexpr std::uint32_t kLeave = 1u << static_cast<int>(Button::start) | 1u << static_cast<int>(Button::select);
  if (down && (bit & kLeave) && (queue->held & kLeave) == kLeave) push(queue, EventType::quit, button);
}

void release_all(InputQueue* queue) {
  for (int i = 0; i < kButtonCount; ++i) set_button(queue, static_cast<Button>(i), false);
  queue->control_held = false;
  for (int i = 0; i < queue->input_count; ++i)
    for (Input::Axis& axis : queue->inputs[i].axes) axis.direction = 0;
}

void take_key(InputQueue* queue, std::uint16_t code, bool down) {
  for (int i = 0; i < kPadButtonCount; ++i)
    if (queue->keys[i] == code) return set_button(queue, static_cast<Button>(i), down);
  for (const KeyButton& key : kMoreKeys)
    if (key.code == code) return set_button(queue, key.button, down);
  // The console's keyboard is off, so Ctrl-C must be handled here.
  if (code == KEY_LEFTCTRL || code == KEY_RIGHTCTRL) queue->control_held = down;
  if (down && (code == KEY_ESC || code == KEY_POWER || (code == KEY_C && queue->control_held)))
    push(queue, EventType::quit, Button::up);
}

void take_axis(InputQueue* queue, Input* input, std::uint16_t code, int value) {
  for (int i = 0; i < 4; ++i) {
    Input::Axis& axis = input->axes[i];
    if (kAxisCodes[i] != code || axis.low == axis.high) continue;
    int direction = value <= axis.low ? -1 : value >= axis.high ? 1 : 0;
    if (direction == axis.direction) return;
    Button negative = i % 2 ? Button::up : Button::left, positive = i % 2 ? Button::down : Button::right;
    if (axis.direction) set_button(queue, axis.direction < 0 ? negative : positive, false);
    if (direction) set_button(queue, direction < 0 ? negative : positive, true);
    axis.direction = direction;
  }
}

constexpr std::uint64_t kLookNs = 1'000'000'000;  // chosen: a pad plugged in later works at once; 32 calls cost little

void find_axes(const Driver& driver, Input* input) {
  for (int i = 0; i < 4; ++i) {
    input_absinfo range = {};
    if (driver.ioctl(input->file, EVIOCGABS(kAxisCodes[i]), &range) != 0 || range.maximum <= range.minimum) continue;
    // Pressed from half-way between centre and end.
    std::int64_t quarter = (static_cast<std::int64_t>(range.maximum) - range.minimum) / 4;
    input->axes[i].low = static_cast<int>(range.minimum + quarter);
    input->axes[i].high = static_cast<int>(range.maximum - quarter);
  }
}

// Opens the devices that are not open yet. A failed one is ignored until it has been unplugged.
void open_inputs(InputQueue* queue) {
  static_assert(kInputCountMax <= 32, "one bit each");
  queue->looked_ns = queue->driver->now_ns();
  for (int i = 0; i < kInputCountMax; ++i) {
    std::uint32_t bit = 1u << i;
    if (queue->open_numbers & bit) continue;
    char path[32];
    snprintf(path, sizeof path, "/dev/input/event%d", i);
    Input input;
    input.number = i;
    input.file = queue->driver->open(path, O_RDONLY | O_NONBLOCK);
    if (input.file < 0) {
      queue->lost_numbers &= ~bit;
    } else if (queue->lost_numbers & bit) {
      queue->driver->close(input.file);
    } else {
      find_axes(*queue->driver, &input);
      PLATFORM_CHECK_LT(queue->input_count, kInputCountMax);
      queue->inputs[queue->input_count++] = input;
      queue->open_numbers |= bit;
    }
  }
}

void drop_input(InputQueue* queue, int index) {
  PLATFORM_CHECK(index >= 0 && index < queue->input_count);
  queue->driver->close(queue->inputs[index].file);
  std::uint32_t bit = 1u << queue->inputs[index].number;
  queue->open_numbers &= ~bit, queue->lost_numbers |= bit;
  queue->inputs[index] = queue->inputs[--queue->input_count];
  release_all(queue);  // the device is gone: its button releases will not arrive
}

void read_input(InputQueue* queue, int index) {
  input_event event;
  ssize_t bytes = queue->driver->read(queue->inputs[index].file, &event, sizeof event);
  if (bytes < 0 && (errno == EAGAIN || errno == EINTR)) return;
  if (bytes != static_cast<ssize_t>(sizeof event)) return drop_input(queue, index);
  if (event.type == EV_KEY && event.value != 2) take_key(queue, event.code, event.value != 0);  // 2: auto-repeat
  if (event.type == EV_ABS) take_axis(queue, &queue->inputs[index], event.code, event.value);
  if (event.type == EV_SYN && event.code == SYN_DROPPED) release_all(queue);
}

}  // namespace

void input_open(const Driver& driver, const std::uint16_t* keys, InputQueue* queue) {
  *queue = InputQueue();
  queue->driver = &driver;
  queue->keys = keys ? keys : kKeyboard;
  open_inputs(queue);
}

bool input_poll(InputQueue* queue, Event* event) {
  PLATFORM_CHECK(event != nullptr && queue->driver != nullptr);
  if (queue->driver->now_ns() - queue->looked_ns >= kLookNs) open_inputs(queue);
  // Reads events until one matters; a device that never stops sending does not block us.
  for (int round = 0; round < 64 && queue->count == 0 && queue->input_count > 0; ++round) {
    pollfd files[kInputCountMax];
    for (int i = 0; i < queue->input_count; ++i) files[i] = {queue->inputs[i].file, POLLIN, 0};
    if (queue->driver->poll(files, queue->input_count) <= 0) break;
    // Backwards, because the last one replaces a dropped device, and that has been read already.
    for (int i = queue->input_count - 1; i >= 0 && queue->count <= kButtonCount - 3; --i)
      if (files[i].revents) read_input(queue, i);
  }
  if (queue->count == 0) return false;
  constexpr int kCapacity = sizeof queue->events / sizeof queue->events[0];
  *event = queue->events[queue->first];
  queue->first = (queue->first + 1) % kCapacity;
  --queue->count;
  return true;
}

void input_close(InputQueue* queue) {
  for (int i = 0; i < queue->input_count; ++i) queue->driver->close(queue->inputs[i].file);
  queue->input_count = 0;
}

}  // namespace platform
