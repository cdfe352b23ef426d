// Reads glTF 2.0, OBJ/MTL, PLY and, if assimp is built in, its formats into a Scene. desktop/import/ implements it:
// device builds have no definition. Uses exceptions and the heap, but no exception escapes.
#pragma once
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "base/status.h"
#include "scene/scene.h"
#include "scene/texture_side.h"

namespace pocketray {

// Up axis of a file: Z in PLY and STL, the convention of scanners and printers; Y in OBJ and OFF.
enum class UpAxis { of_format, y, z };

// Transmitting materials of glTF without a volume: closed meshes are bodies, or all are thin, or all are bodies.
enum class GlassKind { automatic, thin, solid };

struct ImportOptions {
  std::uint32_t texture_side_max = kTextureSideUsual;  // without larger levels of textures
  bool mip_maps = true;                                // store smaller levels of textures
  bool tells_halved = false;                           // the warning counts textures that were halved
  bool strict = false;            // refuse vertices that are not finite instead of leaving out their faces
  UpAxis up = UpAxis::of_format;  // for formats that do not specify it: OBJ, PLY, STL, OFF
  GlassKind glass = GlassKind::automatic;
  bool animations = true;  // false: the model at rest
  bool reduce = true;      // leave out what no picture shows
  // Files that the model names must lie below this folder, and so must the model. Empty: the model's own folder.
  std::string root;
  std::uint64_t byte_count_max = std::uint64_t(1) << 30;  // refuses larger scenes
  std::uint32_t cpu_seconds_max = 120;                    // limit for formats read by assimp
};

// Names, which may repeat, and bounds in world space at time 0.
using NamedBoxes = std::vector<std::pair<std::string, Box>>;

struct ImportedScene {
  Scene scene;
  std::shared_ptr<void> storage;            // owns what `scene` points at
  std::string warning;                      // one line listing ignored contents; empty if none
  std::vector<std::string> material_names;  // of the first materials; empty where the file has none
  std::vector<std::string> files;           // every file read for it: its own, buffers, textures, …
  bool has_fill = false;                    // import_model() added a studio to the lights that it has
  NamedBoxes parts;                         // named nodes, objects or groups, each with its descendants
};

// Reads the file at `path`; detects its format by the ending and, for glTF, by its first bytes.
Status import_scene(const std::string& path, const ImportOptions& options, ImportedScene* result);

// Lists the file endings that this build reads, for help: "gltf glb obj ply …".
std::string import_formats();

}  // namespace pocketray
