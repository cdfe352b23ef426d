// Signed distance estimates for the figure, upright (before bend_figure()); negative inside. Units as in figure.h.
#pragma once
#include "base/vec3.h"

namespace pocketray {

// Head, torso and robe. `azimuth` is the angle of p about the y axis, in (-π, π]: 0 is the front, positive the figure's
// left.
float body_distance(const Vec3& p, float azimuth);
// An arm (0 right, 1 left), including its transition into the shoulder.
float arm_distance(int side, const Vec3& p);

// Axis of an arm: from inside the shoulder to the break.
void arm_axis(int side, Vec3* from, Vec3* to);

// Contrapposto: maps a point of the upright figure to its final place.
Vec3 bend_figure(const Vec3& p);

}  // namespace pocketray
