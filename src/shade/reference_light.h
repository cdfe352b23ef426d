// Light that the reference fetches from the lights themselves: next-event estimation.
#pragma once
#include "shade/reference_surface.h"

namespace pocketray {

// Faces that lie on one another, see contact.h; here those within rounding of doubles.
struct ReferenceContact {
  ReferenceHit face[kMediumDepthMax];
  bool front[kMediumDepthMax];
  std::uint32_t count;
  ReferenceHit last;  // of all of them in the order of hits
};
ReferenceContact gather_contact(const ReferenceWorld& world, const ReferenceRay& ray, const ReferenceHit& first);

// Reflectance of a smooth boundary for unpolarised light that meets it at cos_i, eta = n_from / n_to [Born & Wolf 1999,
// sec. 1.5.2, eqs. 21]; *cos_t is the cosine of the refracted ray, 0 where all is reflected.
double boundary_reflectance(double cos_i, double eta, double* cos_t);

// Emitters of a frame, into an array with room for them all; returns their number.
std::uint32_t find_emitters(const FrameData& frame, ReferenceEmitter* emitters);
// Density per area with which an emitter is picked.
double emitter_density(const Reference& reference, std::uint32_t triangle);

// Radiance towards the viewer by light straight from the lights, one sample of it. Of area lights it is the part that
// the heuristic of multiple importance sampling leaves to them where light is followed through the scene.
Vec3d sample_direct_light(const Reference& reference, const ReferenceOptions& options, const ReferenceSurface& s,
                          const Vec3d& to_viewer, Rng* rng);

// Veach's power heuristic, exponent 2 [Veach 1997, eq. 9.13].
inline double power_heuristic(double density, double other) {
  double a = density * density, b = other * other;
  return a > 0 ? a / (a + b) : 0;
}

}  // namespace pocketray
