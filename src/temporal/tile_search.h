// The search of one tile, for the files that implement its parts.
#pragma once
#include "shade/camera.h"
#include "shade/lights.h"
#include "temporal/tile_changes.h"

namespace pocketray {

// The pixels of a tile in Morton order: neighbours are adjacent.
struct TilePixels {
  std::uint32_t column, row;  // of the first pixel
  std::uint32_t count = 0;
  std::uint8_t x[kPacketMax], y[kPacketMax];
};

inline std::uint64_t bit_of(const TilePixels& p, std::uint32_t i) { return std::uint64_t(1) << (8 * p.y[i] + p.x[i]); }

inline std::size_t index_of(const Settings& settings, const TilePixels& p, std::uint32_t i) {
  return std::size_t(p.row + p.y[i]) * settings.width + p.column + p.x[i];
}

inline Ray sample_ray(const FrameData& frame, const TilePixels& p, std::uint32_t i, const Vec2& offset) {
  return camera_ray(frame.view.camera, static_cast<float>(p.column + p.x[i]) + offset.x,
                    static_cast<float>(p.row + p.y[i]) + offset.y);
}

// Position of a hit.
inline Vec3 point_of(const FrameData& frame, const Hit& hit) {
  const Triangle& t = frame.scene->triangles[hit.triangle];
  return frame.geometry.positions[t.vertex(0)] * (1 - hit.u - hit.v) + frame.geometry.positions[t.vertex(1)] * hit.u +
         frame.geometry.positions[t.vertex(2)] * hit.v;
}

struct PixelRect {
  std::uint32_t column, row, width, height;
};

struct TileSearch {
  const ChangeSearch& search;
  const FrameData& frame;
  const TilePixels& pixels;
  std::uint64_t changed;
  std::uint64_t given;  // pixels that may pass different light to their neighbours
  ChangeCounts* counts;
  TraceStats* stats;
  const Hit* hits;                          // of the sample
  const LightPoint* lights = nullptr;       // the sample's
  const LightPoint* last_lights = nullptr;  // in the last frame
  Vec2 offset = {0, 0};
  std::uint32_t receiver_count = 0;   // first hits that may receive light
  std::uint8_t receiver[kPacketMax];  // their pixels
  Vec3 point[kPacketMax];             // by receiver
  std::uint64_t has_surface = 0;      // by receiver
  Surface surface[kPacketMax];        // by receiver

  // Does not initialize the receivers: they take kilobytes.
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

// Beam of all camera rays of some pixels, up to a distance.
Beam camera_beam(const CameraRays& camera, const PixelRect& pixels, float t_max);
// Beams of all shadow rays to a light, and to an interleaved source, from points and at most `room` beside them.
Beam shadow_beam(const LightRun& run, const LightPoint& light, const Box& points, float room);
// ... to the points that all samples have of light point `light`.
Beam shadow_beam(const FrameData& frame, const LightRun& run, std::uint32_t light, const Box& points, float room);
Beam source_beam(const InterleavedSource& source, const Vec3& place, const Box& points, float room);

// Returns whether a camera ray of these or other pixels may meet a change; `t_max` is the farthest hit's.
bool sees_change(const ChangeSearch& search, const PixelRect& pixels, float t_max);
// Finds pixels whose first hits may have changed; `t_max` is the farthest hit's.
void find_changed_hits(TileSearch* t, float t_max);

// Returns the surface of receiver k.
const Surface& surface_of(TileSearch* t, std::uint32_t k);

// Returns whether a shadow ray from the tile to the light may meet a change.
bool may_shade(const ChangeSearch& search, const TileHits& hits, const LightRun& run, std::uint32_t light);
// Finds pixels that the light reached or would reach unblocked, before or after it changed.
void find_lit_by(TileSearch* t, const LightRun& run, std::uint32_t light);
// Finds pixels whose shadow ray to the light is blocked where it was not, or no longer. If results are kept, the first
// test also checks whether something static blocks a ray, otherwise only where it matters.
void find_changed_shadows(TileSearch* t, const LightRun& run, std::uint32_t light, float room, bool is_kept,
                          KnownShadows* known);

// Returns the interleaved sources to which a ray from the tile may meet a change; `among`: null for all of them.
SourceSets suspect_sources(const ChangeSearch& search, const TileHits& hits, const SourceSets* among);
// Returns the suspects among rays of compensation and their lights.
PathSuspects suspect_paths(const ChangeSearch& search, const TileHits& hits, const Box& ends,
                           const PathSuspects* among);
// Returns a box around the ends of rays of compensation of the tile's pixels `known`.
Box measure_path_ends(const FrameData& frame, const Hit* first_hits, const KeptPath* paths, const PixelRect& tile,
                      std::uint64_t known);
// Adds the pixels to which compensation may give different light to `given` and to `changed`.
void find_other_paths(TileSearch* t, std::uint32_t sample, const TileHits& hits, const PathSuspects& suspects);
// Adds pixels that may pass on different light to `given`: without the last frame's first hit, or by their rays.
void find_other_light(TileSearch* t, const SourceSets& suspects);

}  // namespace pocketray
