// The steps of prepare_frame(), in the order in which it takes them.
#pragma once
#include "engine/renderer.h"

namespace pocketray {

// Positions, normals, lights and cameras at a time; timed in pose_ms.
void pose_scene(Renderer* renderer, double seconds);
// The accelerator over the posed positions; timed in refit_ms.
void accelerate(Renderer* renderer);
// Instantiations of the kernel for the plan, and the filters of its rays.
void choose_kernels(Renderer* renderer);
// Light points, the bound of what a ray may bring, and what may be left out at this exposure.
void light_scene(Renderer* renderer);
// The camera's rays, and the bodies that it is inside of. Fails where there is no such camera.
Status aim_camera(Renderer* renderer);

}  // namespace pocketray
