// One sample of a pixel.
#pragma once
#include "shade/camera.h"
#include "shade/frame_data.h"
#include "shade/tracer.h"

namespace pocketray {

inline Ray pixel_ray(const FrameData& frame, std::uint32_t column, std::uint32_t row, const Vec2& offset) {
  return camera_ray(frame.view.camera, static_cast<float>(column) + offset.x, static_cast<float>(row) + offset.y);
}

// Radiance of the sample whose ray first hits `hit`; `surface` is the surface there, or null.
inline Vec3 sample_radiance(Tracer* tracer, const Ray& ray, const Hit& hit, const Surface* surface) {
  const FrameData& frame = *tracer->frame;
  tracer->budget = tracer->skip_max = tracer->branching.allowed = frame.cut_off.left_out_max;
  tracer->branching.ended = 0;
  ++tracer->rays[static_cast<int>(RayKind::primary)];
  Vec3 radiance = frame.kernels.radiance(tracer, ray, hit, surface);
  const float allowed = tracer->branching.allowed, left_out = allowed - tracer->budget;
  if (left_out > tracer->left_out_max) tracer->left_out_max = left_out;
  if (left_out > tracer->left_out_share_max * allowed) tracer->left_out_share_max = left_out / allowed;
  if (tracer->branching.ended > tracer->ended_bound_max) tracer->ended_bound_max = tracer->branching.ended;
  return radiance;
}

}  // namespace pocketray
