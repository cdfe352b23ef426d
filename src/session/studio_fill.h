// A dimmed studio for models that have lights but nothing around them, which would stand in a black void.
#pragma once
#include "scene/scene.h"

namespace pocketray {

// Returns whether a scene has point, spot or directional lights, no environment, and no walls around it.
bool calls_for_fill(const Scene& scene);

// Returns the luminance of surfaces in the scene's lights: the geometric mean of those that are lit, which exposure
// makes middle grey. 0: nothing is lit. Takes points on them and tests every triangle for shadows.
double typical_radiance(const Scene& scene);

// Chosen: a quarter of middle grey, two stops below what the lights show. What is unlit stays dark, but shows its shape.
constexpr double kFillShare = 0.25;
// Dims a studio so that its mean radiance is kFillShare of `radiance`, to the nearest power of two; and the scene's
// background with it.
void dim_to_fill(double radiance, EnvironmentInfo* studio, Vec3* background);

}  // namespace pocketray
