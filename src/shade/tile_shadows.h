// Shadow rays of a tile's first hits, traced in packets before shading needs them.
#pragma once
#include <type_traits>

#include "shade/polygon_light.h"
#include "shade/tracer.h"

namespace pocketray {

constexpr std::uint32_t kTileLightMax = 256;  // further lights are tested ray by ray
constexpr std::uint32_t kTilePolygonMax = 4;  // polygons of further lamps are viewed again
constexpr std::uint32_t kTileSampleMax = 8;   // further samples are computed again; these take 12 KiB

constexpr std::uint8_t kTileTraced = 255;

// Unblocked light arriving at a pixel's first hit; see LightSample.
struct TileSample {
  Vec3 direction, irradiance;
};

// A bit for each pixel of a tile, in words that the CPU shifts in one instruction.
struct TileMask {
  using Word = std::conditional_t<sizeof(void*) == 8, std::uint64_t, std::uint32_t>;
  static constexpr std::uint32_t kBits = 8 * sizeof(Word), kWords = kPacketMax / kBits;
  Word word[kWords];

  static constexpr std::uint32_t place(std::uint32_t pixel) { return kWords == 1 ? 0 : pixel / kBits; }
  void set(std::uint32_t pixel) { word[place(pixel)] |= Word{1} << pixel % kBits; }
  bool operator[](std::uint32_t pixel) const { return word[place(pixel)] >> pixel % kBits & 1; }
};

// Converts a 64-bit mask of pixels.
inline TileMask mask_of(std::uint64_t pixels) {
  TileMask mask;
  for (std::uint32_t i = 0; i < TileMask::kWords; ++i)
    mask.word[i] = static_cast<TileMask::Word>(pixels >> i * TileMask::kBits % 64);
  return mask;
}

inline std::uint64_t bits_of(const TileMask& mask) {
  std::uint64_t pixels = 0;
  for (std::uint32_t i = 0; i < TileMask::kWords; ++i)
    pixels |= static_cast<std::uint64_t>(mask.word[i]) << i * TileMask::kBits % 64;
  return pixels;
}

// A flat lamp as seen from the pixels' first hits, for the pixels that are `viewed`; those that see all of its points
// (open) and those that see none (blocked), as far as the tile's rays tell.
struct TilePolygon {
  PolygonView view[kPacketMax];
  TileMask viewed, open, blocked;
};

// Pixels whose first hits receive light, and the origins of their shadow rays, by pixel.
struct TileReceivers {
  std::uint32_t count = 0;
  std::uint8_t pixel[kPacketMax];
  Vec3 origin[kPacketMax];
};

// The surface at the first hit of each pixel, if any. For each light, which pixels it lights up (lit), whose shadow
// rays were traced, and which of these are blocked by something opaque.
struct TileShadows {
  Surface surface[kPacketMax];
  TileSample sample[kTileSampleMax][kPacketMax];  // for the pixels that are lit up
  TileMask lit[kTileLightMax], traced[kTileLightMax], blocked[kTileLightMax];
  TileMask decided[kTileLightMax];        // replaces `traced` for points in groups; not set without groups
  TilePolygon polygons[kTilePolygonMax];  // by index in LightRun::polygons; not set without them
  // Set with Effect::source_selection, as are `traced` and `blocked` of lights that most pixels select.
  TileReceivers receivers;               // from the pixel being shaded on
  std::uint8_t selected[kTileLightMax];  // by so many pixels, or kTileTraced: its rays are traced
};

// Fills `shadows` for the rays of a packet and their first hits.
void find_tile_shadows(Tracer* tracer, const RayPacket& rays, const Hit* hits, TileShadows* shadows);
// Version for frames with point groups or polygons; counts the rays that it traces to points in groups.
void find_lamp_tile_shadows(Tracer* tracer, const RayPacket& rays, const Hit* hits, TileShadows* shadows);

// Returns whether find_tile_shadows() kept the light's sample at the first hit. If so, *sample is null if the light
// does not light it up.
inline bool is_sampled(const Tracer& tracer, std::uint32_t light, const TileSample** sample) {
  if (!tracer.tile_shadows || light >= kTileSampleMax) return false;
  const TileShadows& tile = *tracer.tile_shadows;
  *sample = tile.lit[light][tracer.tile_pixel] ? &tile.sample[light][tracer.tile_pixel] : nullptr;
  return true;
}

// The first hit's view of lamp number `lamp`; null if unknown.
inline const TilePolygon* tile_polygon(const Tracer& tracer, std::uint32_t lamp) {
  if (!tracer.tile_shadows || lamp >= kTilePolygonMax) return nullptr;
  const TilePolygon& polygon = tracer.tile_shadows->polygons[lamp];
  return polygon.viewed[tracer.tile_pixel] ? &polygon : nullptr;
}

// Returns whether the result of a shadow ray from the first hit is known, and the result. (The packet has no ray that
// starts below the surface.)
inline bool is_known(const Tracer& tracer, std::uint32_t light, bool* blocked) {
  if (!tracer.tile_shadows || light >= kTileLightMax) return false;
  if (!tracer.tile_shadows->traced[light][tracer.tile_pixel]) return false;
  *blocked = tracer.tile_shadows->blocked[light][tracer.tile_pixel];
  return true;
}

}  // namespace pocketray
