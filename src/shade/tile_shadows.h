// Shadow rays of a tile's first hits, traced in packets before shading needs them.
#pragma once
#include <type_traits>

#include "shade/polygon_light.h"

namespace pocketray {

constexpr std::uint32_t kTileLightMax = 256;  // further lights are tested ray by ray
constexpr std::uint32_t kTilePolygonMax = 4;  // of further lamps, polygons are viewed again
constexpr std::uint32_t kTileSampleMax = 8;   // and the light from all but these is computed again: 12 KiB

// The light that arrives at a pixel's first hit unless it is blocked; see LightSample.
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

// The same of pixels as bits.
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

// A flat lamp as the pixels' first hits see it, where they do (`viewed`); the pixels from which all of its points are
// seen, and those from which none is, as far as the rays of the tile tell.
struct TilePolygon {
  PolygonView view[kPacketMax];
  TileMask viewed, open, blocked;
};

// For each pixel of a tile the surface at its first hit, if any. For each light, which of the pixels it lights up,
// whose shadow rays were traced, and which of these are blocked by something opaque.
struct TileShadows {
  Surface surface[kPacketMax];
  TileSample sample[kTileSampleMax][kPacketMax];  // of the pixels that are lit up
  TileMask lit[kTileLightMax], traced[kTileLightMax], blocked[kTileLightMax];
  TileMask decided[kTileLightMax];        // of points in groups, instead of `traced`; not set without groups
  TilePolygon polygons[kTilePolygonMax];  // of LightRun::polygons; not set without them
};

// Fills `shadows` for the rays of a packet and their first hits.
void find_tile_shadows(Tracer* tracer, const RayPacket& rays, const Hit* hits, TileShadows* shadows);
// The same where FrameData has point groups or polygons; counts the rays that it traces to points in groups.
void find_lamp_tile_shadows(Tracer* tracer, const RayPacket& rays, const Hit* hits, TileShadows* shadows);

// The sample of a light at the first hit, if find_tile_shadows() has kept it. False: not known. Otherwise *sample is
// null if the light does not light it up.
inline bool is_sampled(const Tracer& tracer, std::uint32_t light, const TileSample** sample) {
  if (!tracer.tile_shadows || light >= kTileSampleMax) return false;
  const TileShadows& tile = *tracer.tile_shadows;
  *sample = tile.lit[light][tracer.tile_pixel] ? &tile.sample[light][tracer.tile_pixel] : nullptr;
  return true;
}

// The lamp of that number as the first hit sees it, if that is known.
inline const TilePolygon* tile_polygon(const Tracer& tracer, std::uint32_t lamp) {
  if (!tracer.tile_shadows || lamp >= kTilePolygonMax) return nullptr;
  const TilePolygon& polygon = tracer.tile_shadows->polygons[lamp];
  return polygon.viewed[tracer.tile_pixel] ? &polygon : nullptr;
}

// Whether the result of a shadow ray from the first hit is known, and the result. (The packet holds no ray that starts
// below the surface.)
inline bool is_known(const Tracer& tracer, std::uint32_t light, bool* blocked) {
  if (!tracer.tile_shadows || light >= kTileLightMax) return false;
  if (!tracer.tile_shadows->traced[light][tracer.tile_pixel]) return false;
  *blocked = tracer.tile_shadows->blocked[light][tracer.tile_pixel];
  return true;
}

}  // namespace pocketray
