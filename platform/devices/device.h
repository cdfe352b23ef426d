// A device as data. One file per device; device_list.h lists them all. Standard types only: src/ reads these too.
#pragma once
#include <cstddef>
#include <cstdint>

namespace platform {

// Key codes from <linux/input-event-codes.h> for the buttons of devices.
namespace key {
constexpr std::uint16_t kEscape = 1, kBackspace = 14, kTab = 15, kE = 18, kT = 20, kEnter = 28, kLeftControl = 29,
                        kLeftShift = 42, kLeftAlt = 56, kSpace = 57, kRightControl = 97, kUp = 103, kLeft = 105,
                        kRight = 106, kDown = 108;
}

// Where nobody has measured `slowdown`, it is estimated: instructions per pixel × clocks per instruction / clock rate,
// divided by 690 and 1010 ns, the cost of the scenes cornell and seesaw at 320 × 240 on one core of a 2.8 GHz Xeon
// (tests/bench/FIGURES.md), as the geometric mean of both. A plugin of qemu-arm 7.2 counted the instructions per pixel:
// 162,000 and 326,000 in the armel build, whose floats are software, 17,400 and 22,100 in the armhf build. Clocks per
// instruction are guesses, as noted at each number; so are latency and jitter where no source is named.
struct Device {
  const char* name;         // as on the command line
  const char* description;  // one line
  const char* cpu_class;    // build to use: armel, armhf, aarch64, x86-64
  int screen_width, screen_height;
  int bits_per_pixel;
  const char* channel_order;  // rgb: red in the highest bits; bgr: blue. The driver's report overrides it.
  int rotation;               // degrees clockwise to turn a picture on the screen so that it is upright
  std::size_t memory_bytes;   // default of the memory block: half of Linux's memory, at most 512 MiB
  const std::uint16_t*
      keys;  // key codes of up, down, left, right, A, B, X, Y, L, R, start, select; null: those of a keyboard

  // For emulation on a desktop.
  int core_count;   // of its CPU; 0: as many as this machine has
  double slowdown;  // time per pixel on one of them over that on one x86-64 core of 2.8 to 3 GHz, same program
  std::uint64_t link_bytes_per_second;  // each way, TCP payload
  std::uint64_t link_latency_ns;        // one way
  std::uint64_t link_jitter_ns;         // maximum addition to the latency
};

constexpr std::uint64_t microseconds(std::uint64_t count) { return count * 1000; }
constexpr std::size_t mebibytes(std::size_t count) { return count << 20; }

}  // namespace platform
