// Animations (sec. 3.11): those with disjoint targets play together, as one, from the start.
#include <algorithm>
#include <cmath>
#include <cstring>

#include "desktop/import/gltf.h"
#include "scene/metallic_roughness.h"

namespace pocketray {
namespace {

constexpr float kFramesPerSecond = 30;  // glTF has keys, not frames
constexpr float kFaint = 1e-6f;         // of the peak: what emits at times must emit always (engine/recolor.h)

// An animation of the file with the drives that the scene can follow.
struct Clip {
  std::size_t animation;
  std::vector<const GltfDrive*> drives;
  bool plays = false;  // together with the first ones
  Animation written = {0, 0, 0};
};

// A light's colour and intensity form one value.
std::pair<ChannelPath, int> driven(const GltfTarget& target) {
  return {target.path == ChannelPath::light_scale ? ChannelPath::light_intensity : target.path, target.index};
}

bool drives(const Clip& clip, const GltfTarget& target) {
  return std::any_of(clip.drives.begin(), clip.drives.end(), [&](const GltfDrive* d) {
    return d->target.path == target.path && d->target.index == target.index;
  });
}

std::vector<Clip> find_clips(GltfFile* file) {
  std::vector<Clip> clips;
  for (const GltfDrive& drive : file->drives) {
    if (clips.empty() || clips.back().animation != drive.animation) clips.push_back({drive.animation, {}});
    if (drives(clips.back(), drive.target))
      note_remark(file->builder,
                  "an animation drives " + gltf_target_name(*file, drive.target) + " twice: the first is used");
    else
      clips.back().drives.push_back(&drive);
  }
  return clips;
}

std::string clip_name(const GltfFile& file, const Clip& clip, std::size_t number) {
  const std::string& name = file.model.animations[clip.animation].name;
  return std::to_string(number) + (name.empty() ? "" : " '" + name.substr(0, 60) + "'");
}

// Marks the clips that play together: each whose targets no clip before it drives.
void choose_clips(GltfFile* file, std::vector<Clip>* clips) {
  std::set<std::pair<ChannelPath, int>> taken;
  std::string left_out;
  for (std::size_t i = 0; i < clips->size(); ++i) {
    Clip& clip = (*clips)[i];
    clip.plays = std::none_of(clip.drives.begin(), clip.drives.end(),
                              [&](const GltfDrive* d) { return taken.count(driven(d->target)) > 0; });
    if (!clip.plays && left_out.size() < 200) left_out += (left_out.empty() ? "" : ", ") + clip_name(*file, clip, i);
    for (const GltfDrive* d : clip.drives)
      if (clip.plays) taken.insert(driven(d->target));
  }
  if (!left_out.empty())
    note_remark(file->builder,
                "animations that share a target do not play together: --animation chooses one (" + left_out + ")");
}

void multiply(GltfKeys* keys, float factor) {
  for (float& value : keys->values) value *= factor;
}

// Subtracts the scene's origin from the values, not from the tangents.
void move_to_origin(const Vec3d& origin, GltfKeys* keys) {
  const std::size_t rows = keys->interpolation == Interpolation::cubic ? 3 : 1;
  for (std::size_t row = rows / 2; row < keys->values.size() / 3; row += rows)
    for (std::size_t c = 0; c < 3; ++c)
      keys->values[3 * row + c] =
          static_cast<float>(static_cast<double>(keys->values[3 * row + c]) - origin[static_cast<int>(c)]);
}

void write_channel(GltfFile* file, ChannelPath path, std::uint32_t target, const GltfKeys& keys, Animation* written) {
  SceneArrays& out = *file->builder->out;
  Channel channel = {};
  channel.path = path, channel.node = target, channel.interpolation = keys.interpolation;
  channel.key_count = static_cast<std::uint32_t>(keys.times.size());
  // Channels of one animation mostly share their times.
  bool same = out.key_times.size() >= keys.times.size() &&
              std::equal(keys.times.begin(), keys.times.end(),
                         out.key_times.end() - static_cast<std::ptrdiff_t>(keys.times.size()));
  if (!same) out.key_times.insert(out.key_times.end(), keys.times.begin(), keys.times.end());
  channel.key_begin = static_cast<std::uint32_t>(out.key_times.size() - keys.times.size());
  channel.value_begin = static_cast<std::uint32_t>(out.key_values.size());
  out.key_values.insert(out.key_values.end(), keys.values.begin(), keys.values.end());
  written->duration = std::max(written->duration, keys.times.back());
  out.channels.push_back(channel);
  ++written->channel_count;
}

void write_light(GltfFile* file, const GltfDrive& drive, Clip* clip) {
  const tinygltf::Light& light = file->model.lights[static_cast<std::size_t>(drive.target.index)];
  GltfTarget other = drive.target;
  const bool is_color = drive.target.path == ChannelPath::light_intensity;
  other.path = is_color ? ChannelPath::light_scale : ChannelPath::light_intensity;
  GltfKeys keys = drive.keys;
  ChannelPath path = drive.target.path;
  if (is_color && !drives(*clip, other)) {
    multiply(&keys, static_cast<float>(std::min(std::max(light.intensity, 0.0), 1e18)));
  } else if (!is_color && !drives(*clip, other)) {
    path = ChannelPath::light_intensity;
    keys.values.clear();
    for (float value : drive.keys.values)
      for (std::size_t c = 0; c < 3; ++c)
        keys.values.push_back(value * (light.color.size() > c ? static_cast<float>(light.color[c]) : 1));
  }
  for (std::uint32_t index : file->lights[static_cast<std::size_t>(drive.target.index)])
    write_channel(file, path, index, keys, &clip->written);
}

// Base colour affects only the diffuse lobe, unless the material is metal or glass.
void write_base_color(GltfFile* file, const GltfDrive& drive, std::uint32_t index, Clip* clip) {
  const SceneArrays& out = *file->builder->out;
  const Material& material = out.materials[index];
  const bool has_map = index < out.material_maps.size() && has_lobe_map(out.material_maps[index]);
  const bool is_plain = !has_map && is_zero(material.specular_tinted) && is_zero(material.mirror_tinted) &&
                        is_zero(material.transmission);
  if (!is_plain) return note_unused(file->builder, "animation of the colour of metals and glass");
  GltfKeys keys = drive.keys;
  keys.values.clear();
  bool fades = false;
  for (std::size_t i = 0; i + 3 < drive.keys.values.size(); i += 4) {
    keys.values.insert(keys.values.end(), drive.keys.values.begin() + static_cast<std::ptrdiff_t>(i),
                       drive.keys.values.begin() + static_cast<std::ptrdiff_t>(i + 3));
    fades |= drive.keys.interpolation != Interpolation::cubic && drive.keys.values[i + 3] != drive.keys.values[3];
  }
  if (fades) note_unused(file->builder, "animation of opacity");
  write_channel(file, ChannelPath::material_diffuse, index, keys, &clip->written);
}

void write_emission(GltfFile* file, const GltfDrive& drive, std::uint32_t index, Clip* clip) {
  Material& material = file->builder->out->materials[index];
  if (material.unlit) return note_unused(file->builder, "animation of unlit materials' emission");
  const tinygltf::Material& source = file->model.materials[static_cast<std::size_t>(drive.target.index)];
  const tinygltf::Value* extension = gltf_extension(source.extensions, "KHR_materials_emissive_strength");
  GltfKeys keys = drive.keys;
  if (extension)
    multiply(&keys, static_cast<float>(std::min(std::max(gltf_number(*extension, "emissiveStrength", 1), 0.0), 1e18)));
  float brightest = 0;
  for (float value : keys.values) brightest = std::max(brightest, value);
  const float faint = std::min(brightest, 1.0f) * kFaint;
  if (is_zero(material.emission)) material.emission = {faint, faint, faint};
  write_channel(file, ChannelPath::material_emission, index, keys, &clip->written);
}

void write_drive(GltfFile* file, const GltfDrive& drive, Clip* clip) {
  const auto index = static_cast<std::size_t>(drive.target.index);
  GltfKeys keys;
  switch (drive.target.path) {
    case ChannelPath::light_intensity:
    case ChannelPath::light_scale:
      return write_light(file, drive, clip);
    case ChannelPath::camera_size:
      keys = drive.keys;
      if (file->model.cameras[index].type == "orthographic") multiply(&keys, 2);
      for (std::uint32_t camera : file->cameras[index])
        write_channel(file, drive.target.path, camera, keys, &clip->written);
      return;
    case ChannelPath::material_diffuse:
    case ChannelPath::material_emission:
      if (file->materials[index] == kNone) return;  // no triangle uses it
      return drive.target.path == ChannelPath::material_diffuse
                 ? write_base_color(file, drive, file->materials[index], clip)
                 : write_emission(file, drive, file->materials[index], clip);
    default:
      keys = drive.keys;
      if (drive.target.path == ChannelPath::translation && file->nodes[index].parent < 0)
        move_to_origin(origin_of(*file->builder), &keys);
      write_channel(file, drive.target.path, file->nodes[index].out_node, keys, &clip->written);
  }
}

// Channels that multiply a light's value come after those that set it.
void write_clip(GltfFile* file, Clip* clip) {
  clip->written.channel_begin = static_cast<std::uint32_t>(file->builder->out->channels.size());
  for (const bool multiplies : {false, true})
    for (const GltfDrive* drive : clip->drives)
      if ((drive->target.path == ChannelPath::light_scale) == multiplies) write_drive(file, *drive, clip);
}

// Copies as many whole UTF-8 characters as fit.
template <std::size_t size>
void copy_text(std::string text, char (&to)[size]) {
  if (text.size() > size) {
    std::size_t end = size - 3;
    while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0) == 0x80) --end;
    text = text.substr(0, end) + "…";
  }
  std::memset(to, 0, size);
  std::memcpy(to, text.data(), text.size());
}

