// Scenes on the heap, for work that desktops do before anything is sealed: baking and serving.
#pragma once
#include <string>
#include <vector>

#include "accel/accel_list.h"
#include "session/source.h"

namespace pocketray {

struct HeapScene {
  Scene scene;
  std::string warning;               // of the importer, one line; empty if there is nothing to say
  std::vector<std::uint8_t> memory;  // of a built-in scene
#ifdef POCKETRAY_HAVE_IMPORT
  ImportedScene imported;
#endif
};

// What models are imported with; see import/import.h.
struct ModelOptions {
  std::uint32_t texture_side_max = 512;
  float crease_angle = 40;
};

// Makes a built-in scene or imports a model.
Status read_heap_scene(const std::string& name, const ModelOptions& options, HeapScene* result);

// Builds an accelerator for the scene. Returns the block it lies in, to be given back by give_block_back(), or null
// where there is too little memory; *accel shows its bytes.
void* build_heap_accel(const AccelInfo& info, const Scene& scene, Array<const std::uint8_t>* accel);

}  // namespace pocketray
