// Threads that share the work of a frame. Started before the seal; their number does not affect the picture.
#pragma once
#include <cstdint>

#include "base/parallel_loop.h"

namespace pocketray {

struct Workers;

// Starts thread_count − 1 threads in addition to the caller's, at most kThreadCountMax in total. The system may grant
// fewer; see worker_thread_count(). Returns null if it grants none or one thread is enough.
Workers* start_workers(std::uint32_t thread_count);
void stop_workers(Workers* workers);
// Includes the caller's thread.
std::uint32_t worker_thread_count(const Workers* workers);
// Calls work(context, thread) once on each thread, the caller's being 0, and returns when all are done. If `workers` is
// null, the caller's thread does everything.
void run_with(Workers* workers, void (*work)(void* context, std::uint32_t thread), void* context);

// Calls take(context, thread, item) for each item of [begin, end), on whichever thread is free. Returns when all are
// done, or every thread has left because take() returned false: the first item that none took.
std::uint32_t share_items(Workers* workers, std::uint32_t begin, std::uint32_t end,
                          bool (*take)(void* context, std::uint32_t thread, std::uint32_t item), void* context);

// A loop over the threads of `workers`, or without any the caller's.
ParallelLoop loop_over(Workers* workers);

std::uint64_t clock_ns();  // monotonic

}  // namespace pocketray
