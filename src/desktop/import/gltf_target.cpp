// Targets of animation channels (secs. 3.11, KHR_animation_pointer).
#include <algorithm>
#include <cstdlib>

#include "desktop/import/gltf.h"
#include "desktop/import/import_error.h"

namespace pocketray {
namespace {

// In the order of ChannelPath.
constexpr const char* kPathNames[] = {"translation", "rotation", "scale",         "weights", "visibility",
                                      "intensity",   "scale",    "field of view", "colour",  "emission"};
static_assert(sizeof kPathNames / sizeof kPathNames[0] == kChannelPathCount, "one name for each");

// Pointers that the scene supports; {} is an index. A light's colour and intensity form one value.
constexpr struct {
  const char* pointer;
  ChannelPath path;
} kPointers[] = {
    {"/nodes/{}/translation", ChannelPath::translation},
    {"/nodes/{}/rotation", ChannelPath::rotation},
    {"/nodes/{}/scale", ChannelPath::scale},
    {"/nodes/{}/weights", ChannelPath::weights},
    {"/nodes/{}/extensions/KHR_node_visibility/visible", ChannelPath::visibility},
    {"/extensions/KHR_lights_punctual/lights/{}/color", ChannelPath::light_intensity},
    {"/extensions/KHR_lights_punctual/lights/{}/intensity", ChannelPath::light_scale},
    {"/cameras/{}/perspective/yfov", ChannelPath::camera_size},
    {"/cameras/{}/orthographic/ymag", ChannelPath::camera_size},
    {"/materials/{}/pbrMetallicRoughness/baseColorFactor", ChannelPath::material_diffuse},
    {"/materials/{}/emissiveFactor", ChannelPath::material_emission},
};

// Replaces the first number between slashes by {}.
std::string pattern_of(const std::string& pointer, int* index) {
  *index = -1;
  std::string pattern;
  for (std::size_t at = 0; at < pointer.size();) {
    const std::size_t end = std::min(pointer.find('/', at + 1), pointer.size());
    const std::string part = pointer.substr(at, end - at);
    const bool is_number = part.size() > 1 && part.size() < 10 && part.find_first_not_of("/0123456789") == part.npos;
    if (is_number && *index < 0) *index = std::atoi(part.c_str() + 1);
    pattern += is_number ? "/{}" : part;
    at = end;
  }
  return pattern;
}

std::size_t count_of(const GltfFile& file, ChannelPath path) {
  if (path <= ChannelPath::visibility) return file.nodes.size();
  if (path <= ChannelPath::light_scale) return file.model.lights.size();
  return path == ChannelPath::camera_size ? file.model.cameras.size() : file.model.materials.size();
}

// Finds the target of a pointer, or of one of the four paths.
bool find_target(GltfFile* file, const tinygltf::AnimationChannel& channel, GltfTarget* target) {
  if (channel.target_path != "pointer") {
    for (int path = 0; path < 4; ++path)
      if (channel.target_path == kPathNames[path])
        return target->path = static_cast<ChannelPath>(path), target->index = channel.target_node, true;
    return false;
  }
  const tinygltf::Value* extension = gltf_extension(channel.target_extensions, "KHR_animation_pointer");
  if (!extension || !extension->Has("pointer") || !extension->Get("pointer").IsString()) return false;
  const std::string pattern = pattern_of(extension->Get("pointer").Get<std::string>(), &target->index);
  for (const auto& row : kPointers)
    if (pattern == row.pointer) return target->path = row.path, target->index >= 0;
  note_unused(file->builder, "animation of " + pattern.substr(0, 100));
  return false;
}

}  // namespace

bool gltf_target(GltfFile* file, const tinygltf::AnimationChannel& channel, GltfTarget* target) {
  if (!find_target(file, channel, target) || target->index < 0) return false;
  const auto index = static_cast<std::size_t>(target->index);
  if (index >= count_of(*file, target->path))
    fail_import("an animation drives %s, which does not exist; export the file again",
                gltf_target_name(*file, *target).c_str());
  if (target->path > ChannelPath::visibility) return true;
  if (!file->nodes[index].visited) note_unused(file->builder, "animation of nodes outside the scene");
  return file->nodes[index].visited;
}

std::string gltf_target_name(const GltfFile& file, const GltfTarget& target) {
  const char* kind = target.path <= ChannelPath::visibility    ? "node "
                     : target.path <= ChannelPath::light_scale ? "light "
                     : target.path == ChannelPath::camera_size ? "camera "
                                                               : "material ";
  const auto index = static_cast<std::size_t>(target.index);
  if (target.path <= ChannelPath::visibility && index < file.model.nodes.size())
    return gltf_node_name(file, target.index);
  return kind + std::to_string(target.index);
}

const char* gltf_path_name(ChannelPath path) { return kPathNames[static_cast<int>(path)]; }

}  // namespace pocketray
