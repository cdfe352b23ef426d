// Materials, lights and cameras of an assimp scene. Included only where assimp is built in.
#pragma once
#include <assimp/scene.h>

#include <string>

#include "desktop/import/scene_builder.h"

namespace pocketray {

// Linear colour of a vertex; the formats assimp reads store display values.
Rgba16 assimp_color(const aiColor4D& color);
std::uint32_t add_default_material(SceneBuilder* builder);
std::uint32_t add_assimp_material(SceneBuilder* builder, const std::string& scene_path, const aiScene& scene,
                                  const aiMaterial& source);
void add_assimp_lights_and_cameras(SceneBuilder* builder, const aiScene& scene);

// Throws for a vertex, material, light, camera or node with a number that is not finite or too large, naming it.
// Ignores such normals unless `own_normals`: STL files are full of NaN normals, which are not read. Vertices are
// checked only with `strict`.
void check_assimp_numbers(const aiScene& scene, bool own_normals, bool strict);

}  // namespace pocketray
