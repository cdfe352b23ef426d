// Which effects are templates of the kernel and which are looked up at run time: an effect is a template where code
// that only asks for it would cost frames without it more than 0.1 % of their instructions (tests/absence). Where an
// effect costs far more than asking for the others, its instances hold their code too.
#pragma once
#include "indirect/indirect_list.h"
#include "shade/instantiate.h"

namespace pocketray {

// Virtual lights need shadow rays: virtual_light.h.
constexpr EffectMask kStoredLight = IndirectList::kEffects & ~bit(Effect::instant_radiosity);

// Surfaces of contacts: each is gathered with its neighbours, and paths may pass it.
constexpr EffectMask kContactEffects =
    bit(Effect::refraction) | bit(Effect::absorption) | bit(Effect::alpha_blend) | bit(Effect::back_face_culling);
// Effects by which paths continue beyond their first hits.
constexpr EffectMask kGoesOn = (kContactEffects & ~bit(Effect::absorption)) | bit(Effect::mirror);
constexpr EffectMask kLobeEffects = bit(Effect::specular) | bit(Effect::mirror);

// Layers over the base, light through leaves, and what is rare in glass. Their light is the business of one instance,
// that of coats.
constexpr EffectMask kLayerEffects = bit(Effect::clear_coat) | bit(Effect::sheen) | bit(Effect::transmission_map) |
                                     bit(Effect::rough_refraction) | bit(Effect::iridescence) |
                                     bit(Effect::diffuse_transmission);
constexpr EffectMask as_coat(EffectMask plan) {
  return plan & kLayerEffects & kEffectsBuilt ? plan | bit(Effect::clear_coat) : plan;
}

// Effects of contacts whose code an instance of radiance holds, whether or not the plan has them.
constexpr EffectMask held_contacts(EffectMask mask) {
  return has(mask, Effect::refraction)    ? kContactEffects
         : has(mask, Effect::alpha_blend) ? bit(Effect::back_face_culling)
                                          : 0;
}

// Radiance along a ray: shade.cpp.
constexpr InstanceTable<9> kRadianceTable = {
    bit(Effect::shadow) | kLobeEffects | kContactEffects | bit(Effect::metallic_roughness) | bit(Effect::mip_map) |
        bit(Effect::environment) | bit(Effect::source_selection) | bit(Effect::clear_coat) | bit(Effect::anisotropy),
    {
        // A grain needs the lobes at the point, which metallic roughness looks up.
        with(bit(Effect::anisotropy), bit(Effect::metallic_roughness), bit(Effect::anisotropy)),
        // A coat costs more than asking for everything under it.
        with(bit(Effect::clear_coat), kLobeEffects | kContactEffects | bit(Effect::metallic_roughness)),
        // Among many lights, everything else costs little.
        with(bit(Effect::source_selection), kLobeEffects | kContactEffects | bit(Effect::shadow)),
        // Where surfaces blend, asking for media would take 2 to 3 % more instructions (glass-table,
        // AlphaBlendModeTest); where rays are refracted, asking for the rest takes .3 to .7 % (TransmissionTest,
        // AttenuationTest).
        with(bit(Effect::refraction), held_contacts(bit(Effect::refraction))),
        with(bit(Effect::alpha_blend), held_contacts(bit(Effect::alpha_blend))),
        // Without these, a path ends at its first surface, and footprints need no distance along it.
        without_any(bit(Effect::refraction), bit(Effect::absorption)),
        without_any(kGoesOn, bit(Effect::mip_map)),
        // Maps look up the lobes at each point, and an environment is seen where nothing else is done.
        with(bit(Effect::environment), bit(Effect::metallic_roughness)),
        with(bit(Effect::metallic_roughness) | bit(Effect::mip_map), kLobeEffects),
    }};

// The surface at a hit, and its own light: surface.cpp. Scenes whose textures use both sets of texture coordinates look
// textures up by Kernels::color.
constexpr InstanceTable<1> kSurfaceTable = {
    bit(Effect::smooth_normal) | bit(Effect::texture) | bit(Effect::vertex_color) | bit(Effect::emission) |
        bit(Effect::mip_map) | bit(Effect::second_uv) | kStoredLight,
    {with(bit(Effect::second_uv), bit(Effect::texture), bit(Effect::emission) | kStoredLight)}};
constexpr EffectMask kTexturedGlow = bit(Effect::texture) | bit(Effect::emission);
constexpr InstanceTable<2> kGlowTable = {
    kTexturedGlow | bit(Effect::mip_map) | bit(Effect::second_uv) | kStoredLight,
    {without_all(kTexturedGlow, bit(Effect::second_uv)), with(bit(Effect::second_uv), 0, bit(Effect::mip_map))}};

// Materials that vary by maps: material_maps.cpp.
constexpr EffectMask kMapEffects = bit(Effect::metallic_roughness) | bit(Effect::normal_map) | bit(Effect::occlusion) |
                                   bit(Effect::anisotropy) | bit(Effect::second_uv) | kLayerEffects;
constexpr EffectMask kHoldingMaps = bit(Effect::anisotropy) | bit(Effect::second_uv) | kLayerEffects;
constexpr InstanceTable<2> kMapsTable = {
    kMapEffects | bit(Effect::mip_map),
    {
        // A grain costs more than asking for the other maps.
        with(bit(Effect::anisotropy), kMapEffects & ~bit(Effect::second_uv) & ~kLayerEffects),
        with(bit(Effect::second_uv) | kLayerEffects, kMapEffects, bit(Effect::mip_map)),
    }};

}  // namespace pocketray
