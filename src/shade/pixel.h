// One sample of a pixel.
#pragma once
#include "shade/camera.h"
#include "shade/frame_data.h"

namespace pocketray {

inline Ray pixel_ray(const FrameData& frame, std::uint32_t column, std::uint32_t row, const Vec2& offset) {
  return camera_ray(frame.camera, static_cast<float>(column) + offset.x, static_cast<float>(row) + offset.y);
}

// The sample whose ray first hits `hit`; `surface` is there, or null.
inline Vec3 sample_radiance(Tracer* tracer, const Ray& ray, const Hit& hit, const Surface* surface) {
  const FrameData& frame = *tracer->frame;
  tracer->budget = frame.left_out_max;
  ++tracer->rays[static_cast<int>(RayKind::primary)];
  Vec3 radiance = frame.radiance(tracer, ray, hit, surface);
  float left_out = frame.left_out_max - tracer->budget;
  if (left_out > tracer->left_out_max) tracer->left_out_max = left_out;
  return radiance;
}

}  // namespace pocketray
