#include "engine/progressive.h"

#include <algorithm>

#include "base/check.h"

namespace pocketray {
namespace {

constexpr std::uint32_t kChunk = 32;  // pixels a thread takes at a time on the finest grid

// The pixels of a row that are on this grid and on no coarser one, as spans.
std::uint32_t list_row(const Settings& s, std::uint32_t row, std::uint32_t step, Array<Span> spans) {
  std::uint32_t count = 0;
  auto y = static_cast<std::uint16_t>(row);
  bool coarser_row = step < kCoarsestStep && row % (2 * step) == 0;
  if (step == 1 && !coarser_row) {
    for (std::uint32_t x = 0; x < s.width; x += kChunk)
      spans[count++] = {y, static_cast<std::uint16_t>(x), static_cast<std::uint16_t>(std::min(x + kChunk, s.width))};
    return count;
  }
  std::uint32_t first = coarser_row ? step : 0, stride = coarser_row ? 2 * step : step;
  for (std::uint32_t x = first; x < s.width; x += stride)
    spans[count++] = {y, static_cast<std::uint16_t>(x), static_cast<std::uint16_t>(x + 1)};
  return count;
}

// Spreads each traced pixel over its cell.
void fill_cells(Renderer* r, Array<Span> spans, std::uint32_t count, std::uint32_t step) {
  const Settings& s = r->settings;
  for (std::uint32_t i = 0; i < count; ++i) {
    Span span = spans[i];
    Vec3 value = r->image[static_cast<std::size_t>(span.row) * s.width + span.column_begin];
    std::uint32_t bottom = std::min(span.row + step, s.height), right = std::min(span.column_begin + step, s.width);
    for (std::uint32_t y = span.row; y < bottom; ++y)
      for (std::uint32_t x = span.column_begin; x < right; ++x)
        r->image[static_cast<std::size_t>(y) * s.width + x] = value;
  }
}

}  // namespace

void start_progressive(Renderer* r, Progressive* p) {
  *p = Progressive();
  for (Tracer& tracer : r->tracers) tracer = make_tracer(r->frame);
}

bool advance_progressive(Renderer* r, Array<Span> row_spans, std::uint64_t deadline_ns, Progressive* p) {
  CHECK_GE(row_spans.count, r->settings.width);
  while (p->step > 0) {
    std::uint64_t start = clock_ns();
    std::uint32_t count = list_row(r->settings, p->row, p->step, row_spans);
    trace_paced(&r->pace, r->workers,
                {row_spans.data, count, Aov::none, r->image.data, r->tracers.data, nullptr, nullptr});
    if (p->step > 1) fill_cells(r, row_spans, count, p->step);
    for (std::uint32_t i = 0; i < count; ++i) p->pixels_traced += row_spans[i].column_end - row_spans[i].column_begin;
    if (p->dirty_begin == p->dirty_end) p->dirty_begin = p->row;
    p->dirty_begin = std::min(p->dirty_begin, p->row);
    p->dirty_end = std::max(p->dirty_end, std::min(p->row + p->step, r->settings.height));
    p->row += p->step;
    if (p->row >= r->settings.height) {
      p->row = 0;
      p->shown_coarse = true;
      p->step /= 2;
    }
    std::uint64_t now = clock_ns();
    p->trace_ns += now - start;
    if (now >= deadline_ns) break;
  }
  return p->step == 0;
}

bool take_dirty_rows(Progressive* p, std::uint32_t* begin, std::uint32_t* end) {
  if (p->dirty_begin >= p->dirty_end) return false;
  *begin = p->dirty_begin;
  *end = p->dirty_end;
  p->dirty_begin = p->dirty_end = 0;
  return true;
}

}  // namespace pocketray
