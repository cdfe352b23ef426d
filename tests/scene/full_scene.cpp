#include "scene/full_scene.h"

#include <cmath>
#include <cstring>

using namespace pocketray;

namespace {

template <class T>
Array<const T> view(const std::vector<T>& v) {
  return {v.data(), static_cast<std::uint32_t>(v.size())};
}
Vec3 point(Rng* rng) { return {next_float(rng) * 8 - 4, next_float(rng) * 8 - 4, next_float(rng) * 8 - 4}; }
Vec3 color(Rng* rng) { return {next_float(rng), next_float(rng), next_float(rng)}; }
Vec3 unit(Rng* rng) { return normalize(point(rng) + Vec3{9, 0, 0}); }

void make_surface(Rng* rng, std::uint32_t vertex_count, std::uint32_t triangle_count, FullScene* f) {
  for (std::uint32_t i = 0; i < vertex_count; ++i) {
    f->positions.push_back(point(rng));
    f->normals.push_back(i % 5 ? unit(rng) : Vec3{0, 0, 0});
    f->uvs.push_back({next_float(rng), next_float(rng)});
    auto channel = [&] { return static_cast<std::uint16_t>(next_u32(rng)); };
    f->colors.push_back({channel(), channel(), channel(), channel()});
  }
  for (std::uint32_t i = 0; i < triangle_count; ++i)
    f->triangles.push_back(
        {next_u32(rng) % vertex_count, next_u32(rng) % vertex_count, next_u32(rng) % vertex_count, i % 3});
  Material plain, rich;
  rich.specular = color(rng), rich.mirror = color(rng), rich.transmission = color(rng),
  rich.absorption = color(rng) * 9.0f;
  rich.specular_tinted = rich.specular * 0.5f, rich.mirror_tinted = rich.mirror, rich.roughness = 0.3f;
  rich.grazing = 0.9f;
  rich.emission = color(rng) * 100.0f, rich.exponent = 30, rich.opacity = 0.5f, rich.brdf = 1, rich.thin = 1;
  rich.double_sided = 0, rich.alpha_mode = AlphaMode::blend;
  rich.diffuse_texture.texture = 0, rich.emission_texture.texture = 1;
  f->materials = {plain, rich};
  f->textures = {{0, 3, 2, Wrap::repeat, Wrap::clamp, 1, 2}, {7, 1, 4, Wrap::mirror, Wrap::repeat, 0, 3}};
  f->materials.push_back(plain);
  f->materials[2].specular = {0.5f, 0.75f, 1};
  f->material_maps.resize(3);
  MaterialMaps& maps = f->material_maps[2];
  maps.model = {{1, 0.5f, 0.25f}, {0.04f, 0.05f, 0}, 0.75f};
  maps.metallic_roughness.texture = 1, maps.metallic = 0.75f, maps.roughness = 1;
  maps.metallic_low = 0.25f, maps.metallic_high = 0.75f, maps.roughness_low = 0.125f, maps.roughness_high = 1;
  maps.specular.texture = 0, maps.specular_color.texture = 1;
  maps.normal.texture = 0, maps.normal_scale = -0.5f, maps.occlusion.texture = 1, maps.occlusion_strength = 0.75f;
  for (int i = 0; i < 10; ++i) f->texels.push_back(next_u32(rng));
  f->texels.insert(f->texels.end(), {0x80402010u, 0xFF00FF00u, 0x01020304u, 0xFFFFFFFFu});
}

void make_motion(Rng* rng, std::uint32_t vertex_count, FullScene* f) {
  Node root, arm, face;
  arm.parent = 0, arm.translation = point(rng), arm.rotation = {0, 0, 0.6f, 0.8f};
  face.parent = 1, face.scale = {1, 2, 3}, face.weight_begin = 0, face.weight_count = 2;
  f->nodes = {root, arm, face};
  f->weights = {0.25f, 0.5f};
  f->key_times = {0, 0.5f, 2};
  for (int i = 0; i < 3 * 3 * 4; ++i) f->key_values.push_back(next_float(rng) + 0.1f);
  f->channels = {{0, 0, 3, 0, ChannelPath::translation, Interpolation::cubic},
                 {1, 0, 3, 5, ChannelPath::rotation, Interpolation::linear},
                 {2, 1, 2, 9, ChannelPath::weights, Interpolation::step},
                 {1, 0, 2, 2, ChannelPath::scale, Interpolation::linear}};
  f->channels.insert(f->channels.end(), {{1, 0, 3, 0, ChannelPath::visibility, Interpolation::step},
                                         {0, 0, 3, 0, ChannelPath::light_intensity, Interpolation::linear},
                                         {0, 0, 3, 0, ChannelPath::light_scale, Interpolation::cubic},
                                         {1, 0, 3, 3, ChannelPath::camera_size, Interpolation::linear},
                                         {1, 0, 3, 0, ChannelPath::material_diffuse, Interpolation::linear},
                                         {2, 0, 3, 0, ChannelPath::material_emission, Interpolation::step}});
  f->animations = {{0, 3, 2}, {3, 1, 0.5f}, {4, 6, 2}};
  f->animation_labels = {{"both", "0, 1", 1}, {"sway", "node 2 (weights)", 0}, {"dim", "light 0 (intensity)", 0}};
  f->node_visible.assign(3, 1);
  f->origin = {{431250.37, 120.5, -5411875.62}};
  f->joints = {{0, Transform()}, {1, Transform()}};
  f->joints[1].inverse_bind.m[0][3] = -1;
  f->skins = {{0, 2}};
  MovingMesh skinned = {vertex_count - 8, 4, 0, 2, 0, 0, 0, 2, Transform()};
  MovingMesh instance = {vertex_count - 4, 4, 2, 1, kNone, 0, 0, 0, Transform()};
  instance.instance.m[0][0] = -2, instance.instance.m[1][3] = 7;
  f->moving_meshes = {skinned, instance};
  for (int i = 0; i < 6; ++i) f->rest_positions.push_back(point(rng)), f->rest_normals.push_back(unit(rng));
  for (int i = 0; i < 4; ++i) f->skin_weights.push_back({{0, 1, 0, 0}, {0.25f, 0.75f, 0, 0}});
  for (int i = 0; i < 8; ++i) f->morph_positions.push_back(point(rng)), f->morph_normals.push_back(color(rng));
}

}  // namespace

