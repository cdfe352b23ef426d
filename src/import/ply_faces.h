// The faces of a PLY file, whose colours and texture coordinates may be those of faces and corners.
#pragma once
#include <vector>

#include "import/scene_builder.h"

namespace pocketray {

constexpr Rgba16 kNoFaceColor = {65535, 65535, 65535, 65535};

struct PlyFaces {
  std::vector<std::uint32_t> corners;   // vertices
  std::vector<std::size_t> ends;        // of each face in `corners`
  std::vector<Rgba16> colors;           // of the first faces; the rest have none
  std::vector<std::uint32_t> textures;  // likewise
  std::vector<Vec2> uvs;                // of the first corners
};

inline void end_face(PlyFaces* faces) { faces->ends.push_back(faces->corners.size()); }

// Appends the faces' triangles to the mesh, whose vertices it divides where corners differ. A face's colour stands in
// for those of its vertices.
void append_faces(const PlyFaces& faces, MeshData* mesh, SceneBuilder* builder);

}  // namespace pocketray
