// Threads that take spans, a few at a time. Started before the seal; the picture does not depend on how many there are.
#pragma once
#include <atomic>
#include <cstdint>

#include "shade/trace_spans.h"

namespace pocketray {

struct Workers;

// Starts thread_count − 1 threads beside the caller's, at most kThreadCountMax in all; fewer where the system has no
// more to give: worker_thread_count() tells. Null where it gives none, or one is enough.
Workers* start_workers(std::uint32_t thread_count);
void stop_workers(Workers* workers);
// The caller's included.
std::uint32_t worker_thread_count(const Workers* workers);
// Calls work(context, thread) once on each thread, the caller's being 0, and returns when all are done. `workers` may
// be null: the caller's thread does it alone.
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
  Tracer* tracers;                          // one per thread
  std::uint64_t* span_ns;                   // what each span cost, those taken together alike; null: not measured
  const std::atomic<bool>* stop = nullptr;  // set: leave the remaining spans
};

// Traces all spans and returns how many were done. `workers` may be null: the caller's thread does it alone.
std::uint32_t trace_with(Workers* workers, const TraceJob& job);

std::uint64_t clock_ns();  // steady

}  // namespace pocketray
