// The text of an OBJ file: vertices, faces and names.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "desktop/import/files.h"
#include "desktop/import/scene_builder.h"

namespace pocketray {

constexpr std::int32_t kNoElement = -1;
struct ObjCorner {
  std::int32_t position, uv, normal;  // from 0; the last two may be kNoElement or out of range
};

// Smoothing groups of faces: none stated in the file so far, `s off`, or a number from 1 on.
constexpr std::uint32_t kNoGroup = kNone, kFlatGroup = 0;

struct ObjFace {
  std::uint32_t corner_begin, corner_end;
  std::uint32_t material;  // index of material_names, or kNone
  std::uint32_t group;
};
// The faces from one `g` or `o` to the next.
struct ObjShape {
  std::string name;
  std::size_t face_begin, face_end;
};

struct ObjFile {
  std::vector<double> positions;       // three each; NaN where the file's number is not finite
  std::vector<float> colors, normals;  // three each
  std::vector<float> uvs;              // two each
  std::vector<ObjCorner> corners;
  std::vector<ObjFace> faces;
  std::vector<ObjShape> shapes;
  std::vector<std::string> material_files, material_names;  // as `mtllib` and `usemtl` name them
  bool has_lines = false, has_points = false, has_groups = false;
  std::vector<std::string> unknown;  // statements, each once
};

// Throws ImportError for damage, naming the line; with `strict` also for a number that is not finite or too large.
ObjFile read_obj_file(const Bytes& bytes, const SceneBuilder& builder);

}  // namespace pocketray
