// Cost of a pixel on this machine, for devices that it simulates.
#pragma once
#include "engine/renderer.h"

namespace pocketray {

// Measures the first frame on one thread: the shortest of several runs.
Status measure_pixel_ns(Renderer* renderer, double* ns);

// Measures frames shared by effect on the device: traced with its own indirect light, plus
// adding a map with a light every `pitch` pixels. 0: frames with the renderer's settings
// cannot be shared that way. The settings are restored.
Status measure_own_light_ns(Renderer* renderer, std::uint32_t pitch, double* ns);

}  // namespace pocketray
