#pragma once
#include "platform/devices/device.h"

namespace platform {

// Any PC on Ethernet of 1 Gbit/s: 941 Mbit/s by iperf3 (mpr-projects.com, "RPi NAS: Part 3 Network Connections",
// 2023). A window of the handhelds' size, and enough memory for every scene.
// Energy: guesses.
constexpr Device kDesktop = [] {
  Device d;
  d.name = "desktop";
  d.description = "A PC with a window or a framebuffer";
  d.cpu_class = "x86-64";
  d.bits_per_pixel = 32;
  d.memory_bytes = mebibytes(512);
  d.slowdown = 1;
  d.link_bytes_per_second = 117'500'000;
  d.link_latency_ns = microseconds(100);
  d.decode_pixel_ns = 1.1;
  d.decode_byte_ns = 92;
  d.prepare_triangle_ns = 75;
  d.prepare_vertex_ns = 24;
  d.core_watts = 10;
  d.byte_nanojoules = 10;
  return d;
}();

}  // namespace platform
