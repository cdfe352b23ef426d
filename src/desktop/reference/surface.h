// A point on a surface as the reference sees it, and its lobes.
#pragma once
#include "brdf/brdf_list.h"
#include "desktop/reference/reference.h"
#include "desktop/reference/samples.h"

namespace pocketray {

// The normal and the geometric normal are unit vectors on the side from which the ray came; the grain is zero without
// Effect::anisotropy.
struct ReferenceSurface : LobeFrameD {
  Vec3d point;
  double magnitude;  // of the coordinates behind the point: bounds its rounding error
  Vec3d geometric;
  Vec3d diffuse, specular, mirror, emission;
  bool front;
  std::uint32_t triangle;
  double u, v;
  const Material* material;
  Material mapped;  // the material with its lobes modified by its maps, if is_mapped
  bool is_mapped;
  Vec3d transmission;  // tint of light that passes; zero: opaque
  // The thin film, as in SurfaceFilm; its strength is 0 without one.
  double film_strength = 0, film_ior = 0, film_thickness = 0;
  Vec3d passing = {0, 0, 0};  // albedo for light from the other side, Effect::diffuse_transmission
  double open;                // fraction of ambient light left by an occlusion map
  // The sheen under the coat, as in SurfaceSheen, and the albedo of the diffuse lobe and the sheen for light from
  // everywhere.
  Vec3d sheen, even;
  double sheen_roughness = 0;
  // The clear coat, as in SurfaceCoat. Diffuse, mirror and emission include its transmittance and the sheen's;
  // `specular` does not.
  double passes = 1, coat_lobe = 0, coat_mirror = 0;
  Vec3d coat_normal;
  Material coat;                        // its lobe, set if it has one
  const ReferenceCell* cell = nullptr;  // in the guide, if it has one here
};

// Returns the material with its lobes at the surface.
inline const Material& lobes_of(const ReferenceSurface& s) { return s.is_mapped ? s.mapped : *s.material; }

ReferenceSurface reference_surface(const FrameData& frame, const ReferenceHit& hit, const Vec3d& direction);

// The matte surface that receives light which passes `s` from its other side.
ReferenceSurface other_side(const ReferenceSurface& s);

// Returns whether light that passes the surface is scattered, Effect::rough_refraction.
bool scatters_passing_light(const FrameData& frame, const ReferenceSurface& s);
// Returns whether a ray at the surface is inside its body.
inline bool leaves_body(const ReferenceSurface& s) { return !s.material->thin && !s.front; }

// Makes a ray from the surface. Directions below the flat triangle but above the curved surface described by the vertex
// normals start where the renderer starts them, see curved_origin() in surface.h.
ReferenceRay leave(const FrameData& frame, const ReferenceSurface& s, const Vec3d& direction, double t_max);

// The glossy lobe, with its grain where it has one.
inline const BrdfInfo& glossy_lobe(const ReferenceSurface& s) {
  const BrdfInfo* lobe = kBrdfList[s.material->brdf];
  return lobe->with_grain && !is_zero(s.grain) ? *lobe->with_grain : *lobe;
}

// The coat's lobe × its cosine, divided by the cosine at the surface.
Vec3d coat_value(const ReferenceSurface& s, const Vec3d& to_viewer, const Vec3d& to_light);

// The sheen's value.
Vec3d sheen_value(const ReferenceSurface& s, const Vec3d& to_viewer, const Vec3d& to_light);

// Approximate upper bound of what the lobes reflect; 0: there are none.
double lobe_weight(const ReferenceSurface& s, const Vec3d& to_viewer);

// Radiance of the surroundings reflected by the glossy lobe, if the frame's plan has Effect::ambient_gloss and neither
// an environment nor radiosity, which its paths carry, replaces it.
Vec3d reflected_surroundings(const FrameData& frame, const ReferenceSurface& s, const Vec3d& to_viewer);

// Value of the diffuse plus the glossy lobe under coat and sheen, plus the coat's lobe and the sheen, 1/sr.
Vec3d lobe_value(const ReferenceSurface& s, const Vec3d& to_viewer, const Vec3d& to_light);
// Density of sample_lobes(), 1/sr; 0 without lobes.
double lobe_density(const ReferenceSurface& s, const Vec3d& to_viewer, const Vec3d& to_light);
// Samples a direction by the lobes, from numbers uniform in [0, 1): `choice` selects the lobe, `pair` the direction in
// it. Returns false if it points below the surface or there are no lobes.
bool sample_lobes(const ReferenceSurface& s, const Vec3d& to_viewer, double choice, const Pair& pair, Vec3d* direction);

}  // namespace pocketray
