// A span source hands out a frame's spans in batches and is notified when they are finished. Whatever a caller wants of
// a frame (all of it, coarse first, its share of the rows, what has moved) is a source; trace_frame() is the only loop
// that runs it.
#pragma once
#include <atomic>
#include <cstdint>

#include "shade/trace_spans.h"

namespace pocketray {

constexpr std::uint64_t kNoDeadline = ~std::uint64_t(0);

// Work that one thread does while the others trace. It must not touch what they write.
struct Errand {
  void (*run)(void* context) = nullptr;  // null: none
  void* context = nullptr;
};

struct SpanBatch {
  const Span* spans = nullptr;       // owned by the source; must stay valid until the batch is finished
  std::uint32_t span_count = 0;      // 0: nothing to trace now
  std::uint64_t* span_ns = nullptr;  // receives the cost of each span; null: not measured
  std::uint32_t pitch = 1;           // of the pixel grid that the spans are on; trace_spans.h
  std::uint32_t spans_at_once = 0;   // per thread; 0: a strip of tiles, fewer towards the end
  Errand errand;                     // runs once alongside the spans; not if there are none
  bool stoppable = false;            // true: a stop may leave the last spans untraced; false: it waits for the batch

  // Set by the loop.
  std::uint32_t done_count = 0;  // spans traced, from the front
  std::uint64_t took_ns = 0;     // by the source's clock: tracing, packing and pacing
};

struct SpanSource {
  void* context = nullptr;  // passed to the functions below, which run on the caller's thread
  // Fills in the next batch.
  void (*next)(void* context, SpanBatch* batch) = nullptr;
  // Receives a finished batch, whose pixels are in the image. Returns true if the frame is complete.
  bool (*finished)(void* context, const SpanBatch& batch) = nullptr;
  // Packs the pixels just traced for display; counts as the batch's work. Null: nothing to do.
  void (*pack)(void* context, const SpanBatch& batch) = nullptr;
  // Attends to links, the only place in a frame that may wait for them. Called after a batch that does not complete the
  // frame. Null: there are none.
  void (*poll)(void* context, const SpanBatch& batch) = nullptr;

  Aov aov = Aov::none;
  std::uint64_t deadline_ns =
      kNoDeadline;  // by the source's clock; each call of trace_frame() traces at least one batch
  const std::atomic<bool>* stop = nullptr;  // set: no further batch

  // The source's own clock and pace. pace() waits until work begun at `begin_ns` has taken as long as on the emulated
  // device and returns that time. Both null: the renderer's pace and its clock.
  std::uint64_t (*now_ns)(void* context) = nullptr;
  std::uint64_t (*pace)(void* context, const SpanBatch& batch, std::uint64_t begin_ns) = nullptr;
};

}  // namespace pocketray
