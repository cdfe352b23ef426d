#pragma once
#include "platform/devices/opendingux.h"

namespace platform {

// Allwinner F1C100s: ARM926EJ-S, 32 MiB in the package (F1C100s datasheet, ch. 1); LCD 320 × 240 RGB565. 408 MHz and
// up. Also covers BittBoy, PocketGo and PowKiddy V90. The MiyooCFW firmware has the keys of OpenDingux.
// CPU: the armel build at 408 MHz.
// Link: a USB stick for 802.11n with one antenna. 16 Mbit/s, from the 10 to 20 that consumer 802.11g and n devices
// reached in an office (web.luchs.at, "Using 802.11n and WPA2"): its CPU is as slow as theirs. Latency and jitter are
// guesses.
// Energy: a guess: as much per MHz as the ARM1176 of pi_zero.h.
constexpr Device kMiyoo = [] {
  Device d;
  d.name = "miyoo";
  d.description = "Miyoo and kin: F1C100s, ARM926EJ-S, no FPU";
  d.cpu_class = "armel";
  d.bits_per_pixel = 16;
  d.memory_bytes = mebibytes(16);
  d.keys = kOpenDinguxKeys;
  d.core_count = 1;
  d.slowdown = 228;
  d.link_bytes_per_second = 2'000'000;
  d.link_latency_ns = microseconds(1500);
  d.link_jitter_ns = microseconds(2000);
  d.decode_pixel_ns = 86;
  d.decode_byte_ns = 2200;
  d.prepare_triangle_ns = 7600;
  d.prepare_vertex_ns = 13'200;
  d.core_watts = 0.08;
  d.byte_nanojoules = kRadioNanojoules;
  return d;
}();

}  // namespace platform
