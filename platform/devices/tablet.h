#pragma once
#include "platform/devices/device.h"

namespace platform {

// The client measured in [Aranha07] sec. 4: a tablet PC, Pentium M at 1 GHz, 502 MB, rendering at 320 × 240.
// The paper gives neither the depth nor the channel order of its screen: a PC's.
// CPU: table 1, Cornell box: 8841 ns per pixel against 989 on two cores of 3 GHz, 8841 / (2 × 989) for each of them.
// (The Buddha, 6688 and 520, gives 6.43; four and eight cores give less for both.) Link: 802.11g with 19 Mbit/s on
// average (sec. 4). At that rate its T_t of 400 ns carries 0.95 bytes: a pixel of four bytes compressed 4:1. Latency
// and jitter are guesses: the paper has none.
// Energy: the thermal design power of an ultra low voltage Pentium M at 1 GHz (Intel, "Pentium M Processor Datasheet",
// 252612), an upper bound.
constexpr Device kTablet = [] {
  Device d;
  d.name = "tablet";
  d.description = "The tablet PC of Aranha et al.: Pentium M 1 GHz";
  d.cpu_class = "x86-64";
  d.bits_per_pixel = 32;
  d.memory_bytes = mebibytes(251);
  d.core_count = 1;
  d.slowdown = 4.47;
  d.link_bytes_per_second = 2'375'000;
  d.link_latency_ns = microseconds(1500);
  d.link_jitter_ns = microseconds(1000);
  d.decode_pixel_ns = 5;
  d.decode_byte_ns = 410;
  d.prepare_triangle_ns = 335;
  d.prepare_vertex_ns = 107;
  d.core_watts = 7;
  d.byte_nanojoules = kRadioNanojoules;
  return d;
}();

}  // namespace platform
