// One thread's state while it traces.
#pragma once
#include "accel/accel.h"
#include "base/limits.h"

namespace pocketray {

struct CellCorner;
struct FrameData;
struct InterleavedPixel;
struct LightPoint;
struct Surface;
struct TileShadows;

enum class RayKind : int { primary, shadow, mirror, refraction, blend };
constexpr int kRayKindCount = 5;
constexpr const char* kRayKindNames[kRayKindCount] = {"primary", "shadow", "mirror", "refraction", "blend"};

struct CornerRow {
  Array<CellCorner> corners;
  std::uint32_t row = ~0u;  // row in the picture; ~0: none
};

// Light that a pixel shares with its neighbours (interleaved.h), as samples at edges take it.
struct SharedPixel;

// Pixels of kWindowRows rows with their states; window.h.
struct PixelWindow {
  Array<Vec3> pixels;
  Array<std::uint8_t> states;
  Array<SharedPixel> shared;  // like pixels; empty: none is kept
  std::uint32_t row = ~0u;    // first row of the row of tiles that it surrounds; ~0: none
};

// A light or a group of lights in a search of source selection; the other index is kNone.
struct LightEntry {
  Vec3 radiance;  // unblocked contribution of a light; not set for groups
  float most;     // upper bound of the contribution's brightest channel
  std::uint32_t light, node;
  std::uint16_t run;
  std::uint16_t next;  // next entry of about equal strength
};

// A bit for each point of an area light.
using PointBits = std::uint64_t[kPointsPerAreaLightMax / 64];

// Shadow tests of the last area light tested ray by ray: the points whose rays were traced and which of these were
// blocked; the points settled, by their group or by their own ray, and which of these are blocked.
struct TestedPoints {
  Vec3 point, normal;             // surface that is lit
  std::uint32_t triangle, first;  // first: index of the light's first point; ~0: none
  bool front;
  PointBits traced, met, settled, blocked;
};

// State of the sample being traced where its path branches; branches.h.
struct Branching {
  float allowed = 0;  // total error allowed, as radiance
  float certain = 0;  // darkest channel of the certain light, less CutOff::dark_radiance
  float share = 1;    // largest fraction of `allowed` for one ray
  float ended = 0;    // upper bound of the effect of rays that ended
  float slope = 0;    // growth of `allowed` per `certain`
};

// One thread's state; counters accumulate. Aligned so that threads do not share a cache line.
struct alignas(64) Tracer {
  const FrameData* frame = nullptr;
  std::uint64_t rays[kRayKindCount] = {};
  std::uint64_t rays_left_out = 0, rays_ended = 0;
  TraceStats stats;
  const LightPoint* light_points = nullptr;  // of the sample being traced, see sample_points.h
  std::uint32_t points_of_lamp = 0;          // of these, the first ones of each flat lamp that the sample sees
  const Surface* first_surface = nullptr;    // of the sample being shaded; null: not known
  TileShadows* tile_shadows = nullptr;       // of the current tile, or null
  std::uint32_t tile_pixel = 0;              // index in the tile of the pixel being shaded
  float budget = 0;                          // error still allowed for the current sample, as radiance
  float skip_max = 0;                        // error allowed for a single ray
  Branching branching;
  CornerRow corner_rows[4];                    // kept by selective rendering
  std::uint32_t corner_row_count = 0;          // rows in use: 0, 2 or 4
  Array<InterleavedPixel> interleaved_pixels;  // from the row of tiles above; empty: not planned
  PixelWindow window;                          // empty: not planned
  Array<LightEntry> light_entries;             // scratch of source selection; empty: not planned
  float left_out_max = 0;                      // largest total error of a sample so far
  float left_out_share_max = 0;                // the same error relative to what was allowed
  float ended_weight_max = 0;                  // largest throughput of a ray ended by the maximum depth
  float ended_bound_max = 0;                   // upper bound of the effect of such rays on a sample
  TestedPoints tested_points = {{0, 0, 0}, {0, 0, 0}, 0, ~0u, false, {}, {}, {}, {}};
};

}  // namespace pocketray
