// Effects that a renderer can simulate, one bit each.
#pragma once
#include <cstdint>

namespace pocketray {

enum class Effect : std::uint8_t {
  shadow,
  specular,
  mirror,
  refraction,
  absorption,
  alpha_mask,
  alpha_blend,
  emission,
  texture,
  vertex_color,
  smooth_normal,
  ambient,
  point_light,
  spot_light,
  directional_light,
  area_light,
  supersampling,
  animation,
  back_face_culling,
  radiosity,
  instant_radiosity,
  ambient_gloss,
  metallic_roughness,
  normal_map,
  occlusion,
  mip_map,
  selective,
  environment,
  undersampling,
  source_selection,
  environment_shadow,
  anisotropy,
  second_uv,
  clear_coat,
  sheen,
  edge_sampling,
  transmission_map,
  rough_refraction,
  iridescence,
  diffuse_transmission,
};
constexpr int kEffectCount = 40;

using EffectMask = std::uint64_t;
constexpr EffectMask bit(Effect effect) { return EffectMask(1) << static_cast<int>(effect); }
static_assert(kEffectCount < 64, "more effects than bits of a mask take a wider one, on the wire too");
constexpr EffectMask kAllEffects = bit(static_cast<Effect>(kEffectCount)) - 1;
// Methods of indirect light: a plan has at most one; --indirect chooses it.
constexpr EffectMask kIndirectEffects = bit(Effect::ambient) | bit(Effect::radiosity) | bit(Effect::instant_radiosity);

// Effects compiled into this build. tests/absence builds the core without those that a scene does not need, to prove
// that an absent effect costs nothing in a full build.
#ifdef POCKETRAY_EFFECTS_BUILT
constexpr EffectMask kEffectsBuilt = POCKETRAY_EFFECTS_BUILT;
#else
constexpr EffectMask kEffectsBuilt = kAllEffects;
#endif

constexpr bool has(EffectMask mask, Effect effect) { return (mask & kEffectsBuilt & bit(effect)) != 0; }

}  // namespace pocketray
