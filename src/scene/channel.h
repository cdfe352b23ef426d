// The value of an animation channel at a time [glTF 2.0, appendix C].
#pragma once
#include "scene/scene.h"

namespace pocketray {

// Floats of a value: 1, 3, 4 or the number of the node's morph weights.
std::uint32_t channel_width(const Scene& scene, const Channel& channel);
// `weight_count`: of the node, for a channel of morph weights.
std::uint32_t channel_width(ChannelPath path, std::uint32_t weight_count);

// Writes the channel's value at `time` (seconds), `width` floats, to `value`: translations, scales, morph weights.
void channel_value(const Scene& scene, const Channel& channel, double time, std::uint32_t width, float* value);
// The same for rotations, along the shorter arc. Returns a unit quaternion; the identity if the keys give no direction.
Quaternion channel_rotation(const Scene& scene, const Channel& channel, double time);

}  // namespace pocketray
