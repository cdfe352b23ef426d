// Faces of a PLY file, with colours and texture coordinates that may belong to faces and corners.
#pragma once
#include <vector>

#include "desktop/import/scene_builder.h"

namespace pocketray {

constexpr Rgba16 kNoFaceColor = {65535, 65535, 65535, 65535};

struct PlyFaces {
  std::vector<std::uint32_t> corners;   // vertices
  std::vector<std::size_t> ends;        // end of each face in `corners`
  std::vector<Rgba16> colors;           // for the first faces; the rest have none
  std::vector<std::uint32_t> textures;  // likewise
  std::vector<Vec2> uvs;                // for the first corners
};

inline void end_face(PlyFaces* faces) { faces->ends.push_back(faces->corners.size()); }

// Appends the faces' triangles to the mesh, whose vertices are split where corners differ. A face's colour overrides
// those of its vertices.
void append_faces(const PlyFaces& faces, MeshData* mesh, SceneBuilder* builder);

}  // namespace pocketray
