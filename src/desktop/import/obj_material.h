// MTL materials.
#pragma once
#include <string>

#include "desktop/import/mtl_file.h"
#include "desktop/import/scene_builder.h"

namespace pocketray {

// Appends the material and returns its index. Its images lie beside its MTL file or the scene file; a missing image or
// an invisible material gives a remark.
std::uint32_t add_obj_material(SceneBuilder* builder, const std::string& scene_path, const MtlMaterial& source);

}  // namespace pocketray