void FullScene::bind() {
  scene.positions = view(positions), scene.normals = view(normals), scene.uvs = view(uvs), scene.colors = view(colors);
  scene.triangles = view(triangles), scene.materials = view(materials), scene.material_maps = view(material_maps),
  scene.textures = view(textures);
  scene.texels = view(texels), scene.lights = view(lights), scene.cameras = view(cameras), scene.nodes = view(nodes);
  scene.animations = view(animations), scene.channels = view(channels), scene.key_times = view(key_times);
  scene.key_values = view(key_values), scene.weights = view(weights), scene.skins = view(skins);
  scene.joints = view(joints), scene.moving_meshes = view(moving_meshes), scene.rest_positions = view(rest_positions);
  scene.rest_normals = view(rest_normals), scene.skin_weights = view(skin_weights);
  scene.morph_positions = view(morph_positions), scene.morph_normals = view(morph_normals), scene.accel = view(accel);
  scene.radiosity_info = view(radiosity_info), scene.radiosity_triangles = view(radiosity_triangles);
  scene.radiosity_grids = view(radiosity_grids), scene.radiosity_nodes = view(radiosity_nodes);
  scene.radiosity_corners = view(radiosity_corners), scene.radiosity_values = view(radiosity_values);
  scene.radiosity_splits = view(radiosity_splits), scene.radiosity_cuts = view(radiosity_cuts);
  scene.reductions = view(reductions);
  scene.environment_info = view(environment_info), scene.environment_texels = view(environment_texels);
  scene.grains = view(grains), scene.tangents = view(tangents), scene.second_uvs = view(second_uvs);
  scene.glass_maps = view(glass_maps), scene.iridescences = view(iridescences);
  scene.sheens = view(sheens), scene.clear_coats = view(clear_coats), scene.default_view = view(default_view);
  scene.framings = view(framings);
  scene.camera_near = view(camera_near), scene.environment_suns = view(environment_suns);
  scene.diffuse_transmissions = view(diffuse_transmissions);
  scene.animation_labels = view(animation_labels), scene.node_visible = view(node_visible);
  scene.origin = view(origin);
}

