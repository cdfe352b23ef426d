// Coarse first, then refined: every eighth pixel of every eighth row, each shown as a square, then the tiles of the
// whole picture. The finished picture is that of render_frame(), bit for bit.
//
// Neighbours in a tile share work, single pixels do not: a grid of 4 pixels would cost a thirteenth of the frame more,
// one of 8 costs a fiftieth to a thirtieth, and its pixels are traced again because a tile with a gap costs as much as
// a whole one. Where rays are traced one by one anyway, grids of 4 and 2 pixels come in between and each pixel is
// traced once.
#pragma once
#include "engine/renderer.h"

namespace pocketray {

constexpr std::uint32_t kCoarsestStep = 8;  // tests/progressive_cost measures its cost; see above

struct Progressive {
  std::uint32_t step = kCoarsestStep;  // of the grid being traced; 0: finished
  std::uint32_t row = 0, column = 0;   // of the next tile on that grid
  bool shown_coarse = false;
  std::uint32_t dirty_begin = 0, dirty_end = 0;  // rows changed since take_dirty_rows()
  std::uint64_t pixels_traced = 0;               // without repetitions
  std::uint64_t trace_ns = 0;
  bool is_afresh = false;           // no pixel of a coarser grid is in the picture
  std::uint64_t* row_ns = nullptr;  // receives the costs of the picture's rows, added; null: not wanted
};

// Traces the whole picture without a coarse preview.
inline Progressive afresh() {
  Progressive progressive;
  progressive.step = 1, progressive.shown_coarse = progressive.is_afresh = true;
  return progressive;
}

// Maximum number of spans that advance_progressive() needs room for.
std::uint32_t progressive_spans_max(const Settings& settings);
inline std::size_t progressive_need(const Settings& settings) {
  return arena_need<Span>(progressive_spans_max(settings));
}

// Traces until about `deadline_ns` by the pace's clock, at least a few tiles per thread. Returns true when the frame is
// finished. To begin a new frame, call begin_frame() and pass a default Progressive, or afresh().
bool advance_progressive(Renderer* renderer, Array<Span> tile_spans, std::uint64_t deadline_ns,
                         Progressive* progressive);
// Number of finished rows, from the top.
std::uint32_t finished_rows(const Renderer& renderer, const Progressive& progressive);
// Returns the rows changed since the last call; false: none.
bool take_dirty_rows(Progressive* progressive, std::uint32_t* begin, std::uint32_t* end);

}  // namespace pocketray
