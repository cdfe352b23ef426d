// Key times and values of animation channels (secs. 3.11, C).
#include <algorithm>
#include <cmath>

#include "desktop/import/gltf.h"
#include "desktop/import/import_error.h"
#include "scene/channel.h"

namespace pocketray {
namespace {

// Number of floats per value in the file.
std::size_t width_in_file(const GltfFile& file, const GltfTarget& target) {
  if (target.path == ChannelPath::material_diffuse) return 4;  // with opacity
  const bool has_weights = target.path == ChannelPath::weights;
  return channel_width(target.path, has_weights ? gltf_morph_target_count(file, target.index) : 0);
}

std::size_t values_per_key(const GltfKeys& keys, std::size_t width) {
  return width * (keys.interpolation == Interpolation::cubic ? 3 : 1);
}

// Returns why the keys are unusable, or null.
const char* fault_of(const GltfKeys& keys, std::size_t width) {
  if (width == 0) return "there are no morph targets";
  if (keys.times.empty() || keys.values.size() != keys.times.size() * values_per_key(keys, width))
    return "it does not have one value per key";
  if (keys.times[0] < 0) return "it begins before time 0";
  return std::is_sorted(keys.times.begin(), keys.times.end()) ? nullptr : "its keys descend";
}

// Keeps the last of keys at equal times (HARDCASES row 67). Returns false if there are no keys.
bool drop_equal_times(std::size_t value_count, GltfKeys* keys) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < keys->times.size(); ++i) {
    if (i + 1 < keys->times.size() && keys->times[i] == keys->times[i + 1]) continue;
    keys->times[kept] = keys->times[i];
    std::copy_n(keys->values.begin() + static_cast<std::ptrdiff_t>(i * value_count), value_count,
                keys->values.begin() + static_cast<std::ptrdiff_t>(kept * value_count));
    ++kept;
  }
  const bool dropped = kept < keys->times.size();
  keys->times.resize(kept), keys->values.resize(kept * value_count);
  return dropped;
}

GltfKeys read_keys(GltfFile* file, const tinygltf::Animation& animation, int sampler_index, std::size_t width) {
  if (sampler_index < 0 || static_cast<std::size_t>(sampler_index) >= animation.samplers.size())
    fail_import("animation sampler %d does not exist; export the file again", sampler_index);
  const tinygltf::AnimationSampler& sampler = animation.samplers[static_cast<std::size_t>(sampler_index)];
  GltfKeys keys;
  if (sampler.interpolation == "STEP") keys.interpolation = Interpolation::step;
  if (sampler.interpolation == "CUBICSPLINE") keys.interpolation = Interpolation::cubic;
  keys.times = gltf_floats(file, sampler.input, 1, "animation times");
  // Weights are scalars, several per key.
  const int own = gltf_component_count(*file, sampler.output), components = static_cast<int>(width > 4 ? 1 : width);
  keys.values = gltf_floats(file, sampler.output, own == 1 ? 1 : components, "animation values");
  return keys;
}

void read_channel(GltfFile* file, std::size_t index, const tinygltf::AnimationChannel& channel) {
  const tinygltf::Animation& animation = file->model.animations[index];
  GltfDrive drive = {index, {}, {}};
  if (!gltf_target(file, channel, &drive.target)) return;
  const std::size_t width = width_in_file(*file, drive.target);
  drive.keys = read_keys(file, animation, channel.sampler, drive.target.path == ChannelPath::weights ? 1 : width);
  const std::string what = gltf_target_name(*file, drive.target) + " (" + gltf_path_name(drive.target.path) + ")";
  if (const char* fault = fault_of(drive.keys, width))
    return note_remark(file->builder, "the animation of " + what + " is left out: " + fault);
  if (drop_equal_times(values_per_key(drive.keys, width), &drive.keys))
    note_remark(file->builder, "of keys at equal times, the last is used");
  charge_bytes(file->builder, (drive.keys.times.size() + drive.keys.values.size()) * sizeof(float), "the animation");
  file->drives.push_back(std::move(drive));
}

}  // namespace

void gltf_read_animations(GltfFile* file) {
  if (!file->builder->options.animations) return;
  for (std::size_t i = 0; i < file->model.animations.size(); ++i)
    for (const tinygltf::AnimationChannel& channel : file->model.animations[i].channels) read_channel(file, i, channel);
}

}  // namespace pocketray
