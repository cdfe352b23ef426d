// The value of an animation channel at a time [glTF 2.0, appendix C].
#pragma once
#include "scene/scene.h"

namespace pocketray {

// Number of floats per value: 1, 3, 4 or the number of the node's morph weights.
std::uint32_t channel_width(const Scene& scene, const Channel& channel);
// `weight_count`: the node's, for a channel of morph weights.
std::uint32_t channel_width(ChannelPath path, std::uint32_t weight_count);

// Writes the channel's value at `time` (seconds), `width` floats, to `value`: translations, scales, morph weights.
void channel_value(const Scene& scene, const Channel& channel, double time, std::uint32_t width, float* value);
// Likewise for rotations, along the shorter arc. Returns a unit quaternion; identity if the keys have no direction.
Quaternion channel_rotation(const Scene& scene, const Channel& channel, double time);

}  // namespace pocketray
