#include "support/generated_scene.h"

#include <cmath>

#include "brdf/brdf_list.h"
#include "scene/metallic_roughness.h"

namespace pocketray {
namespace {

Vec3 random_color(Rng* rng) {
  return {0.3f + 0.6f * next_float(rng), 0.3f + 0.6f * next_float(rng), 0.3f + 0.6f * next_float(rng)};
}
Material matte(const Vec3& diffuse) {
  Material m;
  m.diffuse = diffuse;
  return m;
}

std::uint32_t add_noise_texture(GeneratedScene* s, Rng* rng, bool with_alpha) {
  std::vector<std::array<int, 4>> texels;
  for (int i = 0; i < 16; ++i) {
    auto byte = [&] { return static_cast<int>(next_u32(rng) % 256); };
    texels.push_back({byte(), byte(), byte(), with_alpha ? (byte() < 128 ? 40 : 220) : 255});
  }
  return add_texture(s, 4, 4, texels);
}

void add_floor_and_wall(GeneratedScene* s, std::uint32_t features, Rng* rng) {
  Material floor = matte(random_color(rng)), wall = matte(random_color(rng));
  if (has(features, Feature::texture)) floor.diffuse_texture.texture = add_noise_texture(s, rng, false);
  std::uint32_t f = add_material(s, floor), w = add_material(s, wall);
  add_quad(s, {-3, 0, 3}, {3, 0, 3}, {3, 0, -3}, {-3, 0, -3}, f);
  add_quad(s, {-3, 0, -2.5f}, {3, 0, -2.5f}, {3, 3, -2.5f}, {-3, 3, -2.5f}, w);
}

// Between metal and plastic, smooth enough to mirror a little everywhere.
void add_mapped_box(GeneratedScene* s, std::uint32_t features, Rng* rng) {
  const std::uint32_t material = add_material(s, matte({0.7f, 0.6f, 0.5f}));
  add_box(s, {-2.7f, 0, -2}, {-2.1f, 1.7f, -1.3f}, material);
  if (has(features, Feature::normal_map) || has(features, Feature::occlusion)) {
    s->material_maps.resize(s->materials.size());
    MaterialMaps& maps = s->material_maps[material];
    if (has(features, Feature::normal_map))
      maps.normal.texture = add_noise_texture(s, rng, false), maps.normal_scale = 0.4f;
    if (has(features, Feature::occlusion))
      maps.occlusion.texture = add_noise_texture(s, rng, false), maps.occlusion_strength = 0.8f;
  }
  if (!has(features, Feature::metallic_roughness)) return;
  std::vector<std::array<int, 4>> texels;
  for (int i = 0; i < 16; ++i)
    texels.push_back({9, 40 + static_cast<int>(next_u32(rng) % 36), static_cast<int>(next_u32(rng) % 256), 255});
  if (has(features, Feature::texture))
    s->materials[material].diffuse_texture.texture = add_noise_texture(s, rng, false);
  const std::uint32_t specular = has(features, Feature::texture) ? add_noise_texture(s, rng, true) : kNone;
  add_map(s, material, {{0.7f, 0.6f, 0.5f}, {0.04f, 0.05f, 0.06f}, 0.9f}, add_texture(s, 4, 4, texels));
  s->material_maps[material].specular.texture = s->material_maps[material].specular_color.texture = specular;
}

// Brushed, along a direction that its texture turns.
void add_brushed_box(GeneratedScene* s, std::uint32_t features, Rng* rng) {
  if (!has(features, Feature::anisotropy)) return;
  Material m = matte({0.2f, 0.25f, 0.3f});
  m.brdf = kGgx, m.specular = {0.6f, 0.5f, 0.4f}, m.grazing = 1, m.roughness = 0.1f;
  const std::uint32_t material = add_material(s, m);
  s->tangents.resize(s->positions.size());
  add_box(s, {2, 0, -2}, {2.7f, 1.5f, -1.2f}, material);
  for (std::size_t i = s->tangents.size(); i + 4 < s->positions.size(); ++i)  // not of the last side
    s->tangents.push_back(
        {static_cast<std::int8_t>(90 - 11 * (i % 4)), 60, -66, static_cast<std::int8_t>(i / 4 % 3 - 1)});
  s->grains.resize(s->materials.size());
  s->grains[material].direction = {0.6f, -0.5f};
  if (has(features, Feature::texture)) s->grains[material].texture.texture = add_noise_texture(s, rng, false);
}

// Matte, mirroring and half-mirroring coats, on surfaces of all kinds; the last one has whatever textures there are.
void add_coats(GeneratedScene* s, std::uint32_t features, Rng* rng) {
  if (!has(features, Feature::clear_coat)) return;
  s->clear_coats.resize(s->materials.size());
  const struct {
    std::uint32_t material;
    float strength, roughness;
  } coats[] = {{1, 0.8f, 0.5f}, {2, 1, 0}, {3, 0.7f, 0.2f}, {4, 0.5f, 0.1f}, {8, 0.6f, 0.4f}, {9, 1, 0.3f}};
  for (const auto& coat : coats) {
    ClearCoat& c = s->clear_coats[coat.material];
    c.strength = coat.strength, c.roughness = c.roughness_low = coat.roughness;
  }
  ClearCoat& last = s->clear_coats.back();
  last.strength = 1, last.roughness = last.roughness_low = 0.4f;
  add_box(s, {-0.3f, 0, -1.9f}, {0.5f, 1.1f, -1.1f}, static_cast<std::uint32_t>(s->materials.size() - 1));
  if (has(features, Feature::normal_map)) last.normal.texture = add_noise_texture(s, rng, false);
  last.normal_scale = 0.3f;
  if (!has(features, Feature::texture)) return;
  last.strength_texture.texture = add_noise_texture(s, rng, false);
  last.roughness_texture.texture = add_noise_texture(s, rng, false), last.roughness_low = 0.05f;
}

// Smooth to rough sheens on opaque surfaces, some of them coated; one has whatever textures there are.
void add_sheens(GeneratedScene* s, std::uint32_t features, std::uint64_t seed) {
  if (!has(features, Feature::sheen)) return;
  s->sheens.resize(s->materials.size());
  const struct {
    std::uint32_t material;
    float roughness;
  } sheens[] = {{0, 0.6f}, {1, 0}, {2, 0.9f}, {3, 0.35f}, {8, 0.5f}};
  for (const auto& sheen : sheens) {
    Sheen& made = s->sheens[sheen.material];
    made.color = {0.7f, 0.5f, 0.2f + 0.1f * static_cast<float>(sheen.material)};
    made.roughness = made.roughness_low = sheen.roughness;
  }
  if (!has(features, Feature::texture)) return;
  Rng rng = make_rng(seed + 1);  // its own: other scenes keep their numbers
  Sheen& last = s->sheens[2];
  last.color_texture.texture = add_noise_texture(s, &rng, false);
  last.roughness_texture.texture = add_noise_texture(s, &rng, true), last.roughness_low = 0.1f;
}

// The pane transmits by textures, and so does the outer sphere if it is of glass; its core is rough.
void add_glass_maps(GeneratedScene* s, std::uint32_t features, std::uint64_t seed) {
  constexpr std::uint32_t kOuter = 4, kCore = 5, kPane = 6;
  Material &outer = s->materials[kOuter], &core = s->materials[kCore], &pane = s->materials[kPane];
  auto roughen = [](Material* m, float alpha) {
    m->brdf = kGgx, m->roughness = alpha, m->grazing = 1, m->specular = {0.04f, 0.04f, 0.04f};
  };
  if (has(features, Feature::rough_refraction)) {
    if (is_zero(core.transmission)) core.diffuse = {0, 0, 0}, core.transmission = {1, 0.8f, 0.8f};
    roughen(&core, 0.16f);
    pane.diffuse = {0, 0, 0}, pane.transmission = {0.7f, 0.9f, 0.8f}, pane.thin = 1;
    roughen(&pane, 0.04f);
  }
  if (!has(features, Feature::transmission_map)) return;
  Rng rng = make_rng(seed + 2);  // its own: other scenes keep their numbers
  s->glass_maps.resize(s->materials.size()), s->material_maps.resize(s->materials.size());
  for (const std::uint32_t index : {kOuter, kPane}) {
    if (index == kOuter && is_zero(outer.transmission)) continue;
    Material& m = s->materials[index];
    MaterialMaps& maps = s->material_maps[index];
    GlassMap& glass = s->glass_maps[index];
    maps.model = {{0.8f, 0.9f, 1}, {0.04f, 0.04f, 0.04f}, 1};
    maps.metallic_high = maps.metallic = index == kPane ? 0.25f : 0, maps.metallic_low = maps.metallic;
    const bool is_rough = has(features, Feature::rough_refraction);
    maps.roughness = maps.roughness_low = maps.roughness_high = is_rough ? 0.2f : 0;
    glass.transmission = 0.8f, glass.transmission_texture.texture = add_noise_texture(s, &rng, false);
    set_lobes(maps.model, maps.metallic, maps.roughness, 0.4f, &m);
    m.brdf = kGgx;
    if (index == kOuter) continue;
    m.thin = 1, m.absorption = {0.2f, 0.9f, 1.5f}, m.diffuse_texture.texture = add_noise_texture(s, &rng, false);
    glass.thickness = 1.5f, glass.thickness_texture.texture = add_noise_texture(s, &rng, false);
  }
}

// Films on surfaces of all kinds; one has whatever textures there are.
void add_films(GeneratedScene* s, std::uint32_t features, std::uint64_t seed) {
  if (!has(features, Feature::iridescence)) return;
  s->iridescences.resize(s->materials.size());
  Material& shiny = s->materials[2];
  if (is_zero(shiny.specular) || shiny.brdf != kGgx)
    shiny.brdf = kGgx, shiny.specular = {0.5f, 0.4f, 0.3f}, shiny.roughness = 0.3f, shiny.grazing = 0.9f;
  for (const std::uint32_t material : {2u, 3u, 4u, 6u}) {
    Iridescence& film = s->iridescences[material];
    film.strength = 0.9f, film.ior = 1.2f + 0.1f * static_cast<float>(material);
    film.thickness_high = 200 + 60 * static_cast<float>(material);
  }
  if (!has(features, Feature::texture)) return;
  Rng rng = make_rng(seed + 3);
  s->iridescences[2].strength_texture.texture = add_noise_texture(s, &rng, false);
  s->iridescences[2].thickness_texture.texture = add_noise_texture(s, &rng, false);
}

// Light passes some surfaces of all kinds diffusely; one has whatever textures there are.
void add_leaves(GeneratedScene* s, std::uint32_t features, std::uint64_t seed) {
  if (!has(features, Feature::diffuse_transmission)) return;
  s->diffuse_transmissions.resize(s->materials.size());
  for (const std::uint32_t material : {1u, 2u, 6u, 7u, 8u}) {
    DiffuseTransmission& passing = s->diffuse_transmissions[material];
    passing.strength = 0.4f + 0.05f * static_cast<float>(material), passing.color = {0.9f, 0.7f, 0.2f};
  }
  if (!has(features, Feature::texture)) return;
  Rng rng = make_rng(seed + 4);
  s->diffuse_transmissions[1].strength_texture.texture = add_noise_texture(s, &rng, true);
  s->diffuse_transmissions[1].color_texture.texture = add_noise_texture(s, &rng, false);
}

void add_bodies(GeneratedScene* s, std::uint32_t features, Rng* rng) {
  Material shiny = matte(random_color(rng)), reflecting = matte(random_color(rng) * 0.5f),
           glass = matte(random_color(rng)), core = glass;
  if (has(features, Feature::specular)) shiny.specular = {0.5f, 0.4f, 0.3f}, shiny.exponent = 20;
  if (has(features, Feature::specular) && has(features, Feature::ambient))
    shiny.brdf = kGgx, shiny.roughness = 0.3f, shiny.grazing = 0.9f;
  if (has(features, Feature::mirror)) reflecting.mirror = {0.6f, 0.7f, 0.8f};
  if (has(features, Feature::refraction)) {
    glass.diffuse = core.diffuse = {0, 0, 0};
    glass.transmission = {0.9f, 0.95f, 1}, core.transmission = {1, 0.8f, 0.8f}, core.ior = 1.2f;
    if (has(features, Feature::absorption)) glass.absorption = {0.4f, 0.2f, 0.1f}, core.absorption = {0, 1.5f, 0};
  }
  add_sphere(s, {-1.3f, 0.6f, -0.4f}, 0.6f, 8, 5, add_material(s, shiny));
  add_box(s, {0.9f, 0, -1.6f}, {1.9f, 1.2f, -0.7f}, add_material(s, reflecting));
  add_sphere(s, {0.1f, 0.8f, 0.3f}, 0.7f, 8, 6, add_material(s, glass));
  add_sphere(s, {0.1f, 0.8f, 0.3f}, 0.3f, 6, 4, add_material(s, core));
}

void add_panes(GeneratedScene* s, std::uint32_t features, Rng* rng) {
  Material pane = matte(random_color(rng)), masked = matte(random_color(rng)), blended = matte(random_color(rng)),
           lamp = matte(random_color(rng));
  if (has(features, Feature::thin)) pane.diffuse = {0, 0, 0}, pane.transmission = {0.7f, 0.9f, 0.8f}, pane.thin = 1;
  if (has(features, Feature::alpha_mask)) {
    masked.alpha_mode = AlphaMode::mask;
    masked.diffuse_texture.texture = add_noise_texture(s, rng, true);
  }
  if (has(features, Feature::alpha_blend)) {
    blended.alpha_mode = AlphaMode::blend, blended.opacity = 0.6f;
    if (has(features, Feature::texture)) blended.diffuse_texture.texture = add_noise_texture(s, rng, true);
  }
  if (has(features, Feature::emission)) {
    lamp.emission = {4, 3.5f, 3};
    if (has(features, Feature::texture)) lamp.emission_texture.texture = add_noise_texture(s, rng, false);
  }
  add_quad(s, {-2.4f, 0, 0.9f}, {-1.2f, 0, 1.3f}, {-1.2f, 1.4f, 1.3f}, {-2.4f, 1.4f, 0.9f}, add_material(s, pane));
  add_quad(s, {-0.6f, 0.1f, 1.4f}, {0.2f, 0.1f, 1.5f}, {0.2f, 0.9f, 1.5f}, {-0.6f, 0.9f, 1.4f},
           add_material(s, masked));
  add_quad(s, {0.8f, 0.2f, 1}, {2, 0.2f, 0.8f}, {2, 1.4f, 0.8f}, {0.8f, 1.4f, 1}, add_material(s, blended));
  add_quad(s, {-0.7f, 2.9f, -0.7f}, {0.7f, 2.9f, -0.7f}, {0.7f, 2.9f, 0.7f}, {-0.7f, 2.9f, 0.7f},
           add_material(s, lamp));
  if (has(features, Feature::one_sided)) {  // seen from behind: visible only by its shadow
    Material back = matte(random_color(rng));
    back.double_sided = 0;
    add_quad(s, {0.7f, 1.2f, 1.7f}, {-0.3f, 1.2f, 1.7f}, {-0.3f, 1.9f, 1.7f}, {0.7f, 1.9f, 1.7f},
             add_material(s, back));
  }
}

void add_lights(GeneratedScene* s, std::uint32_t features, Rng* rng) {
  Light light;
  light.intensity = random_color(rng) * 9.0f;
  light.position = {1.5f, 2.6f, 1.8f};
  if (has(features, Feature::point_light)) s->lights.push_back(light);
  light.kind = LightKind::spot;
  light.position = {-2, 2.7f, 1.5f};
  light.direction = normalize(Vec3{1.6f, -2, -1.5f});
  light.cos_inner = 0.95f, light.cos_outer = 0.75f;
  if (has(features, Feature::spot_light)) s->lights.push_back(light);
  light.kind = LightKind::directional;
  light.direction = normalize(Vec3{0.4f, -1, -0.5f});
  light.intensity = random_color(rng) * 1.5f;
  if (has(features, Feature::directional_light)) s->lights.push_back(light);
  if (has(features, Feature::ambient)) s->scene.info.ambient = random_color(rng) * 0.2f;
}

// The box moves to and fro, and the first light with it.
void add_motion(GeneratedScene* s, std::uint32_t first_vertex, std::uint32_t vertex_count) {
  s->nodes.resize(1);
  s->key_times = {0, 1, 2};
  s->key_values = {0, 0, 0, -0.5f, 0.4f, 0.3f, 0, 0, 0};
  s->channels = {{0, 0, 3, 0, ChannelPath::translation, Interpolation::linear}};
  s->animations = {{0, 1, 2}};
  MovingMesh mesh = {};
  mesh.vertex_begin = first_vertex, mesh.vertex_count = vertex_count;
  mesh.skin = kNone;
  mesh.instance = Transform();
  s->moving_meshes = {mesh};
  s->rest_positions.assign(s->positions.begin() + first_vertex, s->positions.begin() + first_vertex + vertex_count);
  s->rest_normals.assign(s->normals.begin() + first_vertex, s->normals.begin() + first_vertex + vertex_count);
  if (!s->lights.empty()) s->lights[0].node = 0;
}

// Levels for all textures, each repeated until pixels cover several texels.
void add_mip_maps(GeneratedScene* s) {
  auto repeat = [](TextureUse* use) { use->m[0][0] = use->m[1][1] = 9; };
  for (std::uint32_t i = 0; i < s->textures.size(); ++i) add_levels(s, i);
  for (Material& m : s->materials) repeat(&m.diffuse_texture), repeat(&m.emission_texture);
  for (MaterialMaps& maps : s->material_maps)
    repeat(&maps.metallic_roughness), repeat(&maps.occlusion), repeat(&maps.specular);
  for (ClearCoat& coat : s->clear_coats) repeat(&coat.strength_texture), repeat(&coat.roughness_texture);
  for (Sheen& sheen : s->sheens) repeat(&sheen.color_texture), repeat(&sheen.roughness_texture);
  for (DiffuseTransmission& passing : s->diffuse_transmissions)
    repeat(&passing.strength_texture), repeat(&passing.color_texture);
  for (GlassMap& glass : s->glass_maps) repeat(&glass.transmission_texture), repeat(&glass.thickness_texture);
}

// Two textures of three read the second coordinates, but those of normals cannot.
void add_second_uvs(GeneratedScene* s) {
  for (std::size_t i = 0; i < s->textures.size(); ++i) s->textures[i].uv_set = i % 3 != 1;
  for (const MaterialMaps& maps : s->material_maps)
    if (maps.normal.texture != kNone) s->textures[maps.normal.texture].uv_set = 0;
  for (const ClearCoat& coat : s->clear_coats)
    if (coat.normal.texture != kNone) s->textures[coat.normal.texture].uv_set = 0;
}

}  // namespace

std::unique_ptr<GeneratedScene> generate_scene(std::uint32_t features, std::uint64_t seed) {
  auto s = std::make_unique<GeneratedScene>();
  Rng rng = make_rng(seed);
  add_floor_and_wall(s.get(), features, &rng);
  std::uint32_t first_vertex = static_cast<std::uint32_t>(s->positions.size());
  add_bodies(s.get(), features, &rng);
  std::uint32_t vertex_count = static_cast<std::uint32_t>(s->positions.size()) - first_vertex;
  add_panes(s.get(), features, &rng);
  add_mapped_box(s.get(), features, &rng);
  add_brushed_box(s.get(), features, &rng);
  add_coats(s.get(), features, &rng);
  add_sheens(s.get(), features, seed);
  add_glass_maps(s.get(), features, seed);
  add_films(s.get(), features, seed);
  add_leaves(s.get(), features, seed);
  if (!s->material_maps.empty()) s->material_maps.resize(s->materials.size());
  if (!s->grains.empty()) s->grains.resize(s->materials.size());
  if (has(features, Feature::mip_map)) add_mip_maps(s.get());
  if (has(features, Feature::second_uv)) add_second_uvs(s.get());
  add_lights(s.get(), features, &rng);
  if (has(features, Feature::animation)) add_motion(s.get(), first_vertex, vertex_count);
  aim(s.get(), {0.3f, 1.6f, 4.6f}, {0, 1, 0}, 50);
  s->scene.info.background = {0.1f, 0.15f, 0.2f};
  s->with_normals = has(features, Feature::smooth_normal);
  s->with_uvs = !s->textures.empty() || has(features, Feature::anisotropy);
  s->with_second_uvs = has(features, Feature::second_uv) && !s->textures.empty();
  s->with_colors = has(features, Feature::vertex_color);
  s->bind();
  return s;
}

Settings settings_for(std::uint32_t features, std::uint32_t width, std::uint32_t height) {
  Settings settings;
  settings.width = width;
  settings.height = height;
  settings.samples_per_pixel = has(features, Feature::supersampling) ? 2 : 1;
  const std::uint32_t lit = features & ~bit(Feature::second_uv) & ~bit(Feature::clear_coat) & ~bit(Feature::sheen) &
                            ~bit(Feature::transmission_map) & ~bit(Feature::rough_refraction) &
                            ~bit(Feature::iridescence) & ~bit(Feature::diffuse_transmission);
  settings.points_per_area_light = lit % 3 == 0 ? 9 : 2;  // in groups, or tested one by one
  return settings;
}

}  // namespace pocketray
