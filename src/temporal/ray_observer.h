// Marks rays in the tables while an accelerator traces them.
#pragma once
#include "accel/accel.h"
#include "temporal/ray_tables.h"

namespace pocketray {

// Observer of one thread, on its own cache line. Observed rays belong to the pixel that trace_spans() has
// announced.
struct alignas(64) MarkingObserver : RayObserver {
  const AccelInfo* accel_info = nullptr;  // the accelerator that traces the rays
  const RayTables* tables = nullptr;
  std::uint8_t* marked = nullptr;  // a byte per pixel: 1 once a ray of it has been marked
};

// Wraps the accelerator so that single rays are marked for the observer in their TraceStats. Packets are not marked.
AccelInfo observed(const AccelInfo& accel_info);

}  // namespace pocketray
