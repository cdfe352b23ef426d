// The source of a list of spans: a whole frame, bands of one with progress, or the pixels that have changed.
#pragma once
#include "engine/renderer.h"
#include "engine/span_source.h"

namespace pocketray {

// Spans in any order; those of neighbouring rows next to one another, rows from the top, are traced fastest. None may
// occur twice. The caller's, as is what they cost.
struct SpanList {
  const Span* spans = nullptr;
  std::uint32_t span_count = 0;
  std::uint64_t* span_ns = nullptr;                                     // null: not measured
  std::uint32_t batch_spans = ~0u;                                      // handed out at once, at most
  void (*progress)(void* context, std::uint32_t done_count) = nullptr;  // after each batch; null: not told
  void* progress_context = nullptr;

  std::uint32_t done_count = 0;  // spans traced so far: the first ones
};

// The list stays the caller's and must outlive the source.
SpanSource list_source(SpanList* list);

// All of the renderer's spans: one per scanline, timed in row_ns.
SpanList whole_frame(Renderer* renderer);
// The same in bands of rows, each as high as keeps all threads busy.
SpanList row_bands(Renderer* renderer);

// Divides pixels [begin, end) of a row into `part_count` spans of about the same length, one at least. No span is empty
// where there are as many pixels.
void divide_row(std::uint32_t row, std::uint32_t begin, std::uint32_t end, std::uint32_t part_count, Span* spans);

}  // namespace pocketray
