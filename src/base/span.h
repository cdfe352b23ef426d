// Span: the unit of work. A run of pixels on one scanline; a frame is a list of spans.
#pragma once
#include <cstdint>

namespace pocketray {

struct Span {
  std::uint16_t row, column_begin, column_end;  // pixels; end is exclusive
};

// Rows of a picture; end is exclusive.
struct RowRange {
  std::uint32_t begin, end;
};

}  // namespace pocketray
