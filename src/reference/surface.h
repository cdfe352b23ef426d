// A point on a surface as the reference sees it, and its lobes.
#pragma once
#include "brdf/brdf_list.h"
#include "reference/reference.h"
#include "reference/samples.h"

namespace pocketray {

// Its normal, and the geometric one, are unit and on the side the ray came from; its grain is zero without
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
  Material mapped;  // the material with the lobes that its maps give it here, if is_mapped
  bool is_mapped;
  double open;  // what an occlusion map leaves of ambient light
  // The clear coat, as SurfaceCoat has it. Diffuse, mirror and emission are what it lets through; `specular` is not.
  double passes = 1, coat_lobe = 0, coat_mirror = 0;
  Vec3d coat_normal;
  Material coat;                        // its lobe, set if it has one
  const ReferenceCell* cell = nullptr;  // of the guide, if it has one here
};

// The material with its lobes at the surface.
inline const Material& lobes_of(const ReferenceSurface& s) { return s.is_mapped ? s.mapped : *s.material; }

ReferenceSurface reference_surface(const FrameData& frame, const ReferenceHit& hit, const Vec3d& direction);

// A ray from the surface. Directions below the flat triangle but above the curved surface described by the vertex
// normals start where the renderer starts them, see curved_origin() in surface.h.
ReferenceRay leave(const FrameData& frame, const ReferenceSurface& s, const Vec3d& direction, double t_max);

// The glossy lobe, with its grain where it has one.
inline const BrdfInfo& glossy_lobe(const ReferenceSurface& s) {
  const BrdfInfo* lobe = kBrdfList[s.material->brdf];
  return lobe->with_grain && !is_zero(s.grain) ? *lobe->with_grain : *lobe;
}

// The coat's lobe × its cosine, over the cosine of the surface.
Vec3d coat_value(const ReferenceSurface& s, const Vec3d& to_viewer, const Vec3d& to_light);

// What the lobes reflect at most, about; 0: there are none.
double lobe_weight(const ReferenceSurface& s, const Vec3d& to_viewer);

// Radiance of the surroundings that the glossy lobe reflects, if the frame's plan has Effect::ambient_gloss and
// no environment stands in.
Vec3d reflected_surroundings(const FrameData& frame, const ReferenceSurface& s, const Vec3d& to_viewer);

// Value of the diffuse plus the glossy lobe under the coat, plus the coat's, 1/sr.
Vec3d lobe_value(const ReferenceSurface& s, const Vec3d& to_viewer, const Vec3d& to_light);
// Density of sample_lobes(), 1/sr; 0 without lobes.
double lobe_density(const ReferenceSurface& s, const Vec3d& to_viewer, const Vec3d& to_light);
// A direction sampled by the lobes, from numbers uniform in [0, 1): `choice` selects the lobe, `pair` the direction in
// it. False if it points below the surface or there are no lobes.
bool sample_lobes(const ReferenceSurface& s, const Vec3d& to_viewer, double choice, const Pair& pair, Vec3d* direction);

}  // namespace pocketray
