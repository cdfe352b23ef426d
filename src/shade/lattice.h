// Undersampling: the pixels of a lattice are traced, the others reconstructed along the edges between them.
//
// A checkerboard has half of the pixels; every other pixel of every other row is a quarter. A missing pixel of a
// checkerboard lies between two pairs of opposite neighbours and takes the mean of the pair that differs less. A
// quarter is first completed to a checkerboard along the diagonals, as in [Zhou et al. 2012, "Image Zooming Using
// Directional Cubic Convolution Interpolation", sec. 2] with means for cubics. At the picture's edges it is mirrored.
//
// A pixel depends only on pixels at most two columns and rows away: the picture does not depend on how it is divided.
#pragma once
#include "shade/strip.h"

namespace pocketray {

constexpr bool on_lattice(Resolution resolution, std::uint32_t column, std::uint32_t row) {
  switch (resolution) {
    case Resolution::full:
      return true;
    case Resolution::half:
      return (column | row) % 2 == 0;
    case Resolution::checkerboard:
      break;
  }
  return (column + row) % 2 == 0;
}

// True if memory is planned for undersampling, even if it is off at first.
constexpr bool plans_lattice(const Settings& settings) {
  const EffectMask effect = bit(Effect::undersampling);
  return (settings.resolution != Resolution::full || (settings.forced_on & effect)) && !(settings.forced_off & effect);
}

// Traces or reconstructs the strip's pixels.
void trace_lattice(Tracer* tracer, const TileStrip& strip, const PixelRows& image);

}  // namespace pocketray
