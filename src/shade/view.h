// The camera of a frame, the cones of its pixels, and the bodies that contain it.
#pragma once
#include "base/limits.h"
#include "base/vec3.h"

namespace pocketray {

// Rays of a camera: origin(s) and a plane of directions; see camera.h.
struct CameraRays {
  Vec3 eye, forward, right, up;  // right and up span half the image at distance 1 (perspective) or in scene units
  float width, height;           // pixels
  float near_distance = 0;       // rays begin on the plane at this distance along `forward`
  bool orthographic;
  bool has_one_origin = true;  // all rays begin at the eye: a perspective camera without a near plane
};

// Width of a pixel's cone at the eye, and its growth per distance; see footprint.h.
struct PixelCone {
  float width, spread;
};

// Bodies that contain the ray, as material indices, innermost last.
struct MediumStack {
  std::uint32_t material[kMediumDepthMax];
  std::uint32_t depth = 0;
};

struct View {
  CameraRays camera;
  PixelCone cone = {0, 0};  // set with Effect::mip_map
  MediumStack eye_media;    // bodies that contain the camera
};

}  // namespace pocketray
