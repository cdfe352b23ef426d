#include "desktop/import/reduce.h"

#include <algorithm>
#include <initializer_list>
#include <map>

#include "base/check.h"
#include "base/color.h"
#include "desktop/import/fold.h"
#include "scene/animate.h"
#include "scene/invisible.h"
#include "scene/metallic_roughness.h"
#include "scene/texture_levels.h"
#include "shade/camera.h"
#include "shade/normal_map.h"

namespace pocketray {
namespace {

// Angle within which a normal from a file is that of its face. Chosen: normals in floats, turned by a node, err by
// less, and radiance changes by a millionth of the light.
constexpr double kNormalRounding = 0x1p-20;

// A picture so many times as wide as high shows whatever cameras show before their near planes. Chosen.
constexpr std::uint32_t kNearWidth = 8;

// Calls visit(use) for every use of a texture.
template <class Visit>
void each_use(SceneArrays* arrays, Visit visit) {
  for (Material& m : arrays->materials) visit(&m.diffuse_texture), visit(&m.emission_texture);
  for (MaterialMaps& maps : arrays->material_maps)
    for (TextureUse* use :
         {&maps.metallic_roughness, &maps.specular, &maps.specular_color, &maps.normal, &maps.occlusion})
      visit(use);
  for (Grain& grain : arrays->grains) visit(&grain.texture);
  for (ClearCoat& coat : arrays->clear_coats)
    for (TextureUse* use : {&coat.strength_texture, &coat.roughness_texture, &coat.normal}) visit(use);
  for (Sheen& sheen : arrays->sheens) visit(&sheen.color_texture), visit(&sheen.roughness_texture);
  for (GlassMap& glass : arrays->glass_maps) visit(&glass.transmission_texture), visit(&glass.thickness_texture);
  for (Iridescence& film : arrays->iridescences) visit(&film.strength_texture), visit(&film.thickness_texture);
  for (DiffuseTransmission& passing : arrays->diffuse_transmissions)
    visit(&passing.strength_texture), visit(&passing.color_texture);
}

class Reducer {
 public:
  explicit Reducer(SceneArrays* arrays) : out_(*arrays), scene_(view_of(*arrays)) {}
  void reduce_all();

 private:
  void note(Invisible what, std::uint32_t count = 1) { counts_[static_cast<int>(what)] += count; }
  bool is_animated(std::uint32_t material, ChannelPath path) const;
  bool survive_filters(const TextureUse& use, std::initializer_list<float> values) const;
  void reduce_emission(std::uint32_t index);
  void reduce_alpha(std::uint32_t index);
  void reduce_maps(std::uint32_t index);
  void fold_reflectance(std::uint32_t index);
  void fold_metallic_roughness(std::uint32_t index);
  bool fold_color(std::uint32_t index);
  bool fold_emission(std::uint32_t index);
  void fold_coat(std::uint32_t index);
  void fold_sheen(std::uint32_t index);
  void fold_grain(std::uint32_t index);
  void reduce_colors();
  void reduce_glass();
  void reduce_animations();
  void reduce_lights();
  void reduce_near_planes();
  void reduce_normals();
  void drop_unused_textures();

