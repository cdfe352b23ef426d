// Smoothing groups of an OBJ file whose surfaces go on from one `g` or `o` to the next: faces of several shapes with
// one group and one vertex line. Vertices that merely lie at one place belong to separate surfaces.
#pragma once
#include <vector>

#include "import/obj_file.h"

namespace pocketray {

class ObjSurfaces {
 public:
  explicit ObjSurfaces(const ObjFile& file);
  // The normals of the faces around a position that belong to the group but to other shapes, weighted by angle; zero if
  // there are none.
  Vec3d normals_elsewhere(std::size_t position, std::size_t shape, std::uint32_t group) const;

 private:
  struct Corner {
    Vec3d weighted_normal;
    std::size_t shape;
    std::uint32_t group, next;  // next: of the position
  };
  void find_shared(const ObjFile& file);
  void add_face(const ObjFile& file, const ObjFace& face, std::size_t shape);

  std::vector<bool> is_shared_;      // by position; empty: none is
  std::vector<std::uint32_t> head_;  // of the corners of shared positions
  std::vector<Corner> corners_;
};

}  // namespace pocketray
