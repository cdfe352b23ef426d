// Glass for which the file has no volume: whether it is a body, which refracts, or a thin sheet. glTF takes it for thin
// (KHR_materials_volume); exporters such as Blender's leave the volume out, and a solid body would show as a bubble.
#pragma once
#include "desktop/import/scene_builder.h"

namespace pocketray {

// Bodies of builder->volumes, which have a texture of their thickness: closed meshes are bodies of their own thickness,
// others thin sheets of the texture's.
// Decides for each material in builder->glass, by options.glass. `automatic`: closed meshes are bodies. A mesh is
// closed if every edge, by the positions of its ends but for rounding, is passed as often in one direction as in the
// other; a flat one is none, nor is one that has a light or an opaque object inside. Materials of both kinds are
// divided. Adds a remark.
void decide_glass(SceneBuilder* builder);

}  // namespace pocketray
