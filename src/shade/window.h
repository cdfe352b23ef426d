// A thread's window of traced pixels: a row of tiles and the rows around it on which its pixels depend. Rows that the
// next row of tiles shares with it are kept, so that one thread traces each pixel once.
#pragma once
#include "base/arena.h"
#include "shade/frame_data.h"
#include "shade/strip.h"
#include "shade/tracer.h"

namespace pocketray {

// Rows around a row of tiles on which its pixels depend.
constexpr std::uint32_t kRowsAbove = 2, kRowsBelow = 1;
constexpr std::uint32_t kWindowRows = kRowsAbove + kTileSide + kRowsBelow;

constexpr std::uint32_t window_pixel_count(const Settings& settings) { return kWindowRows * settings.width; }
// Gives a tracer its window; its arrays have window_pixel_count() elements.
void keep_window(const PixelWindow& window, Tracer* tracer);

// State of a pixel in the window; pixels that are not traced are never wanted.
enum PixelState : std::uint8_t { kUnknown, kWanted, kKnown };

// A tracer's window, from which a row of tiles is built, and the columns in use.
struct OpenWindow {
  Tracer* tracer;
  PixelRows rows;
  std::uint8_t* states;
  std::uint32_t column_begin, column_end;

  const Settings& settings() const { return tracer->frame->settings; }
  std::uint8_t& state(std::uint32_t column, std::uint32_t row) const {
    return states[static_cast<std::size_t>(row - rows.first_row) * rows.width + column];
  }
};

// Opens the tracer's window around the tiles from `row` on. Rows shared with the previous window stay known.
OpenWindow open_window(Tracer* tracer, std::uint32_t row);
// Adds columns to those in use.
void want_columns(OpenWindow* window, std::uint32_t begin, std::uint32_t end);
// Traces the wanted pixels, with Kernels::trace_window_strip if there is one; afterwards they are known.
void trace_wanted(const OpenWindow& window);

}  // namespace pocketray
