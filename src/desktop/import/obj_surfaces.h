// Smoothing groups whose surfaces continue from one `g` or `o` of an OBJ file to the next: faces of several shapes with
// a common group and a common vertex line. Coincident vertices belong to separate surfaces.
#pragma once
#include <vector>

#include "desktop/import/obj_file.h"

namespace pocketray {

class ObjSurfaces {
 public:
  explicit ObjSurfaces(const ObjFile& file);
  // Angle-weighted sum of the normals of faces around a position that belong to the group but to other shapes; zero if
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

  std::vector<bool> is_shared_;      // by position; empty: none is shared
  std::vector<std::uint32_t> head_;  // first corner, by shared position
  std::vector<Corner> corners_;
};

}  // namespace pocketray
