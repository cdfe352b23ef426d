#include "session/sequence.h"

#include <cstdio>

#include "base/check.h"

namespace pocketray {

Status parse_frames(const std::string& text, FrameRange* range) {
  CHECK(range != nullptr);
  if (text.empty()) return success();
  int used = 0;
  range->given = true;
  bool plain = text.find_first_not_of("0123456789:") == std::string::npos;  // a sign would wrap around
  if (!plain || std::sscanf(text.c_str(), "%6u:%6u%n", &range->first, &range->last, &used) != 2 ||
      static_cast<std::size_t>(used) != text.size())
    return failure("--frames is '%s': write first:last, as 0:350", text.c_str());
  if (range->last < range->first)
    return failure("--frames is '%s': the last frame comes before the first", text.c_str());
  return success();
}

}  // namespace pocketray
