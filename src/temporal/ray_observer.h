// Marks rays in the tables while an accelerator traces them.
#pragma once
#include "accel/accel.h"
#include "temporal/ray_tables.h"

namespace pocketray {

// One thread's, on a cache line of its own. Rays that are observed belong to the pixel that trace_spans() has
// announced.
struct alignas(64) MarkingObserver : RayObserver {
  const AccelInfo* accel_info = nullptr;  // that traces the rays
  const RayTables* tables = nullptr;
  std::uint8_t* marked = nullptr;  // a byte for each pixel: 1 once a ray of it has been marked
};

// The accelerator with single rays marked for the observer in their TraceStats. Packets are not marked.
AccelInfo observed(const AccelInfo& accel_info);

}  // namespace pocketray
