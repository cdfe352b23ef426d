// Materials that change between frames: recoloured, retextured, lamps dimmed. The scene as opened fixes which effects
// are simulated and which materials are lamps.
#pragma once
#include "engine/renderer.h"

namespace pocketray {

// Number of materials that memory for a copy is planned for.
inline std::uint32_t recolorable_count(const Renderer& renderer) {
  return renderer.materials.recolorable ? renderer.scene.materials.count : 0;
}
// Copies the scene's materials, if memory is planned for it; a step of build_renderer().
void make_recolorable(Renderer* renderer);

inline Array<const Material> opened_materials(const Renderer& renderer) {
  return renderer.materials.current.count ? renderer.materials.opened : renderer.scene.materials;
}
inline Scene opened_scene(const Renderer& renderer) {
  Scene scene = renderer.scene;
  scene.materials = opened_materials(renderer);
  return scene;
}

// Fails if no memory is reserved for changing materials.
Status check_recolorable(const Renderer& renderer);
// Also fails if the material's values may not replace those of the scene's material; lobes that come from maps stay as
// they are.
Status check_recolored(Renderer* renderer, std::uint32_t index, const Material& material);
// Changes the material for the next frames. Fails and changes nothing if no memory is reserved, or if the material
// calls for an effect that the opened scene does not, or emits where none did.
Status change_material(Renderer* renderer, std::uint32_t index, const Material& material);

}  // namespace pocketray
