// Requested settings: plain data with defaults that just work.
#pragma once
#include <cstddef>
#include <cstdint>

#include "base/limits.h"
#include "base/tone.h"
#include "effect/effect.h"

namespace pocketray {

enum class TextureFilter : std::uint8_t { as_scene, nearest, bilinear, trilinear, anisotropic };
// Returns whether the filter reads a texture's levels.
constexpr bool takes_levels(TextureFilter filter) {
  return filter != TextureFilter::nearest && filter != TextureFilter::bilinear;
}
enum class NormalMode : std::uint8_t { as_scene, flat };

// Indirect light: the scene's own, none, or an effect of kIndirectEffects, counted from `first`.
enum class IndirectChoice : std::uint8_t { automatic, none, first };
// Interpolation of stored light. On grid cells: mean, bilinear, Hermite patches, two triangles of the Powell-Sabin
// element, two of Clough-Tocher. On triangles: mean, linear, linear again, and the two elements.
enum class Reconstruction : std::uint8_t { constant, bilinear, bicubic, quadratic, cubic };

// Compensation for the light that virtual lights lose by their clamped geometry term: none, or found by rays.
enum class Compensation : std::uint8_t { none, rays };

// Shadow rays to an area light: to some points first, and to the rest where those differ; or to every point.
enum class AreaShadows : std::uint8_t { adaptive, every };
// Light from flat lamps: summed over their points, or in closed form.
enum class AreaIrradiance : std::uint8_t { points, analytic };

// Traced pixels: all, half or a quarter; see shade/lattice.h.
enum class Resolution : std::uint8_t { full, checkerboard, half };

// Settings that trade accuracy for time, each with a row in setting_list.h. They may change from frame to frame.
struct Quality {
  std::uint32_t samples_per_pixel = 1;
  std::uint32_t ray_depth = 8;  // reflections and refractions along a path
  std::uint32_t points_per_area_light = 4;
  float cut_off_levels = 0.5f;  // largest error per sample from skipped rays, in display levels; 0: skip none
  TextureFilter texture_filter = TextureFilter::as_scene;
  NormalMode normals = NormalMode::as_scene;
  IndirectChoice indirect = IndirectChoice::automatic;
  Reconstruction reconstruction = Reconstruction::bicubic;
  std::uint32_t virtual_lights = 64;  // used by instant radiosity
  Compensation compensation = Compensation::none;
  float selective_contrast = 0;  // displayed contrast up to which pixels are interpolated; 0: trace all
  Resolution resolution = Resolution::full;
  float light_tolerance = 0.0625f;         // with many lights, fraction that may skip shadow tests; 0: test all
  std::uint32_t environment_shadows = 32;  // directions; a pixel traces shadow rays along 1/16 of them; 0: none
  std::uint32_t edge_samples = 0;          // added to pixels at edges, if others have one; 0: none
};

// Frames trace only what may have changed. automatic: where that pays off.
enum class CoherenceMode : std::uint8_t { off, automatic, on };

struct Settings : Quality {
  std::uint32_t width = 320, height = 240;  // pixels
  std::uint32_t threads = 1;
  EffectMask forced_on = 0, forced_off = 0;  // --effects
  Tone tone = Tone::clip;
  // Leaves out larger levels of textures (scene/texture_side.h); does not change from frame to frame.
  std::uint32_t texture_side_max = kTextureSideMax;
  std::size_t memory_bytes = 64u << 20;  // the fixed block
  CoherenceMode coherence = CoherenceMode::off;
  std::uint32_t coherence_table = 16;  // blocks of pixels along each side, one bit of each voxel's table [Jevans92]
  bool coherence_by_tables = false;    // as in the paper, for comparison: all rays in tables
  // Switches for tests that compare with the replaced methods.
  AreaShadows area_shadows = AreaShadows::adaptive;
  AreaIrradiance area_irradiance = AreaIrradiance::analytic;
};

}  // namespace pocketray
