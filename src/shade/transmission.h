// Textures of materials that transmit light (Effect::transmission_map): transmission, colour, metallic and roughness,
// and the thickness of thin sheets. Where a texel transmits nothing, the surface is opaque.
#pragma once
#include "scene/metallic_roughness.h"
#include "shade/contact.h"

namespace pocketray {

// Sets Surface::transmission of a surface with a GlassMap, and dims its diffuse lobe by it. Its metallic value must be
// set, and that of the diffuse lobe without transmission.
void find_transmission(const FrameData& frame, const GlassMap& glass, Surface* s);

// Tint of light that passes a face of a contact, the material's or that of its textures. `s` is the surface at a face
// of the contact, hit by the ray.
Vec3 transmission_of(const FrameData& frame, const Ray& ray, const Face& face, const Surface& s);

}  // namespace pocketray
