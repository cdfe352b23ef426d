#include "engine/progressive.h"

#include <algorithm>

#include "base/check.h"
#include "engine/trace_frame.h"

namespace pocketray {
namespace {

constexpr std::uint32_t kChunk = 32;  // pixels per span on the finest grid

// The pixels of a row that are on this grid but on no coarser one, as spans.
std::uint32_t list_row(const Settings& settings, std::uint32_t row, std::uint32_t step, Array<Span> spans) {
  std::uint32_t count = 0;
  auto y = static_cast<std::uint16_t>(row);
  bool coarser_row = step < kCoarsestStep && row % (2 * step) == 0;
  if (step == 1 && !coarser_row) {
    for (std::uint32_t x = 0; x < settings.width; x += kChunk)
      spans[count++] = {y, static_cast<std::uint16_t>(x),
                        static_cast<std::uint16_t>(std::min(x + kChunk, settings.width))};
    return count;
  }
  std::uint32_t first = coarser_row ? step : 0, stride = coarser_row ? 2 * step : step;
  for (std::uint32_t x = first; x < settings.width; x += stride)
    spans[count++] = {y, static_cast<std::uint16_t>(x), static_cast<std::uint16_t>(x + 1)};
  return count;
}

struct Refinement {
  Renderer* renderer;
  Array<Span> row_spans;
  Progressive* progressive;
};

void next_row(void* context, SpanBatch* batch) {
  const Refinement& r = *static_cast<Refinement*>(context);
  batch->spans = r.row_spans.data;
  batch->span_count = list_row(r.renderer->settings, r.progressive->row, r.progressive->step, r.row_spans);
  CHECK_LE(batch->span_count, r.row_spans.count);
}

// Copies each traced pixel to its whole cell.
void fill_cells(void* context, const SpanBatch& batch) {
  const Renderer& renderer = *static_cast<Refinement*>(context)->renderer;
  const std::uint32_t step = static_cast<Refinement*>(context)->progressive->step;
  if (step == 1) return;
  const Settings& settings = renderer.settings;
  for (std::uint32_t i = 0; i < batch.span_count; ++i) {
    Span span = batch.spans[i];
    Vec3 value = renderer.image[static_cast<std::size_t>(span.row) * settings.width + span.column_begin];
    std::uint32_t bottom = std::min(span.row + step, settings.height),
                  right = std::min(span.column_begin + step, settings.width);
    for (std::uint32_t y = span.row; y < bottom; ++y)
      for (std::uint32_t x = span.column_begin; x < right; ++x)
        renderer.image[static_cast<std::size_t>(y) * settings.width + x] = value;
  }
}

bool finish_row(void* context, const SpanBatch& batch) {
  const Refinement& r = *static_cast<Refinement*>(context);
  Progressive* progressive = r.progressive;
  const std::uint32_t height = r.renderer->settings.height;
  CHECK_GT(progressive->step, 0u);
  progressive->pixels_traced += span_pixel_count(batch.spans, batch.span_count);
  progressive->trace_ns += batch.took_ns;
  if (progressive->dirty_begin == progressive->dirty_end) progressive->dirty_begin = progressive->row;
  progressive->dirty_begin = std::min(progressive->dirty_begin, progressive->row);
  progressive->dirty_end = std::max(progressive->dirty_end, std::min(progressive->row + progressive->step, height));
  progressive->row += progressive->step;
  if (progressive->row >= height) {
    progressive->row = 0;
    progressive->shown_coarse = true;
    progressive->step /= 2;
  }
  return progressive->step == 0;
}

}  // namespace

bool advance_progressive(Renderer* renderer, Array<Span> row_spans, std::uint64_t deadline_ns,
                         Progressive* progressive) {
  CHECK_GE(row_spans.count, renderer->settings.width);
  if (progressive->step == 0) return true;
  CHECK_LE(progressive->step, kCoarsestStep);
  CHECK_LT(progressive->row, renderer->settings.height);
  Refinement refinement = {renderer, row_spans, progressive};
  SpanSource source = {&refinement, next_row, finish_row, fill_cells};
  source.deadline_ns = deadline_ns;
  source.is_coherent = progressive->is_coherent;
  return trace_frame(renderer, source);
}

bool take_dirty_rows(Progressive* progressive, std::uint32_t* begin, std::uint32_t* end) {
  CHECK(begin != nullptr && end != nullptr);
  if (progressive->dirty_begin >= progressive->dirty_end) return false;
  *begin = progressive->dirty_begin;
  *end = progressive->dirty_end;
  progressive->dirty_begin = progressive->dirty_end = 0;
  return true;
}

}  // namespace pocketray
