// Scenes on the heap, for baking and serving, which desktops do before memory is sealed.
#pragma once
#include <string>
#include <vector>

#include "accel/accel_list.h"
#include "session/source.h"

namespace pocketray {

struct HeapScene {
  Scene scene;
  std::string warning;               // of the importer, one line; empty: none
  std::vector<std::uint8_t> memory;  // of a built-in scene
  bool has_fill = false;             // see ImportedScene
  std::vector<std::string> files;    // that the model was read from
#ifdef POCKETRAY_HAVE_IMPORT
  ImportedScene imported;
#endif
};

// Options for importing models; see session/model_import.h.
struct ModelOptions {
  std::uint32_t texture_side_max = kTextureSideUsual;
  bool mip_maps = true;
  bool tells_halved = false;  // see ImportOptions
  bool studio = true;         // for models that call for one
  ReadingChoice reading;
  bool animations = true;
};

// Makes a built-in scene or imports a model.
Status read_heap_scene(const std::string& name, const ModelOptions& options, HeapScene* result);

// Builds an accelerator for the scene. Returns its memory block, which the caller frees with give_block_back(), or null
// if memory is short; *accel views the accelerator in it.
void* build_heap_accel(const AccelInfo& info, const Scene& scene, Array<const std::uint8_t>* accel);

}  // namespace pocketray
