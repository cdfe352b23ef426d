// Pixels traced in full: one by one, or up to 64 together in packets.
#pragma once
#include "shade/surface.h"

namespace pocketray {

// Pixels in an order that keeps neighbours adjacent.
struct Tile {
  std::uint32_t count = 0;
  std::uint16_t column[kPacketMax], row[kPacketMax];
};

inline void add_pixel(std::uint32_t column, std::uint32_t row, Tile* tile) {
  tile->column[tile->count] = static_cast<std::uint16_t>(column);
  tile->row[tile->count++] = static_cast<std::uint16_t>(row);
}

// Fewer rays are faster one by one where they are scattered (bench --sparse, 10 % of the pixels) and hardly slower in
// the patches that temporal coherence traces: these take 1 % fewer instructions with 8, 8 % more with 33.
constexpr std::uint32_t kPacketRaysMin = kPacketMax / 4;

// Reports a pixel to a RayObserver.
void observe_pixel(Tracer* tracer, std::uint32_t column, std::uint32_t row);

// Stores a hit in KeptRays::first_hits, which must exist.
void keep_first_hit(Tracer* tracer, std::uint32_t sample, std::uint32_t column, std::uint32_t row, const Hit& hit);

// Mean of the pixel's samples. `first`, unless null, receives the surface at the first sample's first hit; its material
// is null if there is none.
Vec3 pixel_radiance(Tracer* tracer, std::uint32_t column, std::uint32_t row, Surface* first = nullptr);

// Traces the pixels of a tile of a perspective picture in packets.
void trace_tile(Tracer* tracer, const Tile& tile, const PixelRows& image);

// Adds the radiance of a sample of the tile's pixels, given its rays and their first hits, to `sum`.
void add_sample(Tracer* tracer, const Tile& tile, const RayPacket& packet, const Hit* hits, Vec3* sum);

}  // namespace pocketray