  SceneArrays& out_;
  Scene scene_;
  std::uint32_t counts_[kInvisibleCount] = {};
};

bool Reducer::is_animated(std::uint32_t material, ChannelPath path) const {
  return std::any_of(out_.channels.begin(), out_.channels.end(),
                     [&](const Channel& c) { return c.path == path && c.node == material; });
}

void Reducer::reduce_emission(std::uint32_t index) {
  Material& m = out_.materials[index];
  if (is_zero(m.emission) || is_animated(index, ChannelPath::material_emission) || shows_emission(scene_, index))
    return;
  m.emission = {0, 0, 0}, m.emission_texture = TextureUse();
  note(Invisible::black_emission);
}

void Reducer::reduce_alpha(std::uint32_t index) {
  Material& m = out_.materials[index];
  const bool is_mask = m.alpha_mode == AlphaMode::mask;
  if (m.alpha_mode == AlphaMode::opaque || shows_holes(scene_, index) || shows_background(scene_, index)) return;
  m.alpha_mode = AlphaMode::opaque;
  note(is_mask ? Invisible::mask_without_holes : Invisible::opaque_blend);
}

void Reducer::reduce_maps(std::uint32_t index) {
  if (index < out_.material_maps.size()) {
    MaterialMaps& maps = out_.material_maps[index];
    if (maps.normal.texture != kNone && !shows_normal_map(scene_, maps.normal, maps.normal_scale))
      maps.normal = TextureUse(), note(Invisible::flat_normal_map);
    if (maps.occlusion.texture != kNone && !shows_occlusion(scene_, maps))
      maps.occlusion = TextureUse(), note(Invisible::white_occlusion);
  }
  if (index >= out_.clear_coats.size()) return;
  ClearCoat& coat = out_.clear_coats[index];
  if (coat.normal.texture != kNone && !shows_normal_map(scene_, coat.normal, coat.normal_scale))
    coat.normal = TextureUse(), note(Invisible::flat_normal_map);
}

// Returns whether lookups of a texture of these values return them: filters of levels average 3 or 4 lookups.
bool Reducer::survive_filters(const TextureUse& use, std::initializer_list<float> values) const {
  if (out_.textures[use.texture].level_count == 1) return true;
  return std::all_of(values.begin(), values.end(),
                     [](float x) { return (x + x + x) * (1 / 3.0f) == x && (x + x + x + x) * (1 / 4.0f) == x; });
}

// Multiplies the model's reflectance as apply_specular() of shade/material_maps.cpp does at every point.
void Reducer::fold_reflectance(std::uint32_t index) {
  MaterialMaps& maps = out_.material_maps[index];
  std::uint8_t value[4];
  if (maps.specular.texture != kNone) {
    if (!has_one_value(scene_, maps.specular, value)) return;
    const float share = static_cast<float>(value[3]) * (1.0f / 255.0f);
    if (!survive_filters(maps.specular, {share})) return;
    maps.model.dielectric = maps.model.dielectric * share, maps.model.grazing *= share;
    maps.specular = TextureUse();
  }
  if (maps.specular_color.texture == kNone || !has_one_value(scene_, maps.specular_color, value)) return;
  const Vec3 color = {srgb_to_linear(value[0]), srgb_to_linear(value[1]), srgb_to_linear(value[2])};
  if (!survive_filters(maps.specular_color, {color.x, color.y, color.z})) return;
  maps.model.dielectric *= color;
  maps.specular_color = TextureUse();
}

// Sets the lobes as apply_metallic_roughness() and lobes_at() of shade/material_maps.cpp do at every point.
void Reducer::fold_metallic_roughness(std::uint32_t index) {
  if (index >= out_.material_maps.size()) return;
  MaterialMaps& maps = out_.material_maps[index];
  if (!has_lobe_map(maps) || is_animated(index, ChannelPath::material_diffuse)) return;
  // With a map, the colours of texture and vertices are multiplied first.
  if (out_.materials[index].diffuse_texture.texture != kNone && !out_.colors.empty()) return;
  fold_reflectance(index);
  std::uint8_t value[4] = {255, 255, 255, 255};
  if (maps.specular.texture != kNone || maps.specular_color.texture != kNone) return;
  if (maps.metallic_roughness.texture != kNone && !has_one_value(scene_, maps.metallic_roughness, value)) return;
  auto within = [](float x, float low, float high) { return x > low ? (x < high ? x : high) : low; };
  const float metallic =
      within(maps.metallic * (static_cast<float>(value[2]) / 255), maps.metallic_low, maps.metallic_high);
  const float stored = static_cast<float>(static_cast<std::uint16_t>(metallic * 65535 + 0.5f)) / 65535;
  const float roughness =
      within(maps.roughness * (static_cast<float>(value[1]) / 255), maps.roughness_low, maps.roughness_high);
  Material& m = out_.materials[index];
  maps.metallic_roughness = TextureUse();
  note(Invisible::even_metallic_roughness);
  if (glass_map_of(scene_, index)) {
    maps.metallic = maps.metallic_low = maps.metallic_high = metallic;
    maps.roughness = maps.roughness_low = maps.roughness_high = roughness;
    return;
  }
  set_lobes(maps.model, stored, roughness, 0, &m);
  m.diffuse = maps.model.base * (1 - metallic);
}

bool Reducer::fold_color(std::uint32_t index) {
  Material& m = out_.materials[index];
  std::uint8_t value[4];
  if (m.diffuse_texture.texture == kNone || !has_one_value(scene_, m.diffuse_texture, value)) return false;
  const Vec3 tint = {srgb_to_linear(value[0]), srgb_to_linear(value[1]), srgb_to_linear(value[2])};
  const float alpha = static_cast<float>(value[3]) * (1.0f / 255.0f);
  const bool is_white = tint == Vec3{1, 1, 1};
  if (!is_white) {
    const bool has_lobes_from_maps =
        glass_map_of(scene_, index) || (index < out_.material_maps.size() && has_lobe_map(out_.material_maps[index]));
    const bool tints_metal = !is_zero(m.specular_tinted) || !is_zero(m.mirror_tinted);
    if (has_lobes_from_maps || (tints_metal && !out_.colors.empty())) return false;
    if (is_animated(index, ChannelPath::material_diffuse)) return false;
  }
  if (!survive_filters(m.diffuse_texture, {tint.x, tint.y, tint.z, alpha})) return false;
  const Vec3 missing = Vec3{1, 1, 1} - tint;
  // A black metal still reflects at grazing incidence, but a lobe of black would be left out.
  if (!is_zero(m.specular) && is_zero(m.specular - m.specular_tinted * missing) && m.grazing > 0) return false;
  m.diffuse *= tint, m.opacity *= alpha;
  m.specular = m.specular - m.specular_tinted * missing, m.mirror = m.mirror - m.mirror_tinted * missing;
  m.specular_tinted = min(m.specular_tinted * tint, m.specular),
  m.mirror_tinted = min(m.mirror_tinted * tint, m.mirror);
  m.diffuse_texture = TextureUse();
  return true;
}

bool Reducer::fold_emission(std::uint32_t index) {
  Material& m = out_.materials[index];
  std::uint8_t value[4];
  if (m.emission_texture.texture == kNone || !has_one_value(scene_, m.emission_texture, value)) return false;
  if (is_animated(index, ChannelPath::material_emission)) return false;
  const Vec3 color = {srgb_to_linear(value[0]), srgb_to_linear(value[1]), srgb_to_linear(value[2])};
  if (!survive_filters(m.emission_texture, {color.x, color.y, color.z})) return false;
  m.emission *= color, m.emission_texture = TextureUse();
  return true;
}

// Sets strength and roughness as find_coat() of shade/clear_coat.cpp does at every point.
void Reducer::fold_coat(std::uint32_t index) {
  if (index >= out_.clear_coats.size() || !(out_.clear_coats[index].strength > 0)) return;
  ClearCoat& coat = out_.clear_coats[index];
  if (!shows_coat(scene_, coat)) {
    coat = ClearCoat(), note(Invisible::black_coat);
    return;
  }
  std::uint8_t value[4];
  if (coat.strength_texture.texture != kNone && has_one_value(scene_, coat.strength_texture, value)) {
    coat.strength *= static_cast<float>(value[0]) / 255;
    coat.strength_texture = TextureUse();
  }
  if (coat.roughness_texture.texture == kNone || !has_one_value(scene_, coat.roughness_texture, value)) return;
  coat.roughness = std::max(coat.roughness * (static_cast<float>(value[1]) / 255), coat.roughness_low);
  coat.roughness_low = coat.roughness, coat.roughness_texture = TextureUse();
}

// Sets colour and roughness as find_sheen() of shade/sheen.cpp does at every point.
void Reducer::fold_sheen(std::uint32_t index) {
  if (index >= out_.sheens.size() || is_zero(out_.sheens[index].color)) return;
  Sheen& sheen = out_.sheens[index];
  if (!shows_sheen(scene_, sheen)) {
    sheen = Sheen(), note(Invisible::black_sheen);
    return;
  }
  std::uint8_t value[4];
  if (sheen.color_texture.texture != kNone && has_one_value(scene_, sheen.color_texture, value)) {
    const Vec3 color = {srgb_to_linear(value[0]), srgb_to_linear(value[1]), srgb_to_linear(value[2])};
    if (survive_filters(sheen.color_texture, {color.x, color.y, color.z}))
      sheen.color *= color, sheen.color_texture = TextureUse();
  }
  if (sheen.roughness_texture.texture == kNone || !has_one_value(scene_, sheen.roughness_texture, value)) return;
  const float alpha = static_cast<float>(value[3]) * (1.0f / 255);
  if (!survive_filters(sheen.roughness_texture, {alpha})) return;
  sheen.roughness = std::max(sheen.roughness * alpha, sheen.roughness_low);
  sheen.roughness_low = sheen.roughness, sheen.roughness_texture = TextureUse();
}

void Reducer::fold_grain(std::uint32_t index) {
  if (index >= out_.grains.size() || !has_strength(out_.grains[index])) return;
  Grain& grain = out_.grains[index];
  if (!shows_grain(scene_, grain)) {
    grain = Grain(), note(Invisible::black_grain);
    return;
  }
  std::uint8_t value[4];
  if (grain.texture.texture == kNone || !has_one_value(scene_, grain.texture, value)) return;
  const Vec3 numbers = {static_cast<float>(value[0]), static_cast<float>(value[1]), static_cast<float>(value[2])};
  grain.direction = turned_grain(grain.direction, numbers), grain.texture = TextureUse();
}

void Reducer::reduce_colors() {
  if (out_.colors.empty() || shows_vertex_colors(scene_)) return;
  for (const Triangle& t : out_.triangles)
    for (std::uint32_t v : t.vertices())
      if (out_.materials[t.material()].alpha_mode != AlphaMode::opaque && out_.colors[v].a != 65535) return;
  note(Invisible::white_vertex_colors, static_cast<std::uint32_t>(out_.colors.size()));
  out_.colors.clear(), scene_ = view_of(out_);
}

// Leaves out triangles that light passes, unless a body of glass may contain them or all of the scene would vanish.
void Reducer::reduce_glass() {
  std::vector<bool> is_clear(out_.materials.size());
  std::uint32_t count = 0;
  for (std::uint32_t i = 0; i < is_clear.size(); ++i) {
    is_clear[i] = passes_unchanged(scene_, i) && !is_animated(i, ChannelPath::material_diffuse) &&
                  !is_animated(i, ChannelPath::material_emission);
    if (!is_clear[i] && !is_zero(out_.materials[i].transmission)) return;
  }
  std::vector<bool> is_used(out_.materials.size());
  for (const Triangle& t : out_.triangles) is_used[t.material()] = true;
  std::vector<Triangle> kept;
  for (const Triangle& t : out_.triangles)
    if (!is_clear[t.material()]) kept.push_back(t);
  for (std::uint32_t i = 0; i < is_clear.size(); ++i) count += is_clear[i] && is_used[i];
  if (count == 0 || kept.empty()) return;
  note(Invisible::clear_glass, count);
  out_.triangles.swap(kept), scene_ = view_of(out_);
}

// Places what nodes hold as they do at time 0.
void Reducer::reduce_animations() {
  if (!holds_still(scene_)) return;
  std::vector<std::uint8_t> block(pose_need(scene_) + kArenaAlignment);
  Arena arena = make_arena("pose", block.data(), block.size());
  const Pose pose = make_pose(scene_, &arena);
  std::copy(pose.lights.begin(), pose.lights.end(), out_.lights.begin());
  std::copy(pose.cameras.begin(), pose.cameras.end(), out_.cameras.begin());
  note(Invisible::still_animation,
       static_cast<std::uint32_t>(std::count_if(out_.animation_labels.begin(), out_.animation_labels.end(),
                                                [](const AnimationLabel& label) { return label.combines == 0; })));
  if (out_.animation_labels.empty())
    note(Invisible::still_animation, static_cast<std::uint32_t>(out_.animations.size()));
  out_.animations.clear(), out_.animation_labels.clear(), out_.channels.clear();
  out_.key_times.clear(), out_.key_values.clear(), out_.weights.clear();
  out_.nodes.clear(), out_.node_visible.clear(), out_.skins.clear(), out_.joints.clear(), out_.skin_weights.clear();
  out_.moving_meshes.clear(), out_.rest_positions.clear(), out_.rest_normals.clear();
  out_.morph_positions.clear(), out_.morph_normals.clear();
  out_.info.frame_count = 1;
  scene_ = view_of(out_);
}

// Lights that nodes or channels may still change stay, and so do those without which the scene would get the default
// lights.
void Reducer::reduce_lights() {
  const bool may_change = std::any_of(out_.channels.begin(), out_.channels.end(), [](const Channel& c) {
    return c.path == ChannelPath::light_intensity || c.path == ChannelPath::light_scale;
  });
  if (may_change || out_.lights.empty()) return;
  const Box bounds = triangle_bounds(scene_);
  std::vector<Light> kept;
  std::vector<Invisible> dropped;
  for (const Light& light : out_.lights) {
    const bool is_dark = is_zero(light.intensity), is_far = !is_dark && is_out_of_range(scene_, bounds, light);
    if (is_dark || is_far)
      dropped.push_back(is_dark ? dark_light(light.kind) : distant_light(light.kind));
    else
      kept.push_back(light);
  }
  if (kept.empty()) return;
  for (Invisible what : dropped) note(what);
  out_.lights.swap(kept);
}

// Near planes before which nothing lies; a camera or a triangle that moves may still get there.
void Reducer::reduce_near_planes() {
  out_.camera_near.resize(out_.cameras.size());
  bool any = false;
  for (std::uint32_t i = 0; i < out_.cameras.size(); ++i) {
    float* distance = &out_.camera_near[i];
    if (out_.cameras[i].node == kNone && out_.moving_meshes.empty() && out_.channels.empty()) {
      CameraRays rays;
      const bool is_valid = make_camera_rays(out_.cameras[i], kNearWidth, 1, &rays).ok;
      if (is_valid) set_near_plane(*distance, scene_.positions, scene_.triangles, &rays);
      if (!is_valid || rays.near_distance == 0) *distance = 0;
    }
    any |= *distance > 0;
  }
  if (!any) out_.camera_near.clear();
}

// Returns whether resting triangles have their own normals at their vertices, to the rounding of those in files.
bool has_normals_of_faces(const Scene& scene) {
  if (scene.moving_meshes.count > 0) return false;
  for (const Triangle& t : scene.triangles) {
    const Vec3d a = to_double(scene.positions[t.vertex(0)]);
    const Vec3d across =
        cross(to_double(scene.positions[t.vertex(1)]) - a, to_double(scene.positions[t.vertex(2)]) - a);
    if (is_zero(across)) continue;  // cannot be hit
    const Vec3d face = normalize(across);
    bool any_above = false, any_below = false;
    for (std::uint32_t v : t.vertices()) {
      const Vec3d normal = normalize(to_double(scene.normals[v]));
      const double height = dot(normal, face);
      any_above |= height > 0, any_below |= height < 0;
      if (!(length(cross(normal, face)) <= kNormalRounding)) return false;
    }
    if (any_above && any_below) return false;  // the shading normal turns to the face's side only as a whole
  }
  return true;
}

void Reducer::reduce_normals() {
  if (out_.normals.empty() || (shows_vertex_normals(scene_) && !has_normals_of_faces(scene_))) return;
  const auto given = std::count_if(out_.normals.begin(), out_.normals.end(), [](const Vec3& n) { return !is_zero(n); });
  if (given > 0) note(Invisible::flat_vertex_normals, static_cast<std::uint32_t>(given));
  out_.normals.clear(), out_.rest_normals.clear(), out_.morph_normals.clear();
}

void Reducer::drop_unused_textures() {
  std::vector<bool> is_used(out_.textures.size());
  each_use(&out_, [&](const TextureUse* use) {
    if (use->texture != kNone) is_used[use->texture] = true;
  });
  if (std::find(is_used.begin(), is_used.end(), false) == is_used.end()) return;
  std::vector<std::uint32_t> place(out_.textures.size(), kNone);
  std::map<std::uint32_t, std::uint32_t> moved;  // first texels of runs, which textures may share
  std::vector<Texture> textures;
  std::vector<std::uint32_t> texels;
  for (std::size_t i = 0; i < is_used.size(); ++i) {
    if (!is_used[i]) continue;
    Texture t = out_.textures[i];
    CHECK(t.format == TexelFormat::exact);
    const std::uint32_t* from = out_.texels.data() + t.texel_begin;
    const auto known = moved.find(t.texel_begin);
    const std::uint32_t begin = known != moved.end() ? known->second : static_cast<std::uint32_t>(texels.size());
    if (known == moved.end()) texels.insert(texels.end(), from, from + level_texels(t.width, t.height, t.level_count));
    moved[t.texel_begin] = begin, t.texel_begin = begin;
    place[i] = static_cast<std::uint32_t>(textures.size());
    textures.push_back(t);
  }
  each_use(&out_, [&](TextureUse* use) {
    if (use->texture != kNone) use->texture = place[use->texture];
  });
  out_.textures.swap(textures), out_.texels.swap(texels);
}

void Reducer::reduce_all() {
  const std::size_t texture_count = out_.textures.size();
  for (std::uint32_t i = 0; i < out_.materials.size(); ++i) reduce_emission(i), reduce_alpha(i);
  reduce_colors();
  for (std::uint32_t i = 0; i < out_.materials.size(); ++i) {
    reduce_maps(i);
    fold_metallic_roughness(i);
    fold_coat(i);
    fold_sheen(i);
    note(Invisible::black_film, fold_film(scene_, i, &out_));
    note(Invisible::opaque_leaf, drop_passing(scene_, i, &out_));
    fold_grain(i);
    const bool folds_color = fold_color(i), folds_emission = fold_emission(i);
    fold_glass(scene_, i, &out_);
    if (folds_color || folds_emission) note(Invisible::even_color);
  }
  reduce_animations();
  reduce_glass();
  reduce_lights();
  reduce_near_planes();
  reduce_normals();
  drop_unused_textures();
  drop_empty_maps(&out_);
  if (texture_count > 0 && out_.textures.empty() && out_.grains.empty())
    out_.uvs.clear(), out_.second_uvs.clear(), out_.tangents.clear();
  for (std::uint32_t what = 0; what < kInvisibleCount; ++what)
    if (counts_[what] > 0) out_.reductions.push_back({static_cast<Invisible>(what), counts_[what]});
}

}  // namespace

void reduce(SceneArrays* arrays) {
  CHECK(arrays != nullptr && arrays->reductions.empty());
  Reducer(arrays).reduce_all();
}

}  // namespace pocketray
