// How much sooner ranks have a sequence of frames than one program, by costs measured here; see simulate_ranks.cpp.
#pragma once
#include <string>

#include "base/status.h"

namespace pocketray {

// Prints it for frames 0 … frame_count − 1 of a scene that moves. Writes a picture named `file` and removes it.
Status simulate_frames(const std::string& scene, std::uint32_t frame_count, const std::string& file);

}  // namespace pocketray