// "node 3 'Wheel' (rotation, scale), light 0 (intensity)"
std::string drives_text(const GltfFile& file, const Clip& clip) {
  std::vector<std::pair<std::string, std::string>> rows;  // target, paths
  for (const GltfDrive* drive : clip.drives) {
    const std::string target = gltf_target_name(file, drive->target), path = gltf_path_name(drive->target.path);
    auto known = std::find_if(rows.begin(), rows.end(), [&](const auto& row) { return row.first == target; });
    if (known == rows.end())
      rows.emplace_back(target, path);
    else
      known->second += ", " + path;
  }
  std::string text;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const std::string more = (i ? ", " : "") + rows[i].first + " (" + rows[i].second + ")";
    if (text.size() + more.size() > 160 && i > 0) return text + " and " + std::to_string(rows.size() - i) + " more";
    text += more;
  }
  return text;
}

void add_animation(GltfFile* file, const Animation& animation, const std::string& name, const std::string& drives,
                   bool combines) {
  SceneArrays& out = *file->builder->out;
  AnimationLabel label;
  copy_text(name, label.name), copy_text(drives, label.drives);
  label.combines = combines;
  out.animations.push_back(animation), out.animation_labels.push_back(label);
}

}  // namespace

void gltf_export_animations(GltfFile* file) {
  SceneArrays& out = *file->builder->out;
  std::vector<Clip> clips = find_clips(file);
  for (Clip& clip : clips) {
    auto is_lost = [&](const GltfDrive* drive) {
      return drive->target.path <= ChannelPath::visibility &&
             file->nodes[static_cast<std::size_t>(drive->target.index)].out_node == kNone;
    };
    clip.drives.erase(std::remove_if(clip.drives.begin(), clip.drives.end(), is_lost), clip.drives.end());
  }
  choose_clips(file, &clips);
  for (const bool plays : {true, false})
    for (Clip& clip : clips)
      if (clip.plays == plays) write_clip(file, &clip);
  clips.erase(
      std::remove_if(clips.begin(), clips.end(), [](const Clip& clip) { return clip.written.channel_count == 0; }),
      clips.end());
  if (clips.empty()) return;
  Animation together = {0, 0, 0};
  std::string names;
  int together_count = 0;
  for (std::size_t i = 0; i < clips.size(); ++i) {
    if (!clips[i].plays) continue;
    together.channel_count += clips[i].written.channel_count;
    together.duration = std::max(together.duration, clips[i].written.duration);
    names += (names.empty() ? "" : ", ") + clip_name(*file, clips[i], i);
    ++together_count;
  }
  if (together_count > 1) add_animation(file, together, "", names, true);
  for (const Clip& clip : clips)
    add_animation(file, clip.written, file->model.animations[clip.animation].name, drives_text(*file, clip), false);
  out.info.frames_per_second = kFramesPerSecond;
  double frames = static_cast<double>(out.animations[0].duration) * static_cast<double>(kFramesPerSecond);
  out.info.frame_count = static_cast<std::uint32_t>(std::min(std::max(frames + 0.5, 1.0), 1e6));
}

}  // namespace pocketray
