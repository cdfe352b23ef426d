// Interleaved sampling [Keller & Heidrich 2001; Wald et al. 2002] of virtual lights and of the environment: each pixel
// traces shadow rays to a sixteenth of the sources, chosen by its place in a 4 × 4 pattern, and takes the mean over
// nearby pixels on its surface: those linked to it along its row, then along a column, by neighbours on that surface.
// Where these are few, all nearby pixels estimate how much light is hidden. A pixel depends only on the 4 × 4 pixels
// around it: these are traced whichever pixels are requested, so that the picture does not depend on how it is
// divided.
#pragma once
#include <algorithm>
#include <cstring>

#include "effect/effect_list.h"
#include "shade/strip.h"
#include "shade/surface.h"

namespace pocketray {

constexpr EffectMask kInterleavedEffects = effects_with(&EffectRow::reads, Reads::neighbours);
constexpr bool is_interleaved(EffectMask mask) { return (mask & kEffectsBuilt & kInterleavedEffects) != 0; }

constexpr std::uint32_t kPatternSide = 4, kPatternPixels = kPatternSide * kPatternSide;
// A pixel takes light from up to so many columns and rows before and after it: each place of the pattern equally often.
// Pixels after it are traced for it, and again for themselves, so that there are fewer.
template <std::uint32_t before, std::uint32_t after>
struct Reach {
  static constexpr std::uint32_t kBefore = before, kAfter = after, kTakenSide = before + 1 + after,
                                 kTakenPixels = kTakenSide * kTakenSide, kKeptRows = before + after;
  static constexpr std::uint32_t kRegionSide = before + kTileSide + after, kRegionPixels = kRegionSide * kRegionSide;
  static_assert(kTakenSide % kPatternSide == 0, "whole patterns");
};
using NearReach = Reach<1, 2>;
using FarReach = Reach<5, 2>;  // with shadows from the environment: four patterns, each with other sources

// A pixel's place in the pattern, in Morton order, in the lower bits, and above them the variant of its pattern:
// patterns close to each other differ most.
constexpr std::uint32_t kPlaceBits = 4, kVariantBits = 4;
static_assert(kPatternPixels == 1u << kPlaceBits && kPlaceBits + kVariantBits <= 8, "8 bits hold both");
constexpr std::uint32_t source_place(std::uint32_t column, std::uint32_t row) {
  const std::uint32_t x = column / kPatternSide, y = row / kPatternSide;
  const std::uint32_t variant = ((x ^ y) & 1) << 3 | (y & 1) << 2 | (x / 2 ^ y / 2) % 2 << 1 | y / 2 % 2;
  return variant << kPlaceBits | morton_place(column % kPatternSide, row % kPatternSide);
}
constexpr std::uint32_t place_of(std::uint32_t source_place) { return source_place % kPatternPixels; }

// First hits of up to kPacketMax pixels, and the pixels' source_place().
struct InterleavedPoints {
  std::uint32_t count;
  const Surface* const* surface;
  const std::uint8_t* place;
  const std::uint32_t* pixel = nullptr;  // index in KeptRays::compensation_paths; null: none is kept
};
// Light from a pixel's sixteenth of the sources, or a sum over pixels: with (lit) and without (open) shadows.
struct alignas(16) InterleavedLight {
  Vec3 lit = {0, 0, 0}, open = {0, 0, 0};
  float pixel_count = 1, reserved = 0;  // floats, so that sums take two vector additions
};
static_assert(sizeof(InterleavedLight) == 8 * sizeof(float), "no padding");
inline void add(const InterleavedLight& light, InterleavedLight* sum) {
  float a[8], b[8];
  std::memcpy(a, &light, sizeof a), std::memcpy(b, sum, sizeof b);
  for (int i = 0; i < 8; ++i) b[i] += a[i];
  std::memcpy(static_cast<void*>(sum), b, sizeof b);
}

constexpr int kInterleavedSourceCount = 2;

// Light gathered at a pixel.
struct InterleavedPixel {
  std::uint32_t row;       // row in the picture; kNone: nothing gathered yet
  std::uint32_t triangle;  // kNone: the ray hits nothing, and the rest is not set
  Vec3 point, normal, geometric;
  InterleavedLight light[kInterleavedSourceCount];
};
// The last rows of a row of tiles, from which the next row of tiles takes light.
constexpr std::uint32_t kept_pixel_count(const Settings& settings, EffectMask mask) {
  return (has(mask, Effect::environment_shadow) ? FarReach::kKeptRows : NearReach::kKeptRows) * settings.width;
}
// Gives a tracer its pixels for a frame.
void keep_interleaved_pixels(Array<InterleavedPixel> pixels, Tracer* tracer);

constexpr std::uint32_t kInterleavedSourceMax = std::max(kVirtualLightRoom, kEnvironmentLightRoom);
constexpr std::uint32_t kSourcesOfPixelMax =
    std::max(kVirtualLightsOfPlaceMax, (kEnvironmentLightMax + kPatternPixels - 1) / kPatternPixels);
struct SourceRay {
  std::uint32_t source;
  Ray ray;
};

// A kind of source.
struct InterleavedSource {
  Effect effect;
  bool is_distant;
  std::uint32_t (*count)(const FrameData& frame);
  std::uint32_t (*group)(const FrameData& frame);              // so many consecutive distant sources are close; 1: any
  Vec3 (*place)(const FrameData& frame, std::uint32_t index);  // a point, or the direction towards a distant source
  std::uint32_t (*place_in_pattern)(const FrameData& frame, std::uint32_t index);  // of pixels that sample it
  // Lists the shadow rays of a first hit, at most kSourcesOfPixelMax, and returns their number.
  std::uint32_t (*list_rays)(const FrameData& frame, const Surface& surface, std::uint32_t source_place,
                             SourceRay* rays);
  void (*gather)(const FrameData& frame, const InterleavedPoints& points, TraceStats* stats, std::uint64_t* rays,
                 InterleavedLight* light);
  // Irradiance / π at a point of unit normal, from the sum over the pixels that show its surface; if these are few,
  // from the sum over all pixels around it, of which only the unshadowed share counts.
  Vec3 (*irradiance)(const FrameData& frame, const Vec3& point, const Vec3& normal, const InterleavedLight& sum,
                     bool are_few);
  // Adds light at a secondary hit. The tracer counts and observes the rays; the smaller `weight`, the share of the
  // surface's light that reaches the pixel, the fewer there are.
  void (*add_later)(Tracer* tracer, const Vec3& weight, Surface* surface);
};
extern const InterleavedSource kVirtualLightSource, kEnvironmentSource;
constexpr const InterleavedSource* kInterleavedSources[kInterleavedSourceCount] = {&kVirtualLightSource,
                                                                                   &kEnvironmentSource};

// Returns whether two pixels, both of which hit something, show one surface.
bool shows_same(const InterleavedPixel& a, const InterleavedPixel& b);

// Adds the light of the frame's sources at a secondary hit.
void add_later_sources(Tracer* tracer, const Vec3& weight, Surface* surface);

// Traces the strip's pixels.
void trace_interleaved(Tracer* tracer, const TileStrip& strip, const PixelRows& image);

}  // namespace pocketray
