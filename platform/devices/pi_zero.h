#pragma once
#include "platform/devices/device.h"

namespace platform {

// Broadcom BCM2835: ARM1176JZF-S at 1 GHz, 512 MiB (Raspberry Pi documentation). It has an FPU, but Debian's armhf is
// for ARMv7: the armv6 build uses the FPU with the libraries of armel. The screen is common in hobby cases: an ILI9341
// panel on SPI, 320 × 240 RGB565, driven by fbtft. CPU: the clocks of the armv6 build. Link: as in the Zero W, 802.11n
// at 2.4 GHz with one antenna: 37 Mbit/s, see miyoo_mini.h. Energy: the board takes 100 mA idle and 140 mA when pushed,
// at 5.09 V (raspi.tv, "Raspberry Pi Zero power measurements", 2015).
constexpr Device kPiZero = [] {
  Device d;
  d.name = "pi-zero";
  d.description = "Raspberry Pi Zero with an SPI panel: ARM1176 1 GHz";
  d.cpu_class = "armv6";
  d.bits_per_pixel = 16;
  d.memory_bytes = mebibytes(256);
  d.core_count = 1;
  d.slowdown = 32;
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
