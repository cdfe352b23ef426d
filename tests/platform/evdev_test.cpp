#if defined(__linux__)
#include "platform/linux/evdev.h"
#include "platform/button_name.h"
#include "platform/devices/device_list.h"

#include <doctest/doctest.h>
#include <linux/input.h>

#include <string>

#include "recorded_driver.h"

using namespace platform;
using recorded::Machine;

namespace {

struct Pad {
  Machine machine;
  InputQueue queue;
  explicit Pad(int count, const std::uint16_t* keys = nullptr, bool stick = false, bool hat = false) {
    recorded::reset(&machine, recorded::Geometry());
    machine.inputs.resize(static_cast<std::size_t>(count));
    machine.inputs[0].stick = stick;
    machine.inputs[0].hat = hat;
    input_open(recorded::kDriver, keys, &queue);
  }
  ~Pad() { input_close(&queue); }
  void send(std::uint16_t type, std::uint16_t code, int value, std::size_t device = 0) {
    input_event event = {};
    event.type = type;
    event.code = code;
    event.value = value;
    machine.inputs[device].events.push_back(event);
  }
  // All events as text: +a, -a, quit.
  std::string taken() {
    std::string text;
    Event event;
    while (input_poll(&queue, &event)) {
      if (!text.empty()) text += ' ';
      if (event.type == EventType::quit)
        text += "quit";
      else
        text += (event.type == EventType::button_down ? "+" : "-") + std::string(button_name(event.button));
    }
    return text;
  }
};

}  // namespace

// Goal: keys of a keyboard and of a gamepad map to the pad, from several devices, without repeats. Method: recorded
// events.
TEST_CASE("evdev_keys_and_pad_buttons_are_the_handhelds") {
  Pad pad(3);
  CHECK(pad.taken() == "");
  pad.send(EV_KEY, KEY_UP, 1);
  pad.send(EV_SYN, SYN_REPORT, 0);
  pad.send(EV_KEY, KEY_UP, 2);
  pad.send(EV_KEY, KEY_UP, 0);
  CHECK(pad.taken() == "+up -up");
  pad.send(EV_KEY, BTN_A, 1, 2);
  CHECK(pad.taken() == "+a");
  pad.send(EV_KEY, KEY_X, 1, 1);  // the same button from another device: already down
  CHECK(pad.taken() == "");
  pad.send(EV_KEY, BTN_A, 0, 2);
  pad.send(EV_KEY, KEY_F1, 1);
  pad.send(EV_KEY, BTN_TOUCH, 1);
  pad.send(EV_REL, REL_X, 5);
  CHECK(pad.taken() == "-a +hud");
}

// Goal: a device's own key table takes precedence. Method: the RG350's, in which Esc is select and Ctrl is A.
TEST_CASE("evdev_key_table_of_a_device_comes_first") {
  Pad pad(1, find_device("rg350")->keys);
  pad.send(EV_KEY, KEY_LEFTCTRL, 1);
  pad.send(EV_KEY, KEY_ESC, 1);
  pad.send(EV_KEY, KEY_Z, 1);
  CHECK(pad.taken() == "+a +select");
  pad.send(EV_KEY, KEY_LEFTALT, 1);
  pad.send(EV_KEY, KEY_SPACE, 1);
  pad.send(EV_KEY, KEY_LEFTSHIFT, 1);
  pad.send(EV_KEY, KEY_TAB, 1);
  pad.send(EV_KEY, KEY_BACKSPACE, 1);
  CHECK(pad.taken() == "+b +x +y +l +r");
  pad.send(EV_KEY, KEY_ENTER, 1);
  CHECK(pad.taken() == "+start quit");  // start and select together
}

// Goal: Ctrl-C and Esc quit, since the console's keyboard is off. Method: with and without Ctrl.
TEST_CASE("evdev_escape_and_control_c_quit") {
  Pad pad(1);
  pad.send(EV_KEY, KEY_C, 1);
  CHECK(pad.taken() == "");
  pad.send(EV_KEY, KEY_RIGHTCTRL, 1);
  pad.send(EV_KEY, KEY_C, 1);
  CHECK(pad.taken() == "quit");
  pad.send(EV_KEY, KEY_RIGHTCTRL, 0);
  pad.send(EV_KEY, KEY_C, 1);
  CHECK(pad.taken() == "");
  pad.send(EV_KEY, KEY_ESC, 1);
  pad.send(EV_KEY, KEY_ESC, 2);
  CHECK(pad.taken() == "quit");
}

