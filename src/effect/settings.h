// Settings as requested: plain data whose defaults just work.
#pragma once
#include <cstddef>
#include <cstdint>

#include "base/vec3.h"
#include "effect/effect.h"

namespace pocketray {

enum class TextureFilter : std::uint8_t { as_scene, nearest, bilinear, trilinear, anisotropic };
// Whether it reads the levels of textures that have them.
constexpr bool takes_levels(TextureFilter filter) {
  return filter != TextureFilter::nearest && filter != TextureFilter::bilinear;
}
enum class NormalMode : std::uint8_t { as_scene, flat };

// Indirect light: the scene's own, none, or the effect of kIndirectEffects with that index, counted from `first`.
enum class IndirectChoice : std::uint8_t { automatic, none, first };
// Of stored light, between the places where it is stored. On the cells of grids: their mean, bilinear, Hermite patches,
// two triangles of the element of Powell and Sabin, two of Clough and Tocher. On triangles: their mean, linear, linear
// again, and the two elements.
enum class Reconstruction : std::uint8_t { constant, bilinear, bicubic, quadratic, cubic };

// Light that virtual lights lack by the bound of their geometry term: none of it, or as rays find it.
enum class Compensation : std::uint8_t { none, rays };

// Shadow rays to an area light: to some of its points first, and to the others where these differ, or to every point.
enum class AreaShadows : std::uint8_t { adaptive, every };
// Light from flat lamps: the sum over their points, or in closed form.
enum class AreaIrradiance : std::uint8_t { points, analytic };

// The pixels that are traced: all, half of them, or a quarter; see shade/lattice.h.
enum class Resolution : std::uint8_t { full, checkerboard, half };

// The settings that trade accuracy for time, a row of setting_list.h each. They may change from frame to frame.
struct Quality {
  std::uint32_t samples_per_pixel = 1;
  std::uint32_t ray_depth = 8;  // reflections and refractions along a path
  std::uint32_t points_per_area_light = 4;
  float cut_off_levels = 0.5f;  // largest error per sample from skipped rays, in display levels; 0: skip none
  TextureFilter texture_filter = TextureFilter::as_scene;
  NormalMode normals = NormalMode::as_scene;
  IndirectChoice indirect = IndirectChoice::automatic;
  Reconstruction reconstruction = Reconstruction::bicubic;
  std::uint32_t virtual_lights = 64;  // of instant radiosity
  Compensation compensation = Compensation::none;
  float selective_contrast = 0;  // up to which pixels are interpolated, as displayed; 0: all are traced
  Resolution resolution = Resolution::full;
  float light_tolerance = 0.0625f;  // of many lights, the share that may go untested for shadows; 0: all are tested
  std::uint32_t environment_shadows = 32;  // directions; a pixel traces shadow rays along a sixteenth of them; 0: none
};

// Whether frames trace only what may have changed. automatic: where that pays.
enum class CoherenceMode : std::uint8_t { off, automatic, on };

struct Settings : Quality {
  std::uint32_t width = 320, height = 240;  // pixels
  std::uint32_t threads = 1;
  EffectMask forced_on = 0, forced_off = 0;  // --effects
  std::size_t memory_bytes = 64u << 20;      // the fixed block
  CoherenceMode coherence = CoherenceMode::off;
  std::uint32_t coherence_table = 16;  // blocks of pixels along each side, a bit of each voxel's table [Jevans92]
  bool coherence_by_tables = false;    // the paper's way, for comparison: all rays in tables
  // For tests, which compare with what these replace.
  AreaShadows area_shadows = AreaShadows::adaptive;
  AreaIrradiance area_irradiance = AreaIrradiance::analytic;
};

}  // namespace pocketray
