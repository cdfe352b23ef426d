// Restores the light that virtual lights lose because their geometry term G is bounded [Kollig & Keller 2004,
// "Illumination in the Presence of Weak Singularities"]: the share max(0, G − G_max) / G of the light from nearby
// surfaces, found by rays that end where G must fall below its bound.
#pragma once
#include <atomic>

#include "shade/interleaved.h"

namespace pocketray {

// Adds a sixteenth of the compensation to the light arriving at each pixel. A pixel traces one ray, in the direction of
// its place in the pattern; the sixteen pixels that share light cover all directions evenly. The point hit is lit by
// one light and one virtual light, sampled in proportion to their contribution, with a shadow ray each; it is not
// compensated itself, but its virtual lights have the higher bound.
void add_compensation(const FrameData& frame, const InterleavedPoints& points, TraceStats* stats, std::uint64_t* rays,
                      InterleavedLight* light);

// End of a pixel's ray, and the lights to which shadow rays run from there.
struct CompensationPath {
  Vec3 end;                            // on a surface, or in empty space
  std::uint16_t light, virtual_light;  // kNoPathLight: none
};
constexpr std::uint16_t kNoPathLight = 0xFFFF;
static_assert(kPointLightCountMax < kNoPathLight && kVirtualLightRoom < kNoPathLight, "in 16 bits");
static_assert(sizeof(CompensationPath) == 16, "four words");

// A stored path. Tracers that gather one pixel for its neighbours may store it concurrently, with equal values.
struct KeptPath {
  std::atomic<std::uint32_t> words[4];
};
void store(const CompensationPath& path, KeptPath* kept);
CompensationPath load(const KeptPath& kept);

// Direction for a place in the pattern, about the third axis. Their density is proportional to the cosine with it:
// rings of equal weight hold equally many, sectors too, and each 2 × 2 pixels cover all quarters of both.
Vec3 compensation_direction(std::uint32_t place_in_pattern);

}  // namespace pocketray
