// Which of a scene's animations plays.
#pragma once
#include <string>
#include <vector>

#include "base/status.h"
#include "scene/scene.h"

namespace pocketray {

// For --animation: those that do not drive the same thing, the default; no animation.
constexpr const char *kAllAnimations = "all", *kNoAnimation = "none";

// The index of the animation that --animation asks for by name or number, kNone for none of them; empty: the default.
Status find_animation(const Scene& scene, const std::string& asked, std::uint32_t* index);

// "animation 0 'Walk', 1.5 s: node 'Hips' (rotation)"; for kNone and the combination of several, their names alone.
std::string describe_animation(const Scene& scene, std::uint32_t index);
// The indices of animations with a number of their own, in the order of their numbers.
std::vector<std::uint32_t> numbered_animations(const Scene& scene);

}  // namespace pocketray
