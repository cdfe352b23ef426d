// Stanford PLY, ASCII and binary of both byte orders: vertices, their normals and colours, faces and triangle strips.
#pragma once
#include "desktop/import/files.h"
#include "desktop/import/scene_builder.h"

namespace pocketray {

// Reads a .ply into the builder; its textures lie beside it.
void import_ply(const std::string& path, const Bytes& bytes, SceneBuilder* builder);

}  // namespace pocketray
