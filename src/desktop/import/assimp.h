// Formats read by assimp: PLY, STL, FBX, COLLADA, … Built in if assimp is installed.
#pragma once
#include "desktop/import/files.h"
#include "desktop/import/scene_builder.h"

namespace pocketray {

bool assimp_reads(const std::string& ending);
// Endings, each after a space; "" without assimp.
std::string assimp_formats();
void import_assimp(const std::string& path, const std::string& ending, const Bytes& bytes, SceneBuilder* builder);

}  // namespace pocketray
