// The light that virtual lights lack by the bound of their geometry term G [Kollig & Keller 2004, "Illumination in the
// Presence of Weak Singularities"]: of the light that a nearby surface sends, the share max(0, G − G_max) / G, found by
// rays that end where G must fall below its bound.
#pragma once
#include <atomic>

#include "shade/interleaved.h"

namespace pocketray {

// Adds a sixteenth of it to what arrives at each of the pixels. A pixel has one ray, in the direction of its place in
// the pattern: pixels that share their light have sixteen, spread evenly. What a ray meets is lit by one light and by
// one virtual light, chosen by what they contribute, with a shadow ray each; it is not compensated itself, but its
// virtual lights have the higher bound.
void add_compensation(const FrameData& frame, const InterleavedPoints& points, TraceStats* stats, std::uint64_t* rays,
                      InterleavedLight* light);

// Where a pixel's ray ends, and the lights to which shadow rays run from there.
struct CompensationPath {
  Vec3 end;                            // a point of a surface, or of no surface
  std::uint16_t light, virtual_light;  // kNoPathLight: none
};
constexpr std::uint16_t kNoPathLight = 0xFFFF;
static_assert(kPointLightCountMax < kNoPathLight && kVirtualLightRoom < kNoPathLight, "in 16 bits");
static_assert(sizeof(CompensationPath) == 16, "four words");

// One that is kept. Tracers that gather the same pixel for those about it may store it at the same time: the same one.
struct KeptPath {
  std::atomic<std::uint32_t> words[4];
};
void store(const CompensationPath& path, KeptPath* kept);
CompensationPath load(const KeptPath& kept);

// The direction of a place in the pattern, about the third axis. Their density is the cosine of the angle with it: as
// many lie in each ring of equal weight and in each sector, and each 2 × 2 pixels have all quarters of both.
Vec3 compensation_direction(std::uint32_t place_in_pattern);

}  // namespace pocketray