void make_full_scene(std::uint64_t seed, std::uint32_t vertex_count, std::uint32_t triangle_count, FullScene* full) {
  Rng rng = make_rng(seed);
  std::strcpy(full->scene.info.name, "everything");
  full->scene.info.background = color(&rng), full->scene.info.ambient = color(&rng), full->scene.info.frame_count = 60;
  make_surface(&rng, vertex_count, triangle_count, full);
  make_motion(&rng, vertex_count, full);
  Light lamp, spot, sun;
  lamp.node = 1, lamp.range = 5, spot.kind = LightKind::spot, spot.cos_inner = 0.9f, spot.cos_outer = 0.7f;
  sun.kind = LightKind::directional, sun.direction = unit(&rng);
  full->lights = {lamp, spot, sun};
  Camera still, flying;
  flying.node = 1, flying.projection = Projection::orthographic;
  full->cameras = {still, flying};
  full->camera_near = {0, 0.25f};
  full->radiosity_info = {{{3, 3, 3}}};
  full->radiosity_triangles.assign(full->triangles.size(), kRadiosityGridBit);
  full->radiosity_triangles[1] = 0;
  full->radiosity_triangles[2] = kRadiositySplitBit | 1u << kRadiosityTurnShift;
  full->radiosity_splits = {{{0, 0}}};
  full->radiosity_triangles[3] = kRadiosityCutBits;
  full->radiosity_cuts = {{{0, 1, 0}, {0, 0, 1}, {kRadiosityGridBit, kRadiosityGridBit}}};
  full->reductions = {{Invisible::opaque_blend, 2}};
  full->radiosity_grids = {{{0, 1, 0}, {1, 0, 0}, {0, 0, 1}, 2, 2, 0}};
  full->radiosity_nodes.assign(4, {{1, 2, 3}, {.5f, .25f, 0}, {0, .5f, .25f}, {.125f, 0, 0}});
  full->radiosity_corners = {{{0, 1, 2}}};
  full->radiosity_values.assign(3, {1, 2, .5f});
  EnvironmentInfo environment;
  environment.scale = 0.5f, environment.side = environment.gloss_side = 4, environment.radiance_max = {9, 9, 9};
  for (Vec3& coefficient : environment.irradiance) coefficient = color(&rng);
  full->environment_info = {environment};
  full->environment_suns = {{2, 0.005f, 0.75f, 4}};
  for (std::uint32_t i = 0; i < environment_texel_count(4, 4); ++i)
    full->environment_texels.push_back(to_environment_texel(to_double(color(&rng)) * 9.0));
  full->grains.resize(full->materials.size());
  full->grains[2].direction = {0.6f, -0.8f}, full->grains[2].texture.texture = 1;
  full->tangents.assign(vertex_count, {127, 0, -3, 0});
  for (const Vec2& uv : full->uvs) full->second_uvs.push_back({1 - uv.y, uv.x});
  full->textures[1].uv_set = 1;
  full->clear_coats.resize(full->materials.size());
  ClearCoat& coat = full->clear_coats[1];
  coat.strength = 0.75f, coat.roughness = 0.5f, coat.roughness_low = 0.25f, coat.normal_scale = -2;
  coat.strength_texture.texture = coat.roughness_texture.texture = 1, coat.normal.texture = 0;
  full->glass_maps.resize(full->materials.size()), full->iridescences.resize(full->materials.size());
  GlassMap& glass = full->glass_maps[0];
  glass.thickness = 0.75f, glass.transmission_texture.texture = 0, glass.thickness_texture.texture = 1;
  Iridescence& film = full->iridescences[1];
  film.strength = 0.5f, film.ior = 1.25f, film.thickness_low = 50, film.thickness_high = 600;
  film.strength_texture.texture = 1, film.thickness_texture.texture = 0;
  full->diffuse_transmissions.resize(full->materials.size());
  DiffuseTransmission& passing = full->diffuse_transmissions[1];
  passing.strength = 0.5f, passing.color = {0.25f, 0.5f, 1};
  passing.strength_texture.texture = 0, passing.color_texture.texture = 1;
  full->sheens.resize(full->materials.size());
  Sheen& sheen = full->sheens[1];
  sheen.color = {0.75f, 0.5f, 0.25f}, sheen.roughness = 0.5f, sheen.roughness_low = 0.25f;
  sheen.color_texture.texture = 0, sheen.roughness_texture.texture = 1;
  full->default_view = {{1, 2, {0, 0.6f, -0.8f}, 0.5f}};
  full->framings = {{{1, 2, 3}, {1, 2, -4}, {0, 0.6f, 0.8f}, {}}};
  for (auto& side : full->framings[0].reach)
    for (float& reach : side) reach = next_float(&rng);
  for (int i = 0; i < 37; ++i) full->accel.push_back(static_cast<std::uint8_t>(next_u32(&rng)));
  full->bind();
}
