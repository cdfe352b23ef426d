// Threads that take a few spans at a time. Started before the seal; the picture does not depend on their number.
#pragma once
#include <atomic>
#include <cstdint>

#include "engine/span_source.h"

namespace pocketray {

struct Workers;

// Starts thread_count − 1 threads in addition to the caller's, at most kThreadCountMax in total. The system may give
// fewer; worker_thread_count() tells. Null if it gives none or one thread is enough.
Workers* start_workers(std::uint32_t thread_count);
void stop_workers(Workers* workers);
// Including the caller's.
std::uint32_t worker_thread_count(const Workers* workers);
// Calls work(context, thread) once on each thread, the caller's being 0, and returns when all are done. If `workers` is
// null, the caller's thread does all of it.
void run_with(Workers* workers, void (*work)(void* context, std::uint32_t thread), void* context);

// Calls take(context, thread, item) for each item of [begin, end), on whichever thread is free. Returns when all are
// done, or each thread has left because take() returned false: the first item that none took.
std::uint32_t share_items(Workers* workers, std::uint32_t begin, std::uint32_t end,
                          bool (*take)(void* context, std::uint32_t thread, std::uint32_t item), void* context);

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

// Traces all spans and returns how many were done. If `workers` is null, the caller's thread does all of it.
std::uint32_t trace_with(Workers* workers, const TraceJob& job);

std::uint64_t clock_ns();  // monotonic

}  // namespace pocketray
