// One row per effect: its name on the command line and the scene content that needs it.
#pragma once
#include "effect/effect.h"

namespace pocketray {

struct EffectRow {
  Effect effect;
  const char* name;
  const char* called_for_by;
};

constexpr EffectRow kEffectList[kEffectCount] = {
    {Effect::shadow, "shadow", "a light and a surface that reflects it"},
    {Effect::specular, "specular", "a material with a glossy lobe"},
    {Effect::mirror, "mirror", "a material with mirror reflectance"},
    {Effect::refraction, "refraction", "a material that transmits light"},
    {Effect::absorption, "absorption", "a transparent body that absorbs"},
    {Effect::alpha_mask, "alpha-mask", "a material with cut-out holes"},
    {Effect::alpha_blend, "alpha-blend", "a material that the background shows through"},
    {Effect::emission, "emission", "a material that emits, or shows its colour unlit"},
    {Effect::texture, "texture", "a material with a texture"},
    {Effect::vertex_color, "vertex-color", "a mesh with colours at its vertices"},
    {Effect::smooth_normal, "smooth-normal", "a mesh with normals at its vertices"},
    {Effect::ambient, "ambient", "a constant indirect light"},
    {Effect::point_light, "point-light", "a point light"},
    {Effect::spot_light, "spot-light", "a spot light"},
    {Effect::directional_light, "directional-light", "a directional light"},
    {Effect::area_light, "area-light", "an emissive surface"},
    {Effect::supersampling, "supersampling", "more than one sample per pixel"},
    {Effect::animation, "animation", "moving geometry, lights or cameras"},
    {Effect::back_face_culling, "back-face-culling", "a material visible from the front only"},
    {Effect::radiosity, "radiosity", "a stored solution of the light between surfaces"},
    {Effect::instant_radiosity, "instant-radiosity", "--indirect instant-radiosity"},
    {Effect::ambient_gloss, "ambient-gloss", "a rough metal or plastic under ambient light or a background"},
    {Effect::metallic_roughness, "metallic-roughness", "a material with a metallic-roughness or specular texture"},
    {Effect::normal_map, "normal-map", "a material with a texture of normals"},
    {Effect::occlusion, "occlusion", "a material with an occlusion texture, under ambient light"},
    {Effect::mip_map, "mip-map", "a material with a texture that stores smaller levels"},
    {Effect::selective, "selective", "--selective above 0"},
    {Effect::environment, "environment", "a stored environment: light from every direction"},
    {Effect::undersampling, "undersampling", "--resolution checkerboard or half"},
    {Effect::source_selection, "source-selection", "many lights"},
    {Effect::environment_shadow, "environment-shadow", "a stored environment and a diffuse material"},
    {Effect::anisotropy, "anisotropy", "a glossy material with a grain, such as brushed metal"},
    {Effect::second_uv, "second-uv", "a material whose textures use two sets of texture coordinates"},
    {Effect::clear_coat, "clear-coat", "a material under a clear coat"},
};

constexpr bool effects_in_order() {
  for (int i = 0; i < kEffectCount; ++i)
    if (static_cast<int>(kEffectList[i].effect) != i) return false;
  return true;
}
static_assert(effects_in_order(), "one row for each effect, in their order");

}  // namespace pocketray
