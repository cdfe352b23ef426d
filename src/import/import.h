// Reads glTF 2.0, OBJ/MTL, PLY and, if assimp is built in, its formats into a Scene. Desktop only: uses exceptions and
// the heap, but no exception escapes.
#pragma once
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "base/status.h"
#include "scene/scene.h"

namespace pocketray {

// The axis that points up in a file: Z in PLY and STL, as scanners and printers have it; Y in OBJ and OFF.
enum class UpAxis { of_format, y, z };

struct ImportOptions {
  std::uint32_t texture_side_max = 512;  // larger textures are halved until they fit
  bool mip_maps = true;                  // store smaller levels of textures
  float crease_angle = 40;               // degrees; meshes without normals are smoothed below it (glTF: flat)
  bool strict = false;                   // refuse vertices that are not finite instead of leaving out their faces
  UpAxis up = UpAxis::of_format;         // of formats that do not say: OBJ, PLY, STL, OFF
  bool animations = true;                // false: the model at rest
  // Files that the model names lie below this folder, which the model lies below, too. Empty: the model's own folder.
  std::string root;
  std::uint64_t byte_count_max = std::uint64_t(1) << 30;  // refuses larger scenes
  std::uint32_t cpu_seconds_max = 120;                    // for formats read by assimp, which is stopped then
};

// Names, which may occur more than once, and bounds in world space at time 0.
using NamedBoxes = std::vector<std::pair<std::string, Box>>;

struct ImportedScene {
  Scene scene;
  std::shared_ptr<void> storage;            // owns what `scene` points at
  std::string warning;                      // one line listing ignored contents; empty if none
  std::vector<std::string> material_names;  // of the first materials; empty where the file has none
  std::vector<std::string> files;           // that were read for it: its own, buffers, textures, …
  NamedBoxes parts;                         // nodes, objects or groups with a name, each with all below it
};

// Reads the file at `path`; detects its format by the ending and, for glTF, its first bytes.
Status import_scene(const std::string& path, const ImportOptions& options, ImportedScene* result);

// File endings this build reads, for help: "gltf glb obj ply …".
std::string import_formats();

}  // namespace pocketray
