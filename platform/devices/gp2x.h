#pragma once
#include "platform/devices/device.h"

namespace platform {

// MagicEyes MMSP2: ARM920T at 200 MHz without FPU, 64 MiB, 32 of which the stock firmware leaves to Linux; LCD 320 ×
// 240 RGB565. Shown in [Aranha07] fig. 1. Its ARMv4T core is older than Debian's armel (ARMv5TE) and needs its own
// compiler. The stock kernel 2.4 has the stick at /dev/GPIO; third-party 2.6 kernels have evdev. CPU: the clocks of the
// armel build; its caches have 16 KiB each, less than a scene. Link: it has no radio, but can be a USB network card.
// USB 1.1 carries at most 19 packets of 64 bytes per millisecond (USB 2.0 specification, sec. 5.8.4), 1.2 MB/s, of
// which headers and host leave about 1. Its successor, the Wiz, answers a ping with the same Linux driver in 0.98 ms
// (gp32x.com, topic 50468, 2009).
// Energy: ARM920T, 560 mW at 200 MHz in 0.25 µm [Furber 2000, "ARM System-on-Chip Architecture", table 12.5], of which
// this chip is a shrink; a guess of 10 mA at 3.3 V for USB while it carries 1 MB/s.
constexpr Device kGp2x = [] {
  Device d;
  d.name = "gp2x";
  d.description = "GamePark GP2X: ARM920T 200 MHz, no FPU";
  d.cpu_class = "armv4t";
  d.bits_per_pixel = 16;
  d.memory_bytes = mebibytes(16);
  d.core_count = 1;
  d.slowdown = 466;
  d.link_bytes_per_second = 1'000'000;
  d.link_latency_ns = microseconds(500);
  d.link_jitter_ns = microseconds(500);
  d.decode_pixel_ns = 175;
  d.decode_byte_ns = 4500;
  d.prepare_triangle_ns = 15'500;
  d.prepare_vertex_ns = 27'000;
  d.core_watts = 0.56;
  d.byte_nanojoules = 33;
  return d;
}();

}  // namespace platform
