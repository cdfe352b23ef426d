// From a hit to the properties of the surface there.
#pragma once
#include <cmath>
#include <limits>

#include "base/fmath.h"
#include "brdf/brdf_list.h"
#include "shade/frame_data.h"

namespace pocketray {

struct SurfacePlace {
  float u, v;  // in the triangle
  std::uint32_t triangle;
};

// Effect of a clear coat on a surface, see clear_coat.h.
struct SurfaceCoat {
  float passes;     // fraction of the base's light that coat and sheen transmit; 1: there is neither
  float lobe;       // strength of its lobe; 0: none, or the plan has no glossy lobes
  float mirror;     // mirror reflectance; 0: none, or the plan has no mirrors
  float roughness;  // set with a lobe
  Vec3 normal;      // unit
};

// Sheen of a surface, see sheen.h.
struct SurfaceSheen {
  Vec3 color;       // under the coat; 0: none
  Vec3 base;        // albedo of the diffuse lobe alone, under coat and sheen; Surface::diffuse includes the sheen's
  float roughness;  // set with a colour
};

// Thin film over a surface, see film.h.
struct SurfaceFilm {
  float strength;  // 0: none
  float ior, thickness;
  float f0;           // largest component of the reflectance at normal incidence without the film
  Vec3 normal, seen;  // reflectance with it, at normal incidence for Schlick's formula, and towards the viewer
};

// The normal and the geometric normal are unit vectors on the side from which the ray came.
struct Surface : LobeFrame {
  Vec3 point;
  Vec3 offset;  // from the point to a safe origin on the side the ray came from
  Vec3 geometric;
  Vec3 diffuse;            // albedo
  Vec3 glow;               // radiance emitted without any lights: emission, ambient; virtual lights add to it
  bool front;              // the ray met the front (counter-clockwise) side
  bool is_tinted;          // by `tint`, the colour of texture and vertices, which is set only then
  std::uint16_t metallic;  // from a metallic-roughness map, in 65535ths; set with one only, like roughness
  Vec3 tint;
  const Material* material;
  float roughness;
  SurfacePlace hit;
  Footprints footprint;  // set with Effect::mip_map
  SurfaceCoat coat;      // set with Effect::clear_coat or sheen
  SurfaceSheen sheen;    // likewise
  float transmission;    // t of metallic_roughness.h; set with Effect::transmission_map by a GlassMap only
  SurfaceFilm film;      // set with Effect::iridescence
};

// True if the ray met the back of a one-sided surface. Glass bodies have both sides. Only visible surfaces are culled:
// a one-sided surface casts its shadow whichever side the light is on.
inline bool is_culled(const Material& m, bool front) { return !front && !m.double_sided && is_zero(m.transmission); }

// True if two surfaces of one frame are equal in every respect.
inline bool same_surface(const Surface& a, const Surface& b) {
  return a.hit.triangle == b.hit.triangle && a.hit.u == b.hit.u && a.hit.v == b.hit.v && a.front == b.front;
}

// Specular or mirror reflectance of the material at the surface, given the tinted part of it.
inline Vec3 reflectance_at(const Surface& s, const Vec3& reflectance, const Vec3& tinted) {
  return s.is_tinted ? reflectance - tinted * (Vec3{1, 1, 1} - s.tint) : reflectance;
}

// The material's glossy lobe at the surface, with its grain if it has one (Effect::anisotropy).
inline const BrdfInfo& lobe_at(const FrameData& frame, const Surface& s, const Material& m) {
  const BrdfInfo* lobe = kBrdfList[m.brdf];
  return has(frame.mask, Effect::anisotropy) && lobe->with_grain && !is_zero(s.grain) ? *lobe->with_grain : *lobe;
}

// Selects the instance for the plan's mask.
SurfaceFunction find_surface_function(EffectMask mask);
// Selects the function that sets Surface::glow alone.
GlowFunction find_glow_function(EffectMask mask);

// Distance from a computed point to a ray origin that no rounding error puts on the wrong side. Each coordinate of the
// point errs by at most γ₈·Σ|bᵢ vᵢ| [PBR3 sec. 3.9.4]; moving by that error, projected on the normal, leaves the slab
// of uncertainty. It vanishes on a plane through a zero coordinate; there the rounding of the next intersection
// decides. Within a few ulp of an edge, that has float precision relative to the triangle as seen from the point
// (accel/triangle.h), hence the second term; it was found with 10⁶ spawned rays per shape (tests/shade/spawn_test.cpp).
// Scale-free: everything is relative to the coordinates.
inline float origin_offset(const Vec3& point_magnitude, float corner_distance, const Vec3& geometric) {
  constexpr float u = std::numeric_limits<float>::epsilon() * 0.5f;
  constexpr float gamma = 8 * u / (1 - 8 * u);
  // Twice: once for the point, once for rounding the moved origin.
  return dot(abs(geometric), point_magnitude) * (2 * gamma) + corner_distance * (4 * u);
}
// value + step, rounded away from the value.
inline float away_from(float value, float step) {
  float moved = value + step;
  return step == 0 ? moved : next_float_towards(moved, step);
}
// The point moved to its safe origin on one side (+1: the side the ray came from, -1: the other).
inline Vec3 safe_origin(const Surface& s, float side) {
  return {away_from(s.point.x, s.offset.x * side), away_from(s.point.y, s.offset.y * side),
          away_from(s.point.z, s.offset.z * side)};
}

// True if a light is below the plane of the triangle. It may still light the curved surface described by the normals.
inline bool is_below(const Surface& s, const Vec3& to_light) { return !(dot(s.geometric, to_light) > 0); }

// Origin of a shadow ray that starts below the flat triangle but above the curved surface that the vertex normals
// describe: the point is moved onto the planes through the vertices [Hanika 2021, Ray Tracing Gems II ch. 4]. On a flat
// or concave surface it does not move, and the ray meets the triangle itself.
Vec3 curved_origin(const FrameData& frame, const Surface& s);

}  // namespace pocketray