// Goal: sticks and hats press from half-way on. Method: a sweep of a stick of 0 … 255 and a hat.
TEST_CASE("evdev_sticks_and_hats_are_the_cross") {
  Pad pad(2, nullptr, true, true);
  pad.send(EV_ABS, ABS_X, 100);
  CHECK(pad.taken() == "");
  pad.send(EV_ABS, ABS_X, 63);
  CHECK(pad.taken() == "+left");
  pad.send(EV_ABS, ABS_X, 255);
  CHECK(pad.taken() == "-left +right");
  pad.send(EV_ABS, ABS_X, 128);
  CHECK(pad.taken() == "-right");
  pad.send(EV_ABS, ABS_Y, 0);
  pad.send(EV_ABS, ABS_Y, 127);
  CHECK(pad.taken() == "+up -up");
  pad.send(EV_ABS, ABS_HAT0Y, 1);
  pad.send(EV_ABS, ABS_HAT0Y, 0);
  CHECK(pad.taken() == "+down -down");
  pad.send(EV_ABS, ABS_X, 0, 1);  // the second device has no stick
  CHECK(pad.taken() == "");
}

// Goal: no button stays down forever. Method: dropped events; an unplugged device; the others still work.
TEST_CASE("evdev_releases_buttons_when_events_are_lost_or_a_device_goes") {
  Pad pad(2);
  pad.send(EV_KEY, KEY_LEFT, 1);
  pad.send(EV_KEY, KEY_S, 1);
  CHECK(pad.taken() == "+left +x");
  pad.send(EV_SYN, SYN_DROPPED, 0);
  CHECK(pad.taken() == "-left -x");
  pad.send(EV_KEY, KEY_LEFT, 1);
  CHECK(pad.taken() == "+left");
  pad.machine.inputs[0].gone = true;
  pad.send(EV_KEY, KEY_Z, 1, 1);
  CHECK(pad.taken() == "+b -left -b");
  CHECK(pad.machine.files_open == 1);
  pad.send(EV_KEY, KEY_Z, 0, 1);
  pad.send(EV_KEY, KEY_Z, 1, 1);
  CHECK(pad.taken() == "+b");
}

// Goal: a pad or keyboard that comes after the start works within a second, and again after being unplugged; one that
// fails but stays does not release the others' buttons every second. Method: devices that come, fail, go and come back.
TEST_CASE("evdev_finds_devices_that_come_later") {
  Pad pad(1);
  auto wait = [&](std::uint64_t duration) { pad.machine.clock_ns += duration; };
  pad.machine.inputs.resize(2);
  pad.machine.inputs[1].hat = true;
  pad.send(EV_KEY, BTN_A, 1, 1);
  pad.send(EV_ABS, ABS_HAT0X, 1, 1);
  wait(999'000'000);
  CHECK(pad.taken() == "");
  CHECK(pad.machine.files_open == 1);
  wait(1'000'000);
  CHECK(pad.taken() == "+a +right");
  CHECK(pad.machine.files_open == 2);
  pad.send(EV_KEY, KEY_Z, 1);
  CHECK(pad.taken() == "+b");
  pad.machine.inputs[1].gone = true;
  CHECK(pad.taken() == "-right -a -b");
  pad.send(EV_KEY, KEY_Z, 1);
  CHECK(pad.taken() == "+b");
  for (int second = 0; second < 3; ++second) {
    wait(1'000'000'000);
    CHECK(pad.taken() == "");
    CHECK(pad.machine.files_open == 1);
  }
  pad.machine.inputs[1].absent = true;
  wait(1'000'000'000);
  CHECK(pad.taken() == "");
  pad.machine.inputs[1] = recorded::InputDevice();
  pad.send(EV_KEY, BTN_A, 1, 1);
  wait(1'000'000'000);
  CHECK(pad.taken() == "+a");
  CHECK(pad.machine.files_open == 2);
  wait(1'000'000'000);
  CHECK(pad.taken() == "");
  CHECK(pad.machine.files_open == 2);
}

// Goal: a device that floods us with irrelevant events does not block poll(). Method: 10,000 movements, then a key.
TEST_CASE("evdev_poll_is_bounded_under_a_flood") {
  Pad pad(1);
  for (int i = 0; i < 10000; ++i) pad.send(EV_REL, REL_X, 1);
  pad.send(EV_KEY, KEY_UP, 1);
  Event event;
  CHECK_FALSE(input_poll(&pad.queue, &event));
  CHECK(pad.machine.inputs[0].events.size() > 9000);
  int polls = 1;
  while (!input_poll(&pad.queue, &event)) ++polls;
  CHECK(event.button == Button::up);
  CHECK(polls < 200);
}
#endif
