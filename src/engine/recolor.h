// Materials that change between frames: recoloured, textured anew, lamps dimmed. What the scene was opened with decides
// for good on the effects that are simulated, and on which materials are lamps.
#pragma once
#include "engine/renderer.h"

namespace pocketray {

// Materials of which memory for a copy is planned.
inline std::uint32_t recolorable_count(const Renderer& renderer) {
  return renderer.recolorable ? renderer.scene.materials.count : 0;
}
// Copies the scene's materials, if memory is planned for that; a step of build_renderer().
void make_recolorable(Renderer* renderer);

inline Array<const Material> opened_materials(const Renderer& renderer) {
  return renderer.materials.count ? renderer.opened_materials : renderer.scene.materials;
}
inline Scene opened_scene(const Renderer& renderer) {
  Scene scene = renderer.scene;
  scene.materials = opened_materials(renderer);
  return scene;
}

// Whether memory is reserved.
Status check_recolorable(const Renderer& renderer);
// If it is, whether a material may take the place of one of the scene's as far as its values go; lobes that come from
// maps stay as they are.
Status check_recolored(Renderer* renderer, std::uint32_t index, const Material& material);
// Puts it there for the next frames. Fails, and changes nothing, if no memory is reserved, or the material calls for an
// effect that the scene as opened does not, or emits where none did.
Status change_material(Renderer* renderer, std::uint32_t index, const Material& material);

}  // namespace pocketray
