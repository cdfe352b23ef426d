// MTL materials.
#pragma once
#include <tiny_obj_loader.h>

#include <string>

#include "import/scene_builder.h"

namespace pocketray {

// Appends the material and returns its index. Its images lie beside the scene file; a missing one gives a remark.
std::uint32_t add_obj_material(SceneBuilder* builder, const std::string& scene_path, const tinyobj::material_t& source);

}  // namespace pocketray
