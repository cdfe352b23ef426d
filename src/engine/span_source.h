// Span source: where a frame's spans come from. A source hands them out in batches and is told which are finished.
// Whatever a caller wants of a frame (all of it, coarse first, its share of the rows, what has moved) is a source;
// trace_frame() is the only loop over one.
#pragma once
#include <atomic>
#include <cstdint>

#include "shade/trace_spans.h"

namespace pocketray {

constexpr std::uint64_t kNoDeadline = ~std::uint64_t(0);

struct SpanBatch {
  const Span* spans = nullptr;       // the source's; must stay until the batch is finished
  std::uint32_t span_count = 0;      // 0: nothing can be traced now
  std::uint64_t* span_ns = nullptr;  // receives what each span costs; null: not measured
  bool stoppable = false;            // a stop may leave the last spans untraced; otherwise it waits for the batch

  // The loop's.
  std::uint32_t done_count = 0;  // spans traced: the first ones
  std::uint64_t took_ns = 0;     // by the source's clock: tracing, packing and what the pace adds
};

struct SpanSource {
  void* context;  // of the functions below, which run on the caller's thread
  // Fills in the next batch.
  void (*next)(void* context, SpanBatch* batch);
  // Takes note of a batch, whose pixels are in the image. True: the frame is complete.
  bool (*finished)(void* context, const SpanBatch& batch);
  // Makes pixels for showing of those just traced; counts as part of the batch's work. Null: nothing to do.
  void (*pack)(void* context, const SpanBatch& batch) = nullptr;

  Aov aov = Aov::none;
  std::uint64_t deadline_ns = kNoDeadline;  // by the source's clock; a call of trace_frame() traces one batch at least
  const std::atomic<bool>* stop = nullptr;  // set: no further batch

  // A clock of the source's own, and its pace: waits until work begun at `begin_ns` has lasted as long as on the
  // emulated device and returns how long that is. Null, both: the renderer's pace and its clock.
  std::uint64_t (*now_ns)(void* context) = nullptr;
  std::uint64_t (*pace)(void* context, const SpanBatch& batch, std::uint64_t begin_ns) = nullptr;
};

}  // namespace pocketray
