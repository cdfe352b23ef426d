#pragma once
#include "platform/devices/opendingux.h"

namespace platform {

// Anbernic RG350 with OpenDingux: Ingenic JZ4770, a MIPS32 with FPU at up to 996 MHz unless overclocked, 512 MiB (the
// kernel's gcw0-base.dtsi, as for the keys); LCD 320 × 240, with 32 bits per pixel in the frame buffer. The GCW Zero
// and the RG280 do not differ in any relevant respect. CPU: the mips32 build.
// Link: it has no radio; through a USB stick for 802.11n with one antenna 37 Mbit/s, see miyoo_mini.h. Latency and
// jitter are guesses.
// Energy: a guess: as much per MHz as the ARM1176 of pi_zero.h.
constexpr Device kRg350 = [] {
  Device d;
  d.name = "rg350";
  d.description = "Anbernic RG350: JZ4770, MIPS32 996 MHz";
  d.cpu_class = "mips32";
  d.bits_per_pixel = 32;
  d.memory_bytes = mebibytes(256);
  d.keys = kOpenDinguxKeys;
  d.core_count = 1;
  d.slowdown = 40;
  d.link_bytes_per_second = 4'625'000;
  d.link_latency_ns = microseconds(1500);
  d.link_jitter_ns = microseconds(2000);
  d.decode_pixel_ns = 35;
  d.decode_byte_ns = 900;
  d.prepare_triangle_ns = 800;
  d.prepare_vertex_ns = 350;
  d.core_watts = 0.2;
  d.byte_nanojoules = kRadioNanojoules;
  return d;
}();

}  // namespace platform
