#include "engine/trace_with.h"

#include <algorithm>
#include <mutex>

#include "base/check.h"
#include "shade/strip.h"

namespace pocketray {
namespace {

// Maximum number of spans of a strip that may be divided. Chosen: 3 KiB of a thread's stack. Larger strips are ragged,
// as after a small change.
constexpr std::uint32_t kDividedSpansMax = 512;

// Spans that a thread takes at once, or one part of them, split by columns.
struct SpanGroup {
  std::uint32_t begin, count;
  std::uint32_t part = 0, part_count = 1;
  std::uint32_t column_begin = 0, column_end = 0;  // of all parts
  std::uint32_t side = 1;                          // a part's width is a multiple of this many columns
};

struct SpanQueue {
  const TraceJob& job;
  std::uint32_t thread_count;
  std::mutex mutex;  // protects the members below
  std::uint32_t next_span = 0;
  SpanGroup last = {0, 0};  // the last one taken; its remaining parts come next
  bool errand_waits = job.errand.run != nullptr;
};

// Divides a strip of tiles into about `wanted` parts: whole packets if there is one for each thread.
void divide(const Span* spans, std::uint32_t wanted, std::uint32_t thread_count, SpanGroup* group) {
  std::uint32_t begin = ~0u, end = 0, row_end = 0;
  for (std::uint32_t i = 0; i < group->count; ++i) {
    begin = std::min<std::uint32_t>(begin, spans[i].column_begin);
    end = std::max<std::uint32_t>(end, spans[i].column_end);
    row_end = std::max<std::uint32_t>(row_end, spans[i].row + 1);
  }
  if (begin >= end) return;
  const std::uint32_t columns = end - begin, packet = packet_columns(row_end - spans[0].row);
  const std::uint32_t parts_max = std::max(columns / packet, std::min(columns, thread_count));
  group->part_count = std::max(1u, std::min(parts_max, wanted));
  group->column_begin = begin, group->column_end = end;
  if (group->part_count * packet <= columns) group->side = packet;
}

std::uint32_t column_of(const SpanGroup& group, std::uint32_t part) {
  CHECK_LE(part, group.part_count);
  if (part == group.part_count) return group.column_end;
  const std::uint32_t columns = group.column_end - group.column_begin;
  return group.column_begin + columns * part / group.part_count / group.side * group.side;
}

// Returns the queue's next spans: a strip of tiles, towards the end in parts so that all threads finish together. Parts
// are columns of the strip, since tiles of fewer rows would cost more per pixel.
SpanGroup next_spans(const SpanQueue& queue) {
  const TraceJob& job = queue.job;
  const std::uint32_t left = job.span_count - queue.next_span;
  const Span* spans = job.spans + queue.next_span;
  if (job.spans_at_once) return {queue.next_span, std::min(job.spans_at_once, left)};
  SpanGroup group = {queue.next_span, strip_span_count(spans, left)};
  if (queue.thread_count == 1 || group.count > kDividedSpansMax) return group;
  divide(spans, (group.count * 2 * queue.thread_count + left - 1) / left, queue.thread_count, &group);
  return group;
}

// Returns false if no group is left, or the job was stopped. Strips that were begun are completed.
bool take_group(SpanQueue* queue, SpanGroup* group) {
  const TraceJob& job = queue->job;
  SpanGroup* last = &queue->last;
  if (last->count == 0 || ++last->part == last->part_count) {
    if (queue->next_span == job.span_count) return *last = {0, 0}, false;
    if (job.stop && job.stop->load(std::memory_order_relaxed)) return *last = {0, 0}, false;
    *last = next_spans(*queue);
    queue->next_span += last->count;
    if (job.span_ns) std::fill_n(job.span_ns + last->begin, last->count, 0);
  }
  *group = *last;
  return true;
}

void trace_group(const TraceJob& job, std::uint32_t thread, const SpanGroup& group) {
  const Span* spans = job.spans + group.begin;
  Span clipped[kDividedSpansMax];
  std::uint32_t count = group.count;
  if (group.part_count > 1) {
    const std::uint32_t begin = column_of(group, group.part), end = column_of(group, group.part + 1);
    count = 0;
    for (std::uint32_t i = 0; i < group.count; ++i) {
      Span span = spans[i];
      span.column_begin = static_cast<std::uint16_t>(std::max<std::uint32_t>(span.column_begin, begin));
      span.column_end = static_cast<std::uint16_t>(std::min<std::uint32_t>(span.column_end, end));
      if (span.column_begin < span.column_end) clipped[count++] = span;
    }
    spans = clipped;
  }
  trace_spans(&job.tracers[thread], spans, count, job.aov, job.image, job.pitch);
}

void take_spans(void* context, std::uint32_t thread) {
  SpanQueue* queue = static_cast<SpanQueue*>(context);
  const TraceJob& job = queue->job;
  std::unique_lock<std::mutex> lock(queue->mutex);
  if (queue->errand_waits) {
    queue->errand_waits = false;
    lock.unlock();
    job.errand.run(job.errand.context);
    lock.lock();
  }
  for (SpanGroup group; take_group(queue, &group);) {
    lock.unlock();
    const std::uint64_t start = job.span_ns ? clock_ns() : 0;
    trace_group(job, thread, group);
    const std::uint64_t each = job.span_ns ? (clock_ns() - start) / group.count : 0;
    lock.lock();
    for (std::uint32_t i = 0; job.span_ns && i < group.count; ++i) job.span_ns[group.begin + i] += each;
  }
}

}  // namespace

std::uint32_t trace_with(Workers* w, const TraceJob& job) {
  CHECK(job.span_count == 0 || (job.spans != nullptr && job.image != nullptr));
  CHECK(job.tracers != nullptr);
  SpanQueue queue{job, worker_thread_count(w)};
  run_with(w, take_spans, &queue);
  CHECK_LE(queue.next_span, job.span_count);
  return queue.next_span;  // all that were taken are done
}

}  // namespace pocketray
