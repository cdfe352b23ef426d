// Sequences of frames, as given by --frames.
#pragma once
#include <cstdint>
#include <string>

#include "base/status.h"

namespace pocketray {

struct FrameRange {
  std::uint32_t first = 0, last = 0;  // both inclusive
  bool given = false;                 // by --frames
};

// Parses --frames, "0:350". Empty text leaves *range unchanged.
Status parse_frames(const std::string& text, FrameRange* range);

}  // namespace pocketray
