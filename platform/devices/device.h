// A device as data. One file per device; device_list.h names them all. Standard types only: src/ reads these too.
#pragma once
#include <cstddef>
#include <cstdint>

namespace platform {

// The codes of <linux/input-event-codes.h> that devices have on their buttons.
namespace key {
constexpr std::uint16_t kEscape = 1, kBackspace = 14, kTab = 15, kE = 18, kT = 20, kEnter = 28, kLeftControl = 29,
                        kLeftShift = 42, kLeftAlt = 56, kSpace = 57, kRightControl = 97, kUp = 103, kLeft = 105,
                        kRight = 106, kDown = 108;
}

struct Device {
  const char* name;         // as on the command line
  const char* description;  // one line
  const char* cpu_class;    // what to build for: armel, armhf, aarch64, x86-64
  int screen_width, screen_height;
  int bits_per_pixel;
  const char* channel_order;  // rgb: red in the highest bits; bgr: blue. What the driver says wins.
  int rotation;               // degrees clockwise by which a picture is turned on the screen to stand upright
  std::size_t memory_bytes;   // default of the memory block: half of what Linux has, at most 512 MiB
  const std::uint16_t* keys;  // key codes of up, down, left, right, A, B, X, Y, L, R, start, select; null: a keyboard's
};

constexpr std::size_t mebibytes(std::size_t count) { return count << 20; }

}  // namespace platform
