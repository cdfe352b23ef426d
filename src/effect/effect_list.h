// One row per effect: its name on the command line, the scene content that needs it, and what it declares to the
// features that it meets. plan/resolve.h derives from the declarations what goes together.
#pragma once
#include "effect/effect.h"

namespace pocketray {

// Pixels that a pixel's light depends on.
enum class Reads : std::uint8_t {
  own_pixel,
  neighbours,  // and the first hits of the 4 × 4 pixels around it, all of them traced
  adjacent,    // and the centres of the 3 × 3 pixels around it, all of them traced
  traced,      // whichever nearby pixels are traced: it may be interpolated from these
};

// How coherence finds the pixels that may differ from the last frame.
enum class Followed : std::uint8_t {
  by_rays,
  by_neighbours,    // by the rays of the pixels around, too; the paper's tables do not hold these
  as_lights_stand,  // by rays; if a light changes, the whole frame is traced
  never,
};

// Parts of a frame with the effect that servers can render.
enum class Shared : std::uint8_t { rows_and_light, rows };

struct EffectRow {
  Effect effect;
  const char* name;
  const char* called_for_by;
  Reads reads = Reads::own_pixel;
  Followed followed = Followed::by_rays;
  Shared shared = Shared::rows_and_light;
  EffectMask yields_to = 0;       // it is off beside any of these
  const char* because = nullptr;  // why others yield to it, or why it is not followed or shared
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
    {Effect::supersampling, "supersampling", "more than one sample per pixel", Reads::own_pixel, Followed::by_rays,
     Shared::rows_and_light, 0, "every pixel has several samples"},
    {Effect::animation, "animation", "moving geometry, lights or cameras"},
    {Effect::back_face_culling, "back-face-culling", "a material visible from the front only"},
    {Effect::radiosity, "radiosity", "a stored solution of the light between surfaces", Reads::own_pixel,
     Followed::by_rays, Shared::rows_and_light, 0, "radiosity stores them"},
    {Effect::instant_radiosity, "instant-radiosity", "--indirect instant-radiosity", Reads::neighbours,
     Followed::by_neighbours, Shared::rows, 0, "instant radiosity needs every pixel"},
    {Effect::ambient_gloss, "ambient-gloss", "a rough metal or plastic under ambient light or a background"},
    {Effect::metallic_roughness, "metallic-roughness", "a material with a metallic-roughness or specular texture"},
    {Effect::normal_map, "normal-map", "a material with a texture of normals"},
    {Effect::occlusion, "occlusion", "a material with an occlusion texture, under ambient light", Reads::own_pixel,
     Followed::by_rays, Shared::rows, 0, "an occlusion texture hides part of the device's own light"},
    {Effect::mip_map, "mip-map", "a material with a texture that stores smaller levels"},
    {Effect::selective, "selective", "--selective above 0", Reads::traced, Followed::never, Shared::rows,
     bit(Effect::instant_radiosity), "selective rendering interpolates pixels"},
    {Effect::environment, "environment", "a stored environment: light from every direction"},
    {Effect::undersampling, "undersampling", "--resolution checkerboard or half", Reads::traced, Followed::never,
     Shared::rows, bit(Effect::instant_radiosity), "undersampling reconstructs pixels"},
    {Effect::source_selection, "source-selection", "many lights", Reads::own_pixel, Followed::as_lights_stand},
    {Effect::environment_shadow, "environment-shadow", "a stored environment and a diffuse material", Reads::neighbours,
     Followed::by_neighbours, Shared::rows_and_light,
     bit(Effect::radiosity) | bit(Effect::selective) | bit(Effect::undersampling)},
    {Effect::anisotropy, "anisotropy", "a glossy material with a grain, such as brushed metal"},
    {Effect::second_uv, "second-uv", "a material whose textures use two sets of texture coordinates"},
    {Effect::clear_coat, "clear-coat", "a material under a clear coat"},
    {Effect::sheen, "sheen", "a material with a sheen, such as cloth"},
    {Effect::edge_sampling, "edge-sampling", "--edge-samples above 0", Reads::adjacent, Followed::by_neighbours,
     Shared::rows, bit(Effect::supersampling) | bit(Effect::selective) | bit(Effect::undersampling),
     "pixels at edges have more samples"},
    {Effect::transmission_map, "transmission-map", "a material that transmits light, with textures"},
    {Effect::rough_refraction, "rough-refraction", "a rough material that transmits light, such as frosted glass"},
    {Effect::iridescence, "iridescence", "a material under a thin film, such as a soap bubble"},
    {Effect::diffuse_transmission, "diffuse-transmission",
     "a thin material that light passes diffusely, such as a leaf", Reads::own_pixel, Followed::by_rays, Shared::rows,
     0, "light also passes surfaces from their other side"},
};

// Returns the effects with the value in the column.
template <class Value>
constexpr EffectMask effects_with(Value EffectRow::*column, Value value) {
  EffectMask mask = 0;
  for (const EffectRow& row : kEffectList)
    if (row.*column == value) mask |= bit(row.effect);
  return mask;
}

constexpr EffectMask kInterpolatingEffects = effects_with(&EffectRow::reads, Reads::traced);
// Effects that decide what a ray hits first, and with which normal.
constexpr EffectMask kFirstHitEffects = bit(Effect::texture) | bit(Effect::mip_map) | bit(Effect::alpha_mask) |
                                        bit(Effect::alpha_blend) | bit(Effect::smooth_normal);

constexpr bool effects_in_order() {
  for (int i = 0; i < kEffectCount; ++i) {
    const EffectRow& row = kEffectList[i];
    if (static_cast<int>(row.effect) != i || row.yields_to >= bit(row.effect)) return false;
    if ((row.followed == Followed::never || row.shared == Shared::rows) && !row.because) return false;
    for (const EffectRow& other : kEffectList)
      if ((row.yields_to & bit(other.effect)) && !other.because) return false;
  }
  return true;
}
static_assert(effects_in_order(), "a row for each effect, in their order; each yields to earlier ones, for a reason");

}  // namespace pocketray
