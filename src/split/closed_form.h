// The cost function of [Aranha07] sec. 3.3 in closed form: one device, one server, a mean cost per pixel.
#pragma once

namespace pocketray {

// Nanoseconds per pixel: rendered on the device (T_m), rendered on the server (T_s), transferred (T_t).
struct PixelTimes {
  double device_ns = 0, server_ns = 0, transfer_ns = 0;
};

struct ClosedSplit {
  double device_share;  // m, in [0, 1]
  double ns_per_pixel;  // average over the frame, finite
};

// Device and server finish together if m·T_m = (1 − m)·(T_s + T_t): m = (T_s + T_t) / (T_m + T_s + T_t).
// With invalid times (NaN, infinite, negative, above kPixelNsMax) the device does everything; its own time, if invalid,
// counts as 0 or kPixelNsMax.
ClosedSplit closed_form_split(const PixelTimes& times);

// Cost function if the server sends pixels while it renders others, which takes max(T_s, T_t) instead of the sum.
ClosedSplit overlapped_split(const PixelTimes& times);

constexpr double kPixelNsMax = 1e12;  // about a quarter of an hour per pixel; chosen: longer is no measurement

}  // namespace pocketray
