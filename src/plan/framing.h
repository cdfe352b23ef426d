// Cameras that frame what a scene shows, at rest and while it is animated.
//
// Seen along a direction, a camera with the slope k = tan(fov / 2) shows all vertices iff its eye is at least at
// (R(k) + L(k)) / 2k along the view axis and (R(k) − L(k)) / 2 across it, where R(k) and L(k) are the maxima of ±x + kz
// over the vertices: two maxima per axis of the picture, and no iteration. R and L are support functions in the plane
// of x and z. Framing stores them at kReachAngles angles, which frames a scene at any aspect and field of view.
#pragma once
#include "base/fmath.h"
#include "scene/scene.h"

namespace pocketray {

// Fields of view are vertical, in radians. Chosen: those of 33 and 21 mm lenses on 35 mm film. Wider ones distort
// objects, narrower ones show less of a room.
constexpr double kFramingFieldOfView = radians(40), kInsideFieldOfView = radians(60);
constexpr float kFramingFill = 0.9f;  // part of the picture's width or height that a framed scene fills

// Measures how far points reach around `middle`, as seen by a camera that looks from the unit direction `backward`.
class ReachMeter {
 public:
  ReachMeter(const Vec3& middle, const Vec3& backward);
  void add(const Vec3& point);
  // Returns a framing with that direction and reach: zero without points.
  Framing framing() const;

 private:
  Vec3 middle_, right_, up_, backward_;
  float cosine_[kReachAngles], sine_[kReachAngles];
  float reach_[kReachSides][kReachAngles];
};

// Frames the points that were measured around the middle of `bounds`.
Camera framing_camera(const Framing& framing, const Box& bounds, float aspect,
                      double vertical_fov = kFramingFieldOfView);
// Frames the corners of a box.
Camera framing_camera(const Box& bounds, float aspect, const Vec3& backward, double vertical_fov = kFramingFieldOfView);

}  // namespace pocketray
