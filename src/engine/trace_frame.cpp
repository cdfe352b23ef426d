#include "engine/trace_frame.h"

#include "base/check.h"
#include "engine/frame.h"
#include "engine/trace_with.h"

namespace pocketray {
namespace {

std::uint64_t now_ns(const Renderer& renderer, const SpanSource& source) {
  return source.now_ns ? source.now_ns(source.context) : renderer.pace.clock->now_ns();
}

// Waits until the batch, begun at `begin_ns`, has taken as long as on the emulated device; returns that time.
std::uint64_t keep_pace(Renderer* renderer, const SpanSource& source, const SpanBatch& batch, std::uint64_t begin_ns) {
  if (is_paced(renderer->pace)) {
    std::uint64_t pixel_count = span_pixel_count(batch.spans, batch.done_count);
    if (batch.span_ns)
      pace_spans(renderer->pace, batch.spans, batch.done_count, worker_thread_count(renderer->workers), batch.span_ns);
    wait_for_pace(&renderer->pace, pixel_count, begin_ns, source.stop);
  }
  return renderer->pace.clock->now_ns() - begin_ns;
}

void trace_batch(Renderer* renderer, const SpanSource& source, SpanBatch* batch) {
  CHECK_LE(worker_thread_count(renderer->workers), renderer->tracers.count);
  CHECK(batch->spans != nullptr);
  if (!is_followed(renderer->history)) forget_last_frame(&renderer->history);
  std::uint64_t begin_ns = now_ns(*renderer, source);
  batch->done_count =
      trace_with(renderer->workers, {batch->spans, batch->span_count, source.aov, renderer->image.data,
                                     renderer->tracers.data, batch->span_ns, batch->stoppable ? source.stop : nullptr,
                                     batch->pitch, batch->spans_at_once, batch->errand});
  CHECK(batch->done_count == batch->span_count || batch->stoppable);
  CHECK_LE(batch->done_count, batch->span_count);
  if (source.pack) source.pack(source.context, *batch);
  batch->took_ns =
      source.pace ? source.pace(source.context, *batch, begin_ns) : keep_pace(renderer, source, *batch, begin_ns);
}

bool trace_batches(Renderer* renderer, const SpanSource& source) {
  do {
    if (source.stop && source.stop->load(std::memory_order_relaxed)) return false;
    SpanBatch batch;
    source.next(source.context, &batch);
    if (batch.span_count > 0) trace_batch(renderer, source, &batch);
    if (source.finished(source.context, batch)) return true;
    if (source.poll) source.poll(source.context, batch);
  } while (source.deadline_ns == kNoDeadline || now_ns(*renderer, source) < source.deadline_ns);
  return false;
}

}  // namespace

bool trace_frame(Renderer* renderer, const SpanSource& source) {
  CHECK(!source.pace == !source.now_ns);
  CHECK(source.next != nullptr && source.finished != nullptr);
  History* history = &renderer->history;
  const Clock& clock = *renderer->pace.clock;
  const std::uint64_t start = clock.now_ns();
  const bool complete = trace_batches(renderer, source);
  history->spent_ns += clock.now_ns() - start;
  if (complete && history->purpose == FramePurpose::changes) {
    history->is_complete = true;
    end_frame(renderer);
  }
  renderer->timings.trace_ms = static_cast<double>(history->spent_ns) * 1e-6;
  return complete;
}

}  // namespace pocketray
