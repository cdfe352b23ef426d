// Coarse first, then refined: a frame traced on grids of 8, 4, 2 and 1 pixels. Each pixel is traced once and shows a
// coarser neighbour until then. The finished picture is that of render_frame(), bit for bit.
#pragma once
#include "engine/renderer.h"

namespace pocketray {

struct Progressive {
  std::uint32_t step = 8;  // of the grid being traced; 0: finished
  std::uint32_t row = 0;   // the next one on that grid
  bool shown_coarse = false;
  std::uint32_t dirty_begin = 0, dirty_end = 0;  // rows changed since take_dirty_rows()
  std::uint64_t pixels_traced = 0, trace_ns = 0;
  bool is_coherent = false;  // it completes a frame begun by begin_coherent()
};

constexpr std::uint32_t kCoarsestStep = 8;
// Bytes of the span list that advance_progressive() needs for one row.
inline std::size_t progressive_need(const Settings& settings) { return arena_need<Span>(settings.width); }

// Traces until about `deadline_ns` by the pace's clock, at least one row. True when the frame is finished. To begin a
// new frame, call prepare_frame() and pass a default Progressive.
bool advance_progressive(Renderer* renderer, Array<Span> row_spans, std::uint64_t deadline_ns,
                         Progressive* progressive);
// Rows changed since the last call.
bool take_dirty_rows(Progressive* progressive, std::uint32_t* begin, std::uint32_t* end);

}  // namespace pocketray
