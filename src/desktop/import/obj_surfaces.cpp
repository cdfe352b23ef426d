#include "desktop/import/obj_surfaces.h"

#include <cmath>

#include "base/check.h"
#include "base/fmath.h"

namespace pocketray {
namespace {

bool is_smooth(const ObjFace& face) { return face.group != kNoGroup && face.group != kFlatGroup; }

// Returns whether all corners refer to a position, and none to a normal.
bool wants_normals(const ObjFile& file, const ObjFace& face) {
  for (std::uint32_t c = face.corner_begin; c < face.corner_end; ++c)
    if (static_cast<std::size_t>(file.corners[c].position) >= file.positions.size() / 3 || file.corners[c].normal >= 0)
      return false;
  return is_smooth(face);
}

Vec3d position_of(const ObjFile& file, std::uint32_t corner) {
  const double* p = &file.positions[3 * static_cast<std::size_t>(file.corners[corner].position)];
  return {p[0], p[1], p[2]};
}

}  // namespace

ObjSurfaces::ObjSurfaces(const ObjFile& file) {
  if (!file.has_groups || file.shapes.size() < 2) return;
  find_shared(file);
  if (is_shared_.empty()) return;
  head_.assign(is_shared_.size(), kNone);
  for (std::size_t s = 0; s < file.shapes.size(); ++s)
    for (std::size_t f = file.shapes[s].face_begin; f < file.shapes[s].face_end; ++f) add_face(file, file.faces[f], s);
}

void ObjSurfaces::find_shared(const ObjFile& file) {
  constexpr std::size_t kUnused = ~std::size_t(0);
  std::vector<std::size_t> shape_of(file.positions.size() / 3, kUnused);
  for (std::size_t s = 0; s < file.shapes.size(); ++s)
    for (std::size_t f = file.shapes[s].face_begin; f < file.shapes[s].face_end; ++f) {
      const ObjFace& face = file.faces[f];
      if (!wants_normals(file, face)) continue;
      for (std::uint32_t c = face.corner_begin; c < face.corner_end; ++c) {
        const std::size_t p = static_cast<std::size_t>(file.corners[c].position);
        if (shape_of[p] == kUnused) shape_of[p] = s;
        if (shape_of[p] == s) continue;
        is_shared_.resize(shape_of.size());
        is_shared_[p] = true;
      }
    }
}

void ObjSurfaces::add_face(const ObjFile& file, const ObjFace& face, std::size_t shape) {
  const std::uint32_t begin = face.corner_begin, count = face.corner_end - begin;
  if (count < 3 || !wants_normals(file, face)) return;
  Vec3d area = {0, 0, 0};  // [Newell]
  const Vec3d first = position_of(file, begin);
  for (std::uint32_t i = 1; i + 1 < count; ++i)
    area += cross(position_of(file, begin + i) - first, position_of(file, begin + i + 1) - first);
  const Vec3d normal = normalize(area);
  if (is_zero(normal)) return;
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::size_t p = static_cast<std::size_t>(file.corners[begin + i].position);
    if (!is_shared_[p]) continue;
    const Vec3d here = position_of(file, begin + i);
    const Vec3d to = normalize(position_of(file, begin + (i + 1) % count) - here),
                from = normalize(position_of(file, begin + (i + count - 1) % count) - here);
    const double angle = det_acos(dot(to, from)), inside = dot(cross(to, from), normal) < 0 ? 2 * kPi - angle : angle;
    if (!std::isfinite(inside)) continue;
    corners_.push_back({normal * inside, shape, face.group, head_[p]});
    head_[p] = static_cast<std::uint32_t>(corners_.size() - 1);
  }
}

Vec3d ObjSurfaces::normals_elsewhere(std::size_t position, std::size_t shape, std::uint32_t group) const {
  Vec3d sum = {0, 0, 0};
  if (is_shared_.empty()) return sum;
  CHECK_LT(position, is_shared_.size());
  for (std::uint32_t at = head_[position]; at != kNone; at = corners_[at].next)
    if (corners_[at].shape != shape && corners_[at].group == group) sum += corners_[at].weighted_normal;
  return sum;
}

}  // namespace pocketray
