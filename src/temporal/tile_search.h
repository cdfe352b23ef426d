// A search of one tile, for the files that do parts of it.
#pragma once
#include "shade/camera.h"
#include "shade/lights.h"
#include "temporal/tile_changes.h"

namespace pocketray {

// The pixels of a tile, in Morton order: neighbours adjacent.
struct TilePixels {
  std::uint32_t column, row;  // of the first
  std::uint32_t count = 0;
  std::uint8_t x[kPacketMax], y[kPacketMax];
};

inline std::uint64_t bit_of(const TilePixels& p, std::uint32_t i) { return std::uint64_t(1) << (8 * p.y[i] + p.x[i]); }

inline std::size_t index_of(const Settings& settings, const TilePixels& p, std::uint32_t i) {
  return std::size_t(p.row + p.y[i]) * settings.width + p.column + p.x[i];
}

inline Ray sample_ray(const FrameData& frame, const TilePixels& p, std::uint32_t i, const Vec2& offset) {
  return camera_ray(frame.camera, static_cast<float>(p.column + p.x[i]) + offset.x,
                    static_cast<float>(p.row + p.y[i]) + offset.y);
}

// The point of a hit.
inline Vec3 point_of(const FrameData& frame, const Hit& hit) {
  const Triangle& t = frame.scene->triangles[hit.triangle];
  return frame.positions[t.vertex(0)] * (1 - hit.u - hit.v) + frame.positions[t.vertex(1)] * hit.u +
         frame.positions[t.vertex(2)] * hit.v;
}

struct PixelRect {
  std::uint32_t column, row, width, height;
};

struct TileSearch {
  const ChangeSearch& search;
  const FrameData& frame;
  const TilePixels& pixels;
  std::uint64_t changed;
  std::uint64_t given;  // pixels that may give other light to those about them
  ChangeCounts* counts;
  TraceStats* stats;
  const Hit* hits;  // of the sample
  Vec2 offset = {0, 0};
  std::uint32_t receiver_count = 0;   // first hits that may receive light
  std::uint8_t receiver[kPacketMax];  // their pixels
  Vec3 point[kPacketMax];             // of each receiver
  std::uint64_t has_surface = 0;      // of each receiver
  Surface surface[kPacketMax];        // of each receiver

  // Leaves the receivers as they are: there are kilobytes of them.
  TileSearch(const ChangeSearch& search_, const TilePixels& pixels_, std::uint64_t changed_, std::uint64_t given_,
             ChangeCounts* counts_, TraceStats* stats_)
      : search(search_),
        frame(*search_.frame),
        pixels(pixels_),
        changed(changed_),
        given(given_),
        counts(counts_),
        stats(stats_),
        hits(nullptr) {}
};

// All camera rays of some pixels, up to a distance.
Beam camera_beam(const CameraRays& camera, const PixelRect& pixels, float t_max);
// All shadow rays to a light, and to an interleaved source, from some points and at most `room` beside them.
Beam shadow_beam(const LightRun& run, const LightPoint& light, const Box& points, float room);
Beam source_beam(const InterleavedSource& source, const Vec3& place, const Box& points, float room);

// Whether a camera ray of some pixels, these among others, may meet a change; `t_max` is of the farthest hit.
bool sees_change(const ChangeSearch& search, const PixelRect& pixels, float t_max);
// Pixels whose first hits may have changed; `t_max` is of the farthest.
void find_changed_hits(TileSearch* t, float t_max);

// The surface of receiver k.
const Surface& surface_of(TileSearch* t, std::uint32_t k);

// Whether a shadow ray from the tile to the light may meet a change.
bool may_shade(const ChangeSearch& search, const TileHits& hits, const LightRun& run, const LightPoint& light);
// Pixels that the light reached, or would reach, if nothing were in the way, before or after it changed.
void find_lit_by(TileSearch* t, const LightRun& run, std::uint32_t light);
// Pixels whose shadow ray to the light is blocked where it was not, or no longer. If what is found is kept, whether
// something static blocks a ray is found at the first look, otherwise only where it matters.
void find_changed_shadows(TileSearch* t, const LightRun& run, std::uint32_t light, float room, bool is_kept,
                          KnownShadows* known);

// Those of the interleaved sources to which a ray from the tile may meet a change; `among`: null for all of them.
SourceSets suspect_sources(const ChangeSearch& search, const TileHits& hits, const SourceSets* among);
// The same of rays of compensation and the lights that they find.
PathSuspects suspect_paths(const ChangeSearch& search, const TileHits& hits, const Box& ends,
                           const PathSuspects* among);
// A box around the ends of rays of compensation of the tile's pixels `known`.
Box measure_path_ends(const FrameData& frame, const Hit* first_hits, const KeptPath* paths, const PixelRect& tile,
                      std::uint64_t known);
// Adds the pixels that compensation may give other light to `given` and to `changed`.
void find_other_paths(TileSearch* t, std::uint32_t sample, const TileHits& hits, const PathSuspects& suspects);
// Adds the pixels that may give other light to `given`: without a first hit of the last frame, or by their rays.
void find_other_light(TileSearch* t, const SourceSets& suspects);

}  // namespace pocketray
