// Interleaved sampling [Keller & Heidrich 2001; Wald et al. 2002] of virtual lights and of the environment: each pixel
// traces shadow rays to a sixteenth of the sources, chosen by its place in a 4 × 4 pattern, and takes the mean over
// nearby pixels on its surface: those linked to it along its row, then along a column, by neighbours on that surface.
// Where these are few, all nearby pixels estimate how much light is hidden. A pixel depends only on the 4 × 4 pixels
// around it: these are traced whichever pixels are requested, so that the picture does not depend on how it is
// divided.
#pragma once
#include <algorithm>

#include "effect/effect_list.h"
#include "shade/strip.h"
#include "shade/surface.h"

namespace pocketray {

constexpr EffectMask kInterleavedEffects = effects_with(&EffectRow::reads, Reads::neighbours);
constexpr bool is_interleaved(EffectMask mask) { return (mask & kEffectsBuilt & kInterleavedEffects) != 0; }

constexpr std::uint32_t kPatternSide = 4, kPatternPixels = kPatternSide * kPatternSide;
// A pixel takes light from up to this many columns and rows before and after it, one pixel per place in the pattern.
constexpr std::uint32_t kTakenBefore = 1, kTakenAfter = 2;
static_assert(kTakenBefore + 1 + kTakenAfter == kPatternSide, "each place of the pattern once");

// First hits of up to kPacketMax pixels, and the pixels' places in the pattern in Morton order.
struct InterleavedPoints {
  std::uint32_t count;
  const Surface* const* surface;
  const std::uint8_t* place;
  const std::uint32_t* pixel = nullptr;  // index in KeptRays::compensation_paths; null: none is kept
};
// Light from a pixel's sixteenth of the sources, or a sum over pixels: with (lit) and without (open) shadows.
struct InterleavedLight {
  Vec3 lit = {0, 0, 0}, open = {0, 0, 0};
  std::uint32_t pixel_count = 1;
};

constexpr int kInterleavedSourceCount = 2;

// Light gathered at a pixel.
struct InterleavedPixel {
  std::uint32_t row;       // row in the picture; kNone: nothing gathered yet
  std::uint32_t triangle;  // kNone: the ray hits nothing, and the rest is not set
  Vec3 point, normal, geometric;
  InterleavedLight light[kInterleavedSourceCount];
};
// The last rows of a row of tiles, from which the next row of tiles takes light.
constexpr std::uint32_t kKeptRows = kTakenBefore + kTakenAfter;
constexpr std::uint32_t kept_pixel_count(const Settings& settings) { return kKeptRows * settings.width; }
// Gives a tracer its pixels for a frame.
void keep_interleaved_pixels(Array<InterleavedPixel> pixels, Tracer* tracer);

constexpr std::uint32_t kInterleavedSourceMax = std::max(kVirtualLightRoom, kEnvironmentLightMax);
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
  bool reads_open;  // irradiance() reads InterleavedLight::open even where many pixels show the surface
  std::uint32_t (*count)(const FrameData& frame);
  Vec3 (*place)(const FrameData& frame, std::uint32_t index);  // a point, or the direction towards a distant source
  std::uint32_t (*place_in_pattern)(const FrameData& frame, std::uint32_t index);  // that samples it
  // Lists the shadow rays of a first hit, at most kSourcesOfPixelMax, and returns their number.
  std::uint32_t (*list_rays)(const FrameData& frame, const Surface& surface, std::uint32_t place_in_pattern,
                             SourceRay* rays);
  void (*gather)(const FrameData& frame, const InterleavedPoints& points, TraceStats* stats, std::uint64_t* rays,
                 InterleavedLight* light);
  // Irradiance / π at a point of unit normal, from the sum over the pixels that show its surface; if these are few,
  // from the sum over all pixels around it, of which only the unshadowed share counts.
  Vec3 (*irradiance)(const FrameData& frame, const Vec3& point, const Vec3& normal, const InterleavedLight& sum,
                     bool are_few);
};
extern const InterleavedSource kVirtualLightSource, kEnvironmentSource;
constexpr const InterleavedSource* kInterleavedSources[kInterleavedSourceCount] = {&kVirtualLightSource,
                                                                                   &kEnvironmentSource};

// Returns whether two pixels, both of which hit something, show one surface.
bool shows_same(const InterleavedPixel& a, const InterleavedPixel& b);

// Traces the strip's pixels.
void trace_interleaved(Tracer* tracer, const TileStrip& strip, const PixelRows& image);

}  // namespace pocketray
