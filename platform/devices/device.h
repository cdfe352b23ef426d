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

// Unless measured, `slowdown` is estimated: clocks per pixel / clock rate, divided by 488 and 515 ns, the cost of
// the scenes cornell and seesaw at 320 × 240 on the core that 1 stands for, as the geometric mean of both.
// `make bench-device` counts the clocks, as instructions weighted by class: 39,000 and 56,000 in the armel build,
// whose floats are software, 7,000 and 10,300 in the armhf build (tests/bench/device/: expected.json,
// profiles_test.py). The weights are guesses and ignore cache misses; latency and jitter are guesses unless a source
// is named.
//
// Decoding takes an ARM926 35 clocks a pixel and 900 a byte of code, a Cortex-A7 24 and 870, an x86-64 core 1.1 ns and
// 92 (tests/bench/device/codec_cost.py, with frames of cornell and statue in both formats). Here an ARM920T, an
// ARM1176 and a JZ4770 count as an ARM926, and the tablet takes longer than x86-64 by its slowdown.
//
// Preparing a frame of a moving scene takes an ARM926 3,100 clocks a moving triangle and 5,400 a moving vertex, a
// Cortex-A7 800 and 350, an x86-64 core 75 and 24 ns (tests/bench/device/prepare_cost.py; `bench seesaw` for x86-64).
// An ARM1176 and a JZ4770 count as a Cortex-A7: 1,015 and 984 clocks a triangle of seesaw, its vertices included. A
// byte by radio takes 1,096 nJ: receiving by Wi-Fi takes a phone 137 mW for each Mbit/s [Huang et al. 2012, "A Close
// Examination of Performance and Power Characteristics of 4G LTE Networks", table 4].
struct Device {
  const char* name = nullptr;         // as on the command line
  const char* description = nullptr;  // one line
  const char* cpu_class = nullptr;    // build to use: a class of devices/README.md, or x86-64
  int screen_width = 320, screen_height = 240;
  int bits_per_pixel = 0;
  const char* channel_order = "rgb";  // rgb: red in the highest bits; bgr: blue. The driver's report overrides it.
  int rotation = 0;                   // degrees clockwise to turn a picture on the screen so that it is upright
  std::size_t memory_bytes = 0;       // default of the memory block: half of Linux's memory, at most 512 MiB
  // Key codes of up, down, left, right, A, B, X, Y, L, R, start, select; null: those of a keyboard.
  const std::uint16_t* keys = nullptr;

  // For emulation on a desktop.
  int core_count = 0;   // of its CPU; 0: as many as this machine has
  double slowdown = 0;  // time per pixel on one core relative to one x86-64 core, with the same program
  std::uint64_t link_bytes_per_second = 0;  // each way, TCP payload
  std::uint64_t link_latency_ns = 0;        // one way
  std::uint64_t link_jitter_ns = 0;         // maximum addition to the latency

  // Time to decode rows of a render server on one core, for emulation: per pixel and per byte of code.
  double decode_pixel_ns = 0, decode_byte_ns = 0;
  // Time to prepare a frame of a moving scene on one core: per triangle and per vertex that move (prepare_cost.h).
  double prepare_triangle_ns = 0, prepare_vertex_ns = 0;

  // Energy beyond that of the idle device, for the fronts of split-report.
  double core_watts = 0;       // of one busy core
  double byte_nanojoules = 0;  // to receive a byte
};

constexpr double kRadioNanojoules = 1096;
constexpr std::uint64_t microseconds(std::uint64_t count) { return count * 1000; }
constexpr std::size_t mebibytes(std::size_t count) { return count << 20; }

}  // namespace platform
