// The motion of `seesaw` as functions of time: a weight drops on one end of a seesaw and launches the worm from the
// other. Free fall and impacts in closed form. Metres and seconds; the floor is y = 0; angles in radians about +z.
#pragma once
#include "base/vec3.h"

namespace pocketray {

constexpr int kWormJoints = 8;
constexpr float kWormLength = 2.4f, kWormRadius = 0.28f;
constexpr float kPivotHeight = 0.85f, kBoardHalfLength = 2.6f, kBoardHalfThickness = 0.06f;

struct SeesawState {
  float board_angle;
  Vec3 weight_position;  // middle of its underside
  float weight_angle;
  Vec3 body_position;  // the worm's centre
  float body_angle;
  Vec3 body_scale;
  Vec3 tail_offset;  // first joint, from the centre
  float joint_angle[kWormJoints];
};
SeesawState seesaw_at(double seconds);

}  // namespace pocketray
