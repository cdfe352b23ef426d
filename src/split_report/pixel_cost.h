// What a pixel costs on this machine, for devices that are simulated by it.
#pragma once
#include "engine/renderer.h"

namespace pocketray {

// Of the first frame, on one thread: the median of a few.
Status measure_pixel_ns(Renderer* renderer, double* ns);

// The same of frames shared by effect, as the device has them: with its own indirect light, and to add that of a map
// with a light every `pitch` pixels. 0: frames of the renderer's settings cannot be shared so. The settings are
// restored.
Status measure_own_light_ns(Renderer* renderer, std::uint32_t pitch, double* ns);

}  // namespace pocketray
