// The steps of begin_frame(), in order.
#pragma once
#include "engine/renderer.h"

namespace pocketray {

// Poses positions, normals, lights and cameras at a time; timed in pose_ms.
void pose_scene(Renderer* renderer, double seconds);
// Updates the accelerator to the posed positions; timed in refit_ms.
void accelerate(Renderer* renderer);
// Selects the kernel instantiations for the plan and the filters of its rays.
void choose_kernels(Renderer* renderer);
// Places light points, computes the radiance bound, and what may be skipped at this exposure.
void light_scene(Renderer* renderer);
// Sets up the camera's rays and the bodies that contain it. Fails if there is no such camera.
Status aim_camera(Renderer* renderer);
// Makes the threads' tracers, with their memory.
void make_tracers(Renderer* renderer);
// Follows the frame as far as its purpose, the settings and the memory plan allow, and finds what may have changed.
void begin_history(Renderer* renderer, const FrameTask& task);

// Sets up the renderer's coherence, if planned; a step of build_renderer().
void make_history(Renderer* renderer);

}  // namespace pocketray
