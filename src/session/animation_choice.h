// Selects which of a scene's animations plays.
#pragma once
#include <string>
#include <vector>

#include "base/status.h"
#include "scene/scene.h"

namespace pocketray {

// For --animation: all animations that drive different things, the default; no animation.
constexpr const char *kAllAnimations = "all", *kNoAnimation = "none";

// Finds the animation that --animation names or numbers, kNone for "none"; empty: the default.
Status find_animation(const Scene& scene, const std::string& asked, std::uint32_t* index);

// "animation 0 'Walk', 1.5 s: node 'Hips' (rotation)"; for kNone and combinations, only their names.
std::string describe_animation(const Scene& scene, std::uint32_t index);
// Returns the indices of animations with a number of their own, in the order of their numbers.
std::vector<std::uint32_t> numbered_animations(const Scene& scene);

}  // namespace pocketray
