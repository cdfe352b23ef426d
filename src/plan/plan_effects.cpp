#include "plan/plan_effects.h"

#include <cstring>

#include "base/check.h"
#include "base/limit_list.h"
#include "brdf/clear_coat.h"
#include "effect/effect_list.h"
#include "effect/setting_list.h"
#include "indirect/environment.h"
#include "indirect/environment_lights.h"
#include "indirect/indirect_list.h"
#include "scene/metallic_roughness.h"
#include "shade/point_groups.h"
#include "shade/texture.h"

namespace pocketray {
namespace {

// Counts of materials with a property, among those that triangles use.
struct Census {
  std::uint32_t materials = 0, specular = 0, mirror = 0, transmitting = 0, absorbing = 0, masked = 0, blended = 0,
                emissive = 0, unlit = 0, textured = 0, scattering = 0, one_sided = 0, reflecting = 0, diffuse = 0,
                metallic_roughness = 0, bumpy = 0, occluded = 0, with_levels = 0, grained = 0, second_uv = 0,
                second_uv_occlusion = 0,  // of the latter, only that of occlusion
      coated = 0;
  std::uint32_t lights[3] = {0, 0, 0};
};

// Whether a texture of the material's clear coat has a property.
template <class Property>
bool any_of_coat(const Scene& scene, std::uint32_t material, Property property) {
  const ClearCoat* coat = coat_of(scene, material);
  return coat && (property(coat->strength_texture) || property(coat->roughness_texture) || property(coat->normal));
}

bool reads_levels(const Scene& scene, std::uint32_t material) {
  auto has_levels = [&](const TextureUse& use) {
    return use.texture != kNone && scene.textures[use.texture].level_count > 1;
  };
  const Material& m = scene.materials[material];
  if (has_levels(m.diffuse_texture) || has_levels(m.emission_texture)) return true;
  if (scene.grains.count && has_levels(scene.grains[material].texture)) return true;
  if (any_of_coat(scene, material, has_levels)) return true;
  if (scene.material_maps.empty()) return false;
  const MaterialMaps& maps = scene.material_maps[material];
  return has_levels(maps.metallic_roughness) || has_levels(maps.specular) || has_levels(maps.specular_color) ||
         has_levels(maps.normal) || has_levels(maps.occlusion);
}

// Whether a texture other than that of occlusion reads the second texture coordinates.
bool reads_second(const Scene& scene, std::uint32_t material) {
  auto second = [&](const TextureUse& use) { return use.texture != kNone && reads_second_uvs(scene, use); };
  const Material& m = scene.materials[material];
  if (second(m.diffuse_texture) || second(m.emission_texture)) return true;
  if (scene.grains.count && second(scene.grains[material].texture)) return true;
  if (any_of_coat(scene, material, second)) return true;
  if (scene.material_maps.empty()) return false;
  const MaterialMaps& maps = scene.material_maps[material];
  return second(maps.metallic_roughness) || second(maps.specular) || second(maps.specular_color);
}

// If emission is forced off, unlit materials scatter like others.
Census take_census(const Scene& scene, const Settings& settings) {
  CHECK_LE(scene.materials.count, kMaterialCountMax);
  CHECK(scene.material_maps.empty() || scene.material_maps.count == scene.materials.count);
  bool shows_unlit = !has(settings.forced_off, Effect::emission);
  Census c;
  std::uint32_t used[kMaterialCountMax / 32] = {};
  for (const Triangle& t : scene.triangles) used[t.material() / 32] |= 1u << t.material() % 32;
  for (std::uint32_t i = 0; i < scene.materials.count; ++i) {
    if (!(used[i / 32] >> i % 32 & 1)) continue;
    const Material m =
        scene.material_maps.count ? lobe_bounds(scene.materials[i], scene.material_maps[i]) : scene.materials[i];
    const ClearCoat* coat = coat_of(scene, i);
    const bool shines = coat && has_lobe(*coat);
    bool is_bumpy = coat && coat->normal.texture != kNone;
    if (scene.material_maps.count) {
      const MaterialMaps& maps = scene.material_maps[i];
      c.metallic_roughness += has_lobe_map(maps);
      is_bumpy |= maps.normal.texture != kNone, c.occluded += maps.occlusion.texture != kNone;
    }
    c.bumpy += is_bumpy, c.coated += coat != nullptr;
    c.grained += !is_zero(m.specular) && has_grain(scene, i);
    c.with_levels += reads_levels(scene, i);
    if (reads_second(scene, i))
      ++c.second_uv;
    else if (scene.material_maps.count && scene.material_maps[i].occlusion.texture != kNone)
      c.second_uv_occlusion += reads_second_uvs(scene, scene.material_maps[i].occlusion);
    bool transmits = !is_zero(m.transmission);
    ++c.materials;
    c.specular += !is_zero(m.specular) || shines;
    c.mirror += !is_zero(m.mirror) || (coat && has_mirror(*coat));
    c.transmitting += transmits;
    c.absorbing += transmits && !m.thin && !is_zero(m.absorption);
    c.masked += m.alpha_mode == AlphaMode::mask;
    c.blended += m.alpha_mode == AlphaMode::blend;
    c.emissive += !is_zero(m.emission);
    c.unlit += m.unlit;
    c.textured += m.diffuse_texture.texture != kNone || m.emission_texture.texture != kNone;
    c.reflecting += reflects_surroundings(m) || shines;
    c.diffuse += !(m.unlit && shows_unlit) && !is_zero(m.diffuse);
    c.one_sided += !m.double_sided && !transmits;
    c.scattering += !(m.unlit && shows_unlit) && (!is_zero(m.diffuse) || !is_zero(m.specular) || shines);
  }
  for (const Light& light : scene.lights) ++c.lights[static_cast<int>(light.kind)];
  return c;
}

struct PlanWriter {
  EffectPlan* plan;
  std::uint32_t material_count;

