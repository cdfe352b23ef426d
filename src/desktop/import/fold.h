// Textures of one value in glass and thin films become factors, as reduce.h has it.
#pragma once
#include "desktop/import/scene_builder.h"

namespace pocketray {

// Leaves out the map of a material that transmits the same everywhere. `scene` shows the arrays.
void fold_glass(const Scene& scene, std::uint32_t material, SceneArrays* arrays);

// Returns 1 if the film's texture is black and the film left out, else 0.
std::uint32_t fold_film(const Scene& scene, std::uint32_t material, SceneArrays* arrays);

// Returns 1 if the texture's alpha lets nothing pass and the entry is left out, else 0.
std::uint32_t drop_passing(const Scene& scene, std::uint32_t material, SceneArrays* arrays);

// Clears arrays without an entry.
void drop_empty_maps(SceneArrays* arrays);

}  // namespace pocketray
