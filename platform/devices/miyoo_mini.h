#pragma once
#include "platform/devices/device.h"

namespace platform {

// The stock firmware's layout: A Space, B Ctrl, X Shift, Y Alt, L E, R T, select right Ctrl; the menu key is Esc.
constexpr std::uint16_t kMiyooMiniKeys[] = {key::kUp,    key::kDown,        key::kLeft,      key::kRight,
                                            key::kSpace, key::kLeftControl, key::kLeftShift, key::kLeftAlt,
                                            key::kE,     key::kT,           key::kEnter,     key::kRightControl};

// SigmaStar SSD202D: two Cortex-A7 at 1.2 GHz with NEON, 128 MiB in the package; LCD 640 × 480, 32 bits, mounted upside
// down (its SDL port turns every frame by 180 degrees).
// CPU: the armhf build.
// Link: as in the Miyoo Mini Plus, 802.11n at 2.4 GHz with one antenna: 37 Mbit/s, typical of its kind in a channel of
// 20 MHz, out of at most 50 (tanaza.com, "Bitrate, throughput, bandwidth", 2014). Latency and jitter are guesses.
// Energy: a board with one Cortex-A7 at 528 MHz takes 200 mW more under a stress test than idle (wiki.dave.eu, "Power
// consumption (SBC Lynx)", 2016), memory included; here in proportion to the clock.
constexpr Device kMiyooMini = [] {
  Device d;
  d.name = "miyoo-mini";
  d.description = "Miyoo Mini: two Cortex-A7 1.2 GHz, NEON";
  d.cpu_class = "armhf";
  d.screen_width = 640;
  d.screen_height = 480;
  d.bits_per_pixel = 32;
  d.rotation = 180;
  d.memory_bytes = mebibytes(64);
  d.keys = kMiyooMiniKeys;
  d.core_count = 2;
  d.slowdown = 14;
  d.link_bytes_per_second = 4'625'000;
  d.link_latency_ns = microseconds(1500);
  d.link_jitter_ns = microseconds(2000);
  d.decode_pixel_ns = 20;
  d.decode_byte_ns = 725;
  d.prepare_triangle_ns = 670;
  d.prepare_vertex_ns = 290;
  d.core_watts = 0.45;
  d.byte_nanojoules = kRadioNanojoules;
  return d;
}();

}  // namespace platform