  void set(Effect effect, bool on, const char* format, ...) __attribute__((format(printf, 4, 5))) {
    EffectDecision& d = plan->decisions[static_cast<int>(effect)];
    d.on = on;
    va_list arguments;
    va_start(arguments, format);
    std::vsnprintf(d.reason, sizeof d.reason, format, arguments);
    va_end(arguments);
  }
  void set_by_materials(Effect effect, std::uint32_t count, const char* verb) {
    if (count)
      set(effect, true, "%u of %u materials %s", count, material_count, verb);
    else
      set(effect, false, "none of %u materials %s", material_count, verb);
  }
  void set_by_count(Effect effect, std::uint32_t count, const char* what) {
    if (count)
      set(effect, true, "%u %s%s", count, what, count == 1 ? "" : "s");
    else
      set(effect, false, "no %s", what);
  }
};

bool is_asked_for(const IndirectInfo& info, const Settings& settings) {
  return settings.indirect == indirect_choice(static_cast<Effect>(__builtin_ctzll(info.effects)));
}

// The method that --indirect asks for, or else the last one that the scene has by default; null: none. Without what the
// method takes, the choice is as for auto.
const IndirectInfo* choose_indirect(const Scene& scene, const Settings& settings) {
  if (settings.indirect == IndirectChoice::none) return nullptr;
  const IndirectInfo* chosen = nullptr;
  for (const IndirectInfo& info : IndirectList::kInfos) {
    if (!info.effects || (settings.forced_off & info.effects) || info.use(scene) == IndirectUse::nothing) continue;
    if (is_asked_for(info, settings)) return &info;
    if (info.use(scene) == IndirectUse::automatic) chosen = &info;
  }
  return chosen;
}

// Methods stand in for the same light, so a plan has only one of them. --effects cannot force another.
void decide_indirect(const IndirectInfo& info, const IndirectInfo* chosen, const Scene& scene, const Settings& settings,
                     PlanWriter* w) {
  Effect effect = static_cast<Effect>(__builtin_ctzll(info.effects));
  const bool has_any = info.use(scene) != IndirectUse::nothing;
  if (&info == chosen || !has_any || (settings.forced_off & info.effects))
    w->set(effect, has_any, "%s", has_any ? info.present : info.absent);
  else if (settings.indirect == IndirectChoice::none)
    w->set(effect, false, "no indirect light requested");
  else
    w->set(effect, false, chosen ? "%s instead" : "%s", chosen ? chosen->name : info.present);
}

// Shadows from the environment are traced for its diffuse light, pixel by pixel.
void decide_environment_shadow(const Scene& scene, const Settings& settings, const IndirectInfo* indirect,
                               std::uint32_t diffuse_count, PlanWriter* w) {
  auto off = [w](const char* reason) { w->set(Effect::environment_shadow, false, "%s", reason); };
  if (!environment_of(scene) || has(settings.forced_off, Effect::environment)) return off("no environment");
  if (settings.indirect == IndirectChoice::none) return off("no indirect light requested");
  if (indirect && has(indirect->effects, Effect::radiosity)) return off("radiosity stores them");
  if (default_lights_cast_shadows(scene)) return off("the default lights cast shadows");
  if (settings.environment_shadows == 0) return off("--environment-shadows 0");
  if (settings.selective_contrast > 0) return off("selective rendering interpolates pixels");
  if (settings.resolution != Resolution::full) return off("undersampling reconstructs pixels");
  w->set_by_materials(Effect::environment_shadow, diffuse_count, "are diffuse");
}

}  // namespace

EffectPlan plan_effects(const Scene& scene, const Settings& settings) {
  CHECK(within(Quantity::contrast, settings.selective_contrast));
  CHECK(settings.resolution <= Resolution::half);
  Census c = take_census(scene, settings);
  EffectPlan plan;
  PlanWriter w = {&plan, c.materials};
  w.set_by_materials(Effect::specular, c.specular, "shine");
  w.set_by_materials(Effect::mirror, c.mirror, "mirror");
  w.set_by_materials(Effect::refraction, c.transmitting, "transmit");
  w.set_by_materials(Effect::absorption, c.absorbing, "absorb");
  w.set_by_materials(Effect::alpha_mask, c.masked, "have holes");
  w.set_by_materials(Effect::alpha_blend, c.blended, "blend with the background");
  w.set_by_materials(Effect::emission, c.emissive + c.unlit, c.unlit ? "emit or are unlit" : "emit");
  w.set_by_materials(Effect::texture, c.textured, "have a texture");
  w.set_by_materials(Effect::metallic_roughness, c.metallic_roughness, "have a metallic-roughness or specular texture");
  w.set_by_materials(Effect::normal_map, c.bumpy, "have a normal texture");
  w.set_by_materials(Effect::anisotropy, c.grained, "have a grain");
  w.set_by_materials(Effect::clear_coat, c.coated, "have a clear coat");
  if (takes_levels(settings.texture_filter))
    w.set_by_materials(Effect::mip_map, c.with_levels, "have a texture with levels");
  else
    w.set(Effect::mip_map, false, "--texture-filter %s",
          kTextureFilterNames[static_cast<int>(settings.texture_filter)]);
  w.set_by_materials(Effect::back_face_culling, c.one_sided, "are one-sided");
  w.set_by_materials(Effect::area_light, c.emissive, "emit light");
  w.set_by_count(Effect::point_light, c.lights[static_cast<int>(LightKind::point)], "point light");
  w.set_by_count(Effect::spot_light, c.lights[static_cast<int>(LightKind::spot)], "spot light");
  w.set_by_count(Effect::directional_light, c.lights[static_cast<int>(LightKind::directional)], "directional light");
  bool lit = scene.lights.count > 0 || c.emissive > 0;
  if (lit && c.scattering)
    w.set(Effect::shadow, true, "lit, and %u of %u materials scatter", c.scattering, c.materials);
  else
    w.set(Effect::shadow, false, lit ? "no material scatters light" : "no light");
  bool colored = scene.colors.count > 0, smooth = scene.normals.count > 0 && settings.normals == NormalMode::as_scene;
  w.set(Effect::vertex_color, colored, colored ? "vertices have colours" : "no vertex has a colour");
  w.set(Effect::smooth_normal, smooth,
        smooth                ? "vertices have normals"
        : scene.normals.count ? "flat normals requested"
                              : "no vertex has a normal");
  const IndirectInfo* indirect = choose_indirect(scene, settings);
  for (const IndirectInfo& info : IndirectList::kInfos)
    if (info.effects) decide_indirect(info, indirect, scene, settings, &w);
  const EffectMask replaces_environment = environment_of(scene) ? bit(Effect::radiosity) : 0;  // its diffuse light
  const EffectMask excluded_indirect = indirect ? kIndirectEffects & ~indirect->effects
                                       : settings.indirect == IndirectChoice::none
                                           ? kIndirectEffects | bit(Effect::ambient_gloss)
                                           : bit(Effect::instant_radiosity) | replaces_environment;
  const std::uint32_t light_count = c.emissive + scene.lights.count;
  const bool selects = settings.light_tolerance > 0 && light_count >= kSelectedLightsMin;
  if (c.emissive && !selects && settings.area_shadows == AreaShadows::adaptive &&
      settings.points_per_area_light > kUndividedMax)
    w.set(Effect::area_light, true, "%u of %u materials emit light: %u points each, all tested where partly hidden",
          c.emissive, c.materials, settings.points_per_area_light);
  if (const EnvironmentInfo* environment = environment_of(scene))
    w.set(Effect::environment, true, "%s%u×%u texels, radiance at most %.3g",
          scene.info.default_lights != 0 ? "no light of the scene's own: a studio, " : "", environment->side,
          environment->side, static_cast<double>(max_component(environment->radiance_max)));
  else
    w.set(Effect::environment, false, "no environment");
  decide_environment_shadow(scene, settings, indirect, c.diffuse, &w);
  const bool shows_environment = environment_of(scene) && !has(settings.forced_off, Effect::environment);
  if (settings.indirect == IndirectChoice::none)
    w.set(Effect::ambient_gloss, false, "no indirect light requested");
  else if (shows_environment)
    w.set(Effect::ambient_gloss, false, "%s instead", kEffectList[static_cast<int>(Effect::environment)].name);
  else if (is_zero(radiance_of_surroundings(scene.info)))
    w.set(Effect::ambient_gloss, false, "no ambient light or background");
  else
    w.set_by_materials(Effect::ambient_gloss, c.reflecting, "reflect the surroundings");
  if (plan.decisions[static_cast<int>(Effect::ambient)].on ||
      plan.decisions[static_cast<int>(Effect::ambient_gloss)].on ||
      (shows_environment && settings.indirect != IndirectChoice::none))
    w.set_by_materials(Effect::occlusion, c.occluded, "have an occlusion texture");
  else
    w.set(Effect::occlusion, false, "no ambient light");
  const bool occludes = plan.decisions[static_cast<int>(Effect::occlusion)].on;
  w.set_by_materials(Effect::second_uv, c.second_uv + (occludes ? c.second_uv_occlusion : 0),
                     "use second texture coordinates");
  w.set(Effect::supersampling, settings.samples_per_pixel > 1, "%u sample%s per pixel", settings.samples_per_pixel,
        settings.samples_per_pixel == 1 ? "" : "s");
  if (settings.selective_contrast > 0 && indirect && has(indirect->effects, Effect::instant_radiosity))
    w.set(Effect::selective, false, "instant radiosity needs every pixel");
  else if (settings.selective_contrast > 0)
    w.set(Effect::selective, true, "contrasts below %.3g interpolated",
          static_cast<double>(settings.selective_contrast));
  else
    w.set(Effect::selective, false, "every pixel traced");
  const bool full = settings.resolution == Resolution::full;
  if (!full && indirect && has(indirect->effects, Effect::instant_radiosity))
    w.set(Effect::undersampling, false, "instant radiosity needs every pixel");
  else
    w.set(Effect::undersampling, !full, "%s of the pixels traced",
          full                                      ? "all"
          : settings.resolution == Resolution::half ? "a quarter"
                                                    : "half");
  if (settings.light_tolerance == 0)
    w.set(Effect::source_selection, false, "every light tested for shadows");
  else if (selects)
    w.set(Effect::source_selection, true, "%u lights: the strongest tested for shadows, error ≤ %.3g of the light",
          light_count, static_cast<double>(settings.light_tolerance));
  else
    w.set(Effect::source_selection, false, "%u light%s: each tested for shadows", light_count,
          light_count == 1 ? "" : "s");
  bool animated = is_animated(scene);
  w.set(Effect::animation, animated, animated ? "%u animation%s" : "nothing moves", scene.animations.count,
        scene.animations.count == 1 ? "" : "s");

  for (int i = 0; i < kEffectCount; ++i) {
    Effect effect = static_cast<Effect>(i);
    EffectDecision& d = plan.decisions[i];
    CHECK(d.reason[0] != 0);  // every effect has been decided
    EffectMask forced_on = settings.forced_on & ~excluded_indirect;
    forced_on &= ~bit(Effect::environment_shadow);  // it has all that it takes, or is off
    if (!selects) forced_on &= ~bit(Effect::source_selection);
    bool on = (d.on || has(forced_on, effect)) && !has(settings.forced_off, effect);
    if (on != d.on) {
      char reason[sizeof d.reason];
      std::snprintf(reason, sizeof reason, "%s (%.60s)", on ? "forced on" : "forced off", d.reason);
      std::memcpy(d.reason, reason, sizeof reason);
      d.on = on;
    }
    if (on) plan.mask |= bit(effect);
  }
  return plan;
}

Status parse_effects(const char* text, Settings* settings) {
  CHECK(text != nullptr && settings != nullptr);
  settings->forced_on = settings->forced_off = 0;
  bool automatic = false, named = false;
  for (const char* at = text;;) {
    const char* end = std::strchr(at, ',');
    std::size_t count = end ? static_cast<std::size_t>(end - at) : std::strlen(at);
    bool minus = count > 0 && *at == '-';
    const char* name = at + minus;
    std::size_t name_count = count - minus;
    auto is = [&](const char* word) {
      return std::strlen(word) == name_count && std::memcmp(word, name, name_count) == 0;
    };
    EffectMask mask = 0;
    if (is("auto") && !minus) {
      automatic = true;
    } else if (is("all") && !minus) {
      mask = kAllEffects;
    } else {
      for (const EffectRow& row : kEffectList)
        if (is(row.name)) mask = bit(row.effect);
      if (!mask)
        return failure("--effects: unknown effect '%.*s'; `pocketray plan SCENE` lists the effects",
                       static_cast<int>(name_count), name);
    }
    if (minus) {
      settings->forced_off |= mask;
    } else {
      settings->forced_on |= mask;
      named |= mask != 0;
    }
    if (!end) break;
    at = end + 1;
  }
  if (named && !automatic) settings->forced_off |= kAllEffects & ~settings->forced_on;
  return success();
}

Status validate_settings(const Settings& settings) {
  RETURN_IF_ERROR(check_limit(Quantity::width, settings.width));
  RETURN_IF_ERROR(check_limit(Quantity::height, settings.height));
  for (const SettingRow& row : kSettingList) RETURN_IF_ERROR(check_setting(row, row.field.get(settings)));
  if (settings.threads >= 1 && settings.threads <= kThreadCountMax) return success();
  return failure("the number of threads is %u: it must lie in 1 … %u", settings.threads, kThreadCountMax);
}

}  // namespace pocketray
