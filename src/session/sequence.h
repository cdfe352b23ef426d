// Sequences of frames, as --frames names them.
#pragma once
#include <cstdint>
#include <string>

#include "base/status.h"

namespace pocketray {

struct FrameRange {
  std::uint32_t first = 0, last = 0;  // both included
  bool given = false;                 // by --frames
};

// Parses --frames, "0:350". Empty text leaves *range as it is.
Status parse_frames(const std::string& text, FrameRange* range);

}  // namespace pocketray
