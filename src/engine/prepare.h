// The steps of prepare_frame(), in order.
#pragma once
#include "engine/renderer.h"

namespace pocketray {

// Positions, normals, lights and cameras at a time; timed in pose_ms.
void pose_scene(Renderer* renderer, double seconds);
// The accelerator over the posed positions; timed in refit_ms.
void accelerate(Renderer* renderer);
// Selects the kernel instantiations for the plan and the filters of its rays.
void choose_kernels(Renderer* renderer);
// Light points, the radiance bound, and how much may be skipped at this exposure.
void light_scene(Renderer* renderer);
// The camera's rays, and the bodies that contain it. Fails if there is no such camera.
Status aim_camera(Renderer* renderer);
// The threads' tracers, with their memory.
void make_tracers(Renderer* renderer);

}  // namespace pocketray
