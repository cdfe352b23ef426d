// Patches: the pieces between which light is exchanged.
#pragma once
#include "desktop/radiosity/surfaces.h"

namespace pocketray {

constexpr int kPatchSamples = 4, kLightSamples = 64;
constexpr double kAlbedoMax = 0.998;

struct PatchSample {
  Vec3d point, normal;  // unit
  std::uint32_t triangle;
};

struct Patch {
  // Mean over the samples; gloss and mirrors count as diffuse surfaces of their reflectance. At most kAlbedoMax, so
  // that a white room has a solution.
  Vec3d albedo;
  Vec3d emission;  // radiance; the mean over the light samples
  std::uint32_t material;
  Vec3d centre, normal;
  double area, radius;
  double uncovered = 1;                        // share that does not lie inside bodies; the area is without the rest
  double lift;                                 // rays start and end this far above it
  std::vector<std::uint32_t> triangles;        // that it is part of, or consists of
  std::vector<Polygon> pieces;                 // empty: a cluster of small triangles
  std::vector<std::uint32_t> piece_triangles;  // of a flat surface: which triangle each piece is of
  PatchSample samples[kPatchSamples];
  std::vector<PatchSample> light_samples;  // kLightSamples, at which the lights are looked up
  bool is_back, is_flat, double_sided;     // is_flat: a cell of a flat surface
};

// Returns whether light stored on the material's surfaces is ever seen.
inline bool reflects(const Material& m) { return !m.unlit && !(is_zero(m.diffuse) && is_zero(m.specular)); }

// The front patches of all surfaces: cells of flat surfaces, and clusters of the other triangles by place and
// orientation.
std::vector<Patch> make_patches(const Scene& scene, const Surfaces& surfaces);
Patch back_of(const Patch& front);
// A patch of a flat surface, divided across and along.
std::vector<Patch> quarters_of(const Scene& scene, const Surfaces& surfaces, const Patch& patch);

// Unoccluded, from a point.
double patch_form_factor(const Vec3d& point, const Vec3d& normal, const Patch& patch);

}  // namespace pocketray
