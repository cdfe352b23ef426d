#include "shade/window.h"

#include <algorithm>

#include "base/check.h"
#include "shade/shared_pixels.h"
#include "shade/tile.h"

namespace pocketray {
namespace {

void trace_pixels(const OpenWindow& window, Tile* tile) {
  Tracer* tracer = window.tracer;
  const FrameData& frame = *tracer->frame;
  CHECK_LE(tile->count, kPacketMax);
  if (tile->count >= kPacketRaysMin && !frame.geometry.ray_by_ray && frame.view.camera.has_one_origin) {
    trace_tile(tracer, *tile, window.rows);
  } else {
    for (std::uint32_t i = 0; i < tile->count; ++i)
      window.rows.at(tile->column[i], tile->row[i]) = pixel_radiance(tracer, tile->column[i], tile->row[i]);
  }
  tile->count = 0;
}

// Calls visit(column, row) for the wanted pixels in the range, and marks them as known.
template <typename Visit>
void take_wanted(const OpenWindow& window, std::uint32_t column_begin, std::uint32_t column_end,
                 std::uint32_t row_begin, std::uint32_t row_end, Visit visit) {
  for (std::uint32_t row = row_begin; row < row_end; ++row)
    for (std::uint32_t column = column_begin; column < column_end; ++column) {
      std::uint8_t& state = window.state(column, row);
      if (state != kWanted) continue;
      state = kKnown;
      visit(column, row);
    }
}

// Rows of the picture in the window.
std::uint32_t window_begin(const OpenWindow& window) {
  return window.tracer->window.row - std::min(window.tracer->window.row, kRowsAbove);
}
std::uint32_t window_end(const OpenWindow& window) {
  return std::min(window.rows.first_row + kWindowRows, window.settings().height);
}

// Traces in packets of neighbours.
void trace_packets(const OpenWindow& window) {
  Tile tile;
  for (std::uint32_t column = window.column_begin; column < window.column_end; column += kTileSide)
    take_wanted(window, column, std::min(column + kTileSide, window.column_end), window_begin(window),
                window_end(window), [&](std::uint32_t x, std::uint32_t y) {
                  add_pixel(x, y, &tile);
                  if (tile.count == kPacketMax) trace_pixels(window, &tile);
                });
  trace_pixels(window, &tile);
}

// Traces with the frame's strip function, a row of tiles at a time.
void trace_strips(const OpenWindow& window) {
  const std::uint32_t end = window_end(window), left = window.column_begin / kTileSide * kTileSide;
  for (std::uint32_t row = window_begin(window), next; row < end; row = next) {
    next = std::min((row / kTileSide + 1) * kTileSide, end);
    TileStrip strip;
    strip.row = row / kTileSide * kTileSide, strip.column = left, strip.row_count = kTileSide;
    strip.tile_count = (window.column_end - left + kTileSide - 1) / kTileSide;
    std::fill_n(strip.mask, strip.tile_count, 0);
    bool any = false;
    take_wanted(window, window.column_begin, window.column_end, row, next, [&](std::uint32_t x, std::uint32_t y) {
      strip.mask[(x - left) / kTileSide] |= std::uint64_t(1) << morton_place(x % kTileSide, y % kTileSide);
      any = true;
    });
    if (any) window.tracer->frame->kernels.trace_window_strip(window.tracer, strip, window.rows);
  }
}

}  // namespace

void keep_window(const PixelWindow& window, Tracer* tracer) {
  CHECK(tracer->frame != nullptr);
  CHECK_GE(window.pixels.count, window_pixel_count(tracer->frame->settings));
  CHECK_EQ(window.pixels.count, window.states.count);
  CHECK(window.shared.empty() || window.shared.count == window.pixels.count);
  tracer->window = window;
}

OpenWindow open_window(Tracer* tracer, std::uint32_t row) {
  PixelWindow& kept = tracer->window;
  CHECK_EQ(row % kTileSide, 0u);
  const std::uint32_t width = tracer->frame->settings.width;
  CHECK_GE(kept.pixels.count, kWindowRows * width);
  CHECK_EQ(kept.pixels.count, kept.states.count);
  if (kept.row != row) {
    std::uint32_t known = 0;
    if (kept.row + kTileSide == row) {
      known = kWindowRows - kTileSide;
      std::copy_n(kept.pixels.data + kTileSide * width, known * width, kept.pixels.data);
      std::copy_n(kept.states.data + kTileSide * width, known * width, kept.states.data);
      if (kept.shared.count) std::copy_n(kept.shared.data + kTileSide * width, known * width, kept.shared.data);
    }
    std::fill(kept.states.data + known * width, kept.states.data + kWindowRows * width, kUnknown);
    kept.row = row;
  }
  return {tracer, {kept.pixels.data, width, row - kRowsAbove}, kept.states.data, width, 0};
}

void want_columns(OpenWindow* window, std::uint32_t begin, std::uint32_t end) {
  CHECK(begin < end && end <= window->rows.width);
  window->column_begin = std::min(window->column_begin, begin);
  window->column_end = std::max(window->column_end, end);
}

void trace_wanted(const OpenWindow& window) {
  if (window.column_begin >= window.column_end) return;
  window.tracer->frame->kernels.trace_window_strip ? trace_strips(window) : trace_packets(window);
}

}  // namespace pocketray
