// Wavefront OBJ and MTL.
#pragma once
#include "desktop/import/files.h"
#include "desktop/import/scene_builder.h"

namespace pocketray {

// Reads an .obj into the builder; the .mtl files and images it names lie beside it.
void import_obj(const std::string& path, Bytes bytes, SceneBuilder* builder);

}  // namespace pocketray
