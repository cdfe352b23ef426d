#include "effect/setting_list.h"
#include "plan/effects/rule.h"
#include "shade/texture.h"

namespace pocketray {
namespace {

EffectDecision decide_emission(const EffectCall& c) {
  return by_materials(c, c.census.emissive + c.census.unlit, c.census.unlit ? "emit or are unlit" : "emit",
                      Invisible::black_emission);
}

EffectDecision decide_mip_map(const EffectCall& c) {
  const TextureFilter filter = c.settings.texture_filter;
  return takes_levels(filter) ? by_materials(c, c.census.with_levels, "have a texture with levels")
                              : decided(false, "--texture-filter %s", kTextureFilterNames[static_cast<int>(filter)]);
}

EffectDecision decide_vertex_color(const EffectCall& c) {
  if (c.census.has_colors) return decided(true, "vertices have colours");
  return with_invisible(c, decided(false, "no vertex has a colour"), Invisible::white_vertex_colors);
}

EffectDecision decide_smooth_normal(const EffectCall& c) {
  if (!c.census.has_normals)
    return with_invisible(c, decided(false, "no vertex has a normal of its own"), Invisible::flat_vertex_normals);
  const bool as_scene = c.settings.normals == NormalMode::as_scene;
  return decided(as_scene, as_scene ? "vertices have normals" : "flat normals requested");
}

constexpr EffectRule kRules[] = {
    {Effect::specular, [](const EffectCall& c) { return by_materials(c, c.census.specular, "shine"); }},
    {Effect::mirror, [](const EffectCall& c) { return by_materials(c, c.census.mirror, "mirror"); }},
    {Effect::refraction,
     [](const EffectCall& c) { return by_materials(c, c.census.transmitting, "transmit", Invisible::clear_glass); }},
    {Effect::absorption, [](const EffectCall& c) { return by_materials(c, c.census.absorbing, "absorb"); }},
    {Effect::alpha_mask,
     [](const EffectCall& c) { return by_materials(c, c.census.masked, "have holes", Invisible::mask_without_holes); }},
    {Effect::alpha_blend,
     [](const EffectCall& c) {
       return by_materials(c, c.census.blended, "blend with the background", Invisible::opaque_blend);
     }},
    {Effect::emission, decide_emission},
    {Effect::texture,
     [](const EffectCall& c) { return by_materials(c, c.census.textured, "have a texture", Invisible::even_color); }},
    {Effect::metallic_roughness,
     [](const EffectCall& c) {
       return by_materials(c, c.census.metallic_roughness, "have a metallic-roughness or specular texture",
                           Invisible::even_metallic_roughness);
     }},
    {Effect::normal_map,
     [](const EffectCall& c) {
       return by_materials(c, c.census.bumpy, "have a normal texture", Invisible::flat_normal_map);
     }},
    {Effect::anisotropy,
     [](const EffectCall& c) { return by_materials(c, c.census.grained, "have a grain", Invisible::black_grain); }},
    {Effect::clear_coat,
     [](const EffectCall& c) { return by_materials(c, c.census.coated, "have a clear coat", Invisible::black_coat); }},
    {Effect::sheen,
     [](const EffectCall& c) { return by_materials(c, c.census.sheened, "have a sheen", Invisible::black_sheen); }},
    {Effect::transmission_map,
     [](const EffectCall& c) { return by_materials(c, c.census.glass_mapped, "transmit light by textures"); }},
    {Effect::rough_refraction,
     [](const EffectCall& c) { return by_materials(c, c.census.rough_glass, "transmit light and are rough"); }},
    {Effect::iridescence,
     [](const EffectCall& c) {
       return by_materials(c, c.census.iridescent, "have a thin film", Invisible::black_film);
     }},
    {Effect::diffuse_transmission,
     [](const EffectCall& c) {
       return by_materials(c, c.census.leafy, "pass light diffusely", Invisible::opaque_leaf);
     }},
    {Effect::mip_map, decide_mip_map},
    {Effect::back_face_culling,
     [](const EffectCall& c) { return by_materials(c, c.census.one_sided, "are one-sided"); }},
    {Effect::vertex_color, decide_vertex_color},
    {Effect::smooth_normal, decide_smooth_normal},
};

}  // namespace

Array<const EffectRule> material_rules() { return {kRules, sizeof kRules / sizeof kRules[0]}; }

}  // namespace pocketray
