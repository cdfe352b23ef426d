// Divides spans among threads.
#pragma once
#include "engine/span_source.h"
#include "engine/workers.h"

namespace pocketray {

struct TraceJob {
  const Span* spans;
  std::uint32_t span_count;
  Aov aov;
  Vec3* image;
  Tracer* tracers;                             // one per thread
  std::uint64_t* span_ns;                      // cost of each span, equal for spans taken together; null: not measured
  const std::atomic<bool>* stop = nullptr;     // set: skip the remaining spans
  std::uint32_t pitch = 1, spans_at_once = 0;  // as in SpanBatch
  Errand errand = {};                          // done by the first thread that is free
};

// Traces all spans and returns how many were done. If `workers` is null, the caller's thread does everything.
std::uint32_t trace_with(Workers* workers, const TraceJob& job);

}  // namespace pocketray
