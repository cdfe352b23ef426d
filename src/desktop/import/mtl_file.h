// The text of an MTL file.
#pragma once
#include <string>
#include <vector>

#include "desktop/import/files.h"
#include "desktop/import/scene_builder.h"

namespace pocketray {

// A map and its options.
struct MtlMap {
  std::string name;  // empty: none
  float scale[2] = {1, 1}, offset[2] = {0, 0};
  float base = 0, gain = 1;  // -mm
  char channel = 0;          // -imfchan: r g b m l z; 0: not stated
  bool clamp = false;
};

struct MtlMaterial {
  std::string name, file, path;  // the MTL file as the model names it, and its path
  Vec3 diffuse = {0, 0, 0}, specular = {0, 0, 0}, transmittance = {0, 0, 0}, emission = {0, 0, 0};
  float shininess = 1, ior = 1, opacity = 1;
  float roughness = 0, metallic = 0, sheen = 0, coat = 0, coat_roughness = 0, anisotropy = 0, rotation = 0;
  int illumination = 0;
  bool has_diffuse = false, has_opacity = false;
  std::size_t opacity_line = 0;
  std::string opacity_text;  // the statement, such as "Tr 1"
  MtlMap diffuse_map, opacity_map, emission_map;
};

// Appends the file's materials. Throws ImportError for a number that is not finite, naming the line. The builder's
// warning names unused statements.
void read_mtl_file(const Bytes& bytes, const std::string& name, SceneBuilder* builder,
                   std::vector<MtlMaterial>* materials);

}  // namespace pocketray
