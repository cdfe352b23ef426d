#include "engine/span_list.h"

#include <algorithm>

#include "base/check.h"
#include "engine/renderer.h"

namespace pocketray {
namespace {

void next_spans(void* context, SpanBatch* batch) {
  const SpanList& list = *static_cast<const SpanList*>(context);
  CHECK_LE(list.done_count, list.span_count);
  batch->spans = list.spans + list.done_count;
  batch->span_count = std::min(list.batch_spans, list.span_count - list.done_count);
  batch->span_ns = list.span_ns ? list.span_ns + list.done_count : nullptr;
  batch->stoppable = true;
}

bool finish_spans(void* context, const SpanBatch& batch) {
  SpanList* list = static_cast<SpanList*>(context);
  list->done_count += batch.done_count;
  CHECK_LE(list->done_count, list->span_count);
  if (list->progress) list->progress(list->progress_context, list->done_count);
  return list->done_count == list->span_count;
}

}  // namespace

SpanSource list_source(SpanList* list) {
  CHECK_LT(0u, list->batch_spans);
  CHECK(list->spans != nullptr || list->span_count == 0);
  return {list, next_spans, finish_spans};
}

SpanList whole_frame(Renderer* renderer) {
  SpanList list;
  list.spans = renderer->spans.data;
  list.span_count = static_cast<std::uint32_t>(renderer->spans.count);
  list.span_ns = renderer->row_ns.data;
  return list;
}

SpanList row_bands(Renderer* renderer) {
  CHECK_GE(renderer->settings.threads, 1u);
  SpanList list = whole_frame(renderer);
  list.batch_spans = 4 * kTileRows * renderer->settings.threads;
  return list;
}

Span row_span(std::uint32_t row, std::uint32_t begin, std::uint32_t end) {
  CHECK_LE(begin, end);
  CHECK(row < kImageSideMax && end <= kImageSideMax);  // a span's numbers are 16 bits wide
  return {static_cast<std::uint16_t>(row), static_cast<std::uint16_t>(begin), static_cast<std::uint16_t>(end)};
}

}  // namespace pocketray
