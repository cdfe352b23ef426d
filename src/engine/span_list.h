// Span sources made from a list of spans: a whole frame, bands with progress, or the changed pixels.
#pragma once
#include "engine/span_source.h"

namespace pocketray {

struct Renderer;

// Spans in any order, none twice; fastest if spans of neighbouring rows are adjacent, from the top. The caller owns the
// spans and their costs.
struct SpanList {
  const Span* spans = nullptr;
  std::uint32_t span_count = 0;
  std::uint64_t* span_ns = nullptr;                                     // null: not measured
  std::uint32_t batch_spans = ~0u;                                      // maximum per batch
  void (*progress)(void* context, std::uint32_t done_count) = nullptr;  // called after each batch; null: none
  void* progress_context = nullptr;

  std::uint32_t done_count = 0;  // spans traced so far, from the front
};

// The caller owns the list, which must outlive the source.
SpanSource list_source(SpanList* list);

// All spans of the renderer: one per scanline, timed in row_ns.
SpanList whole_frame(Renderer* renderer);
// All spans in bands of rows, each just high enough to keep all threads busy.
SpanList row_bands(Renderer* renderer);

// Pixels [begin, end) of a row.
Span row_span(std::uint32_t row, std::uint32_t begin, std::uint32_t end);

}  // namespace pocketray
