// From a ray to the surface it meets, and beyond mirrors and glass.
#pragma once
#include "desktop/reference/surface.h"
#include "shade/surface.h"

namespace pocketray {

// Camera ray through a point of the picture, in pixels from the upper left corner.
ReferenceRay reference_camera_ray(const CameraRays& camera, double column, double row);

// Coincident faces, see contact.h; here within the rounding of doubles.
struct ReferenceContact {
  ReferenceHit face[kMediumDepthMax];
  bool front[kMediumDepthMax];
  std::uint32_t count;
  ReferenceHit last;  // last in the order of hits
};
ReferenceContact gather_contact(const ReferenceWorld& world, const ReferenceRay& ray, const ReferenceHit& first);

// Returns whether a ray may pass a face of the material.
inline bool may_be_passed(const Material& m) {
  return !m.double_sided || m.alpha_mode == AlphaMode::blend || !is_zero(m.transmission);
}
// Returns whether a face of a contact blends over what is behind it, and is visible.
inline bool lies_over(const FrameData& frame, const ReferenceContact& contact, std::uint32_t i) {
  const Material& m = material_of(frame, contact.face[i].triangle);
  return m.alpha_mode == AlphaMode::blend && !is_culled(m, contact.front[i]);
}
double alpha_of(const FrameData& frame, const ReferenceHit& face);
// Returns the face behind these: opaque, else of a body entered or left, else a thin sheet. Null: the ray passes.
const ReferenceHit* face_behind(const FrameData& frame, const ReferenceContact& contact);

// Transmittance of the innermost body over a distance.
Vec3d medium_transmittance(const Scene& scene, const MediumStack& media, double distance);

// Reflectance of a smooth boundary for unpolarised light at cos_i, eta = n_from / n_to [Born & Wolf 1999, sec. 1.5.2,
// eqs. 21]; *cos_t is the cosine of the refracted ray, 0 for total internal reflection.
double boundary_reflectance(double cos_i, double eta, double* cos_t);

// Mirrored direction. If the normal would send the ray below the surface, the geometric normal is used.
Vec3d mirrored(const Vec3d& direction, const ReferenceSurface& s, const Vec3d& normal);
inline Vec3d mirrored(const Vec3d& direction, const ReferenceSurface& s) { return mirrored(direction, s, s.normal); }

// A ray at a glass boundary: the reflected fraction; the rest is tinted, refracted and in other bodies.
struct ReferenceBoundary {
  Vec3d reflectance;
  Vec3d tint, direction, normal;  // the normal on the ray's side
  double eta;                     // n_from / n_to
  MediumStack beyond;
};
ReferenceBoundary meet_boundary(const FrameData& frame, const ReferenceSurface& s, const ReferenceContact& contact,
                                const Vec3d& direction, const MediumStack& media);
// Reflectance of a boundary for light at a cosine from a facet's normal, with its film.
Vec3d facet_reflectance(const ReferenceSurface& s, double cosine, double eta);

// Tint of light that passes a face; `direction` is the ray's.
Vec3d transmission_of(const FrameData& frame, const ReferenceHit& face, const Vec3d& direction);

// Twice the triangle's area along its normal.
inline Vec3d area_vector(const FrameData& frame, std::uint32_t triangle) {
  Vec3d a = corner_of(frame, triangle, 0);
  return cross(corner_of(frame, triangle, 1) - a, corner_of(frame, triangle, 2) - a);
}

}  // namespace pocketray
