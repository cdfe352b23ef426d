// Finds the pixels of a tile whose value can differ from the last frame: beams around the tile's rays find rays that
// may be affected, which are then tested one by one against the moving geometry in its last and present position.
#pragma once
#include "shade/compensation.h"
#include "shade/interleaved.h"
#include "shade/tile_shadows.h"
#include "temporal/moving_geometry.h"
#include "temporal/ray_tables.h"

namespace pocketray {

constexpr std::uint32_t kChangeTileSide = 8;
static_assert(kChangeTileSide * kChangeTileSide == kPacketMax, "a packet for each tile");

// Extent of all first hits of a tile.
struct TileHits {
  Box points = empty_box();
  float room = 0;   // largest offset of a shadow ray from its point, in each coordinate
  float t_max = 0;  // of the farthest; infinite if a ray misses
};

// Data of the last frame: the first hit per pixel and sample, and per pixel whether it has rays in the tables.
struct LastFrame {
  const Hit* first_hits = nullptr;  // width × height per sample
  const std::uint8_t* marked = nullptr;
  Array<const LightPoint> lights, sample_lights;  // Lights::points and sample_points
  Array<const LightPolygon> light_polygons;
};

// Per tile, sample and light, bit 8·y + x for each pixel: whether it is known if the moving geometry in its present
// position blocks the first hit's shadow ray, and whether it does; whether the pixel needs no test while its first hit
// stays, since it casts no ray or something immovable always blocks it.
struct KnownShadows {
  std::uint64_t known = 0, blocked = 0, idle = 0;
};
constexpr std::uint32_t kKnownLights = 8;  // further lights are tested anew in each frame

struct ChangeSearch {
  const FrameData* frame;
  const MovingGeometry* moving;
  const RayTables* tables;  // null: no rays in tables; otherwise with dirty blocks
  LastFrame last;
  const TileHits* tiles;  // by row
  std::uint32_t tile_columns;
  bool lights_changed;          // at least one
  Array<KnownShadows> shadows;  // for each sample, tile and light of the first `known_lights`
  std::uint32_t known_lights, tile_count;
  const KeptPath* paths;  // by first hit; null: there are none
  const Box* path_ends;   // by tile
};

inline KnownShadows* known_shadows(const ChangeSearch& s, std::uint32_t sample, std::uint32_t tile) {
  return s.shadows.data + (std::size_t(sample) * s.tile_count + tile) * s.known_lights;
}

// Rays traced for these tests.
struct ChangeCounts {
  std::uint64_t moving_rays = 0;  // against the moving geometry only
  std::uint64_t static_rays = 0;  // shadow rays against everything else
};

// Some of the interleaved sources, and the places of the pattern whose pixels have rays to one of them.
struct SourceSet {
  std::uint64_t bits[(kInterleavedSourceMax + 63) / 64] = {};
  std::uint32_t places = 0;

  void add(std::uint32_t index, std::uint32_t place_in_pattern) {
    bits[index / 64] |= std::uint64_t(1) << (index % 64);
    places |= 1u << place_in_pattern;
  }
  bool has(std::uint32_t index) const { return bits[index / 64] >> (index % 64) & 1; }
};
// A set of each kind.
struct SourceSets {
  SourceSet of[kInterleavedSourceCount];
};
inline bool is_empty(const SourceSets& sets) {
  for (const SourceSet& set : sets.of)
    if (set.places) return false;
  return true;
}

// Rays of compensation, and shadow rays from their ends, that may meet a change.
struct PathSuspects {
  bool first = false;        // the rays themselves
  bool any = false;          // these or shadow rays
  std::uint64_t lights = 0;  // bit i for light i, of the first lights
  SourceSet virtual_lights;
};

// Targets to which rays of some adjacent tiles may meet a change: the camera, interleaved sources, and the first
// lights, bit i for light i.
struct Suspects {
  bool seen;
  std::uint64_t lights;
  SourceSets sources;
  PathSuspects paths;
};
constexpr std::uint32_t kSuspectLights = 64;  // further ones are always suspect
constexpr std::uint32_t kSuspectTiles = 8;    // tested together
// Suspects of the tiles [begin, end) of a row.
Suspects suspects_of(const ChangeSearch& search, std::uint32_t begin, std::uint32_t end);

// Returns the tile's pixels that must be traced again, bit 8·y + x, among the pixels `known`, whose last frame is kept.
// Adds those that may pass different light to their neighbours (shade/interleaved.h) to `given`.
std::uint64_t find_changed_pixels(const ChangeSearch& search, std::uint32_t tile, const Suspects& suspects,
                                  std::uint64_t known, std::uint64_t* given, ChangeCounts* counts, TraceStats* stats);
// Invalidates what is known of the shadows of pixels that are traced again.
void forget_shadows(const ChangeSearch& search, std::uint32_t tile, std::uint64_t changed);

// Measures the pixels `known` of a tile of the current frame.
TileHits measure_tile(const FrameData& frame, const Hit* first_hits, std::uint32_t column, std::uint32_t row,
                      std::uint64_t known);

}  // namespace pocketray
