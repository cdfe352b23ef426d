// Temporal coherence: renders a frame by tracing only the pixels that can differ from the last one [Jevans92]. Every
// frame equals the frame traced whole, bit for bit.
//
// The paper's tables record for every ray which voxels it passed. Here they record only rays behind mirrors and
// transparent surfaces. Camera rays and the shadow rays from their first hits need no tables: the first hits are kept,
// so these rays are known and can be tested against moving geometry.
#pragma once
#include "base/span.h"
#include "temporal/frame_signature.h"
#include "temporal/ray_observer.h"
#include "temporal/recoloring.h"
#include "temporal/tile_changes.h"

namespace pocketray {

// True if first hits have rays of compensation.
constexpr bool is_compensated(const Quality& quality, EffectMask mask) {
  return has(mask, Effect::instant_radiosity) && quality.compensation == Compensation::rays;
}

// Capacities and modes.
struct CoherencePlan {
  std::uint32_t width, height, samples, threads;
  std::uint32_t light_points, sample_points, area_lights;  // at most
  std::uint32_t table_side;
  bool tables_only;           // the paper's method: every ray in tables, whole blocks traced again
  std::uint32_t recolorable;  // number of materials that may change
  bool compensated;           // virtual lights, if there are any
};

struct Coherence {
  CoherencePlan plan = {};
  MovingGeometry moving;
  Recoloring recoloring;
  RayTables tables;  // empty if none are kept
  Array<Hit> first_hits;
  Array<std::uint8_t> marked;  // a byte per pixel: 1 if it has rays in the tables
  Array<TileHits> tiles;
  Array<KnownShadows> shadows;   // as in ChangeSearch
  Array<std::uint64_t> changed;  // pixels of each tile to trace, bit 8·y + x
  Array<std::uint64_t> given;    // pixels that may pass different light to their neighbours; empty: none ever do
  Array<LightPoint> lights, sample_lights;  // of the last frame
  Array<LightPolygon> light_polygons;
  Array<VirtualLights> virtual_lights;  // one, if there are any
  Array<KeptPath> paths;                // like first_hits, for rays of compensation; empty: there are none
  Array<Box> path_ends;                 // by tile
  Array<MarkingObserver> observers;
  Array<ChangeCounts> counts;  // by thread
  Array<Span> spans;           // some rows of tiles as spans
  AccelInfo observed;
  std::uint32_t tile_columns = 0, tile_rows = 0;
  FrameSignature signature;        // of the last frame; if unknown, the next is traced whole
  FrameSignature followed;         // of the current frame
  Array<std::uint8_t> row_known;   // 1: the row's data are the last frame's; other rows are traced whole
  Array<std::uint8_t> row_traced;  // 1: this frame has traced all of the row that it must; for keep_rows()
  std::uint64_t kept_count = 0;    // frames kept
  bool following = false;          // a frame has been followed and is not kept yet
  std::uint32_t light_count = 0, sample_light_count = 0;
  ChangeSearch search = {};
};

// Bytes from the arena that keeps it, and from scratch memory that is released.
std::size_t coherence_need(const Scene& scene, EffectMask mask, const CoherencePlan& plan);
std::size_t coherence_scratch_need(const Scene& scene, EffectMask mask);
// The frame must be posed, with kernels chosen.
void make_coherence(const FrameData& frame, const CoherencePlan& plan, Arena* keep, Arena* scratch, Coherence* c);

// Returns whether the frame can be followed: its samples and effects are within the plan.
bool fits(const Coherence& c, const FrameData& frame);

// Forgets the last frame.
inline void forget_frame(Coherence* c) { c->signature.known = c->following = false; }

// Call between frames after a change of a material.
void recolor(Coherence* c, std::uint32_t material, const Material& was, const Material& is, const Scene& scene);

// Follows the frame's geometry and compares it with the last frame. Returns true if find_changes() can tell which
// pixels to trace; false if all must be traced, with a readable reason in *why.
bool follow_frame(Coherence* c, const FrameData& frame, const char** why);
// Returns whether the frame equals the last one; call after follow_frame() returned true.
bool is_unchanged(const Coherence& c);

// Finds the pixels to trace in a row of tiles; threads may share the rows.
void find_changes(Coherence* c, std::uint32_t tile_row, std::uint32_t thread, TraceStats* stats);
// Call after all rows: adds the pixels that take light from neighbours whose light changed ...
void spread_changes(Coherence* c);
// ... and deletes the records of pixels that are traced again.
void clear_changes(Coherence* c);
// Lists the pixels to trace of a row of tiles as spans, at most row_spans_max(width); returns their number.
constexpr std::uint32_t line_spans_max(std::uint32_t width) { return width / 2 + 1; }
constexpr std::uint32_t row_spans_max(std::uint32_t width) { return kChangeTileSide * line_spans_max(width); }
std::uint32_t list_changes(const Coherence& c, std::uint32_t tile_row, Span* spans);
// list_changes() for the columns [begin, end) of one row of pixels, at most line_spans_max(end - begin).
std::uint32_t list_changes(const Coherence& c, std::uint32_t row, std::uint32_t begin, std::uint32_t end, Span* spans);
inline bool is_changed(const Coherence& c, std::uint32_t row, std::uint32_t column) {
  const std::size_t tile = std::size_t(row / kChangeTileSide) * c.tile_columns + column / kChangeTileSide;
  return c.changed[tile] >> (row % kChangeTileSide * kChangeTileSide + column % kChangeTileSide) & 1;
}
// Number of pixels of the row to trace.
std::uint32_t count_changes(const Coherence& c, std::uint32_t row);

// Has the frame's tracers record what the next frame needs, until stop_recording().
void start_recording(Coherence* c, FrameData* frame, Array<Tracer> tracers);
void stop_recording(const AccelInfo& accel_info, FrameData* frame, Array<Tracer> tracers);

// Call once all of them are traced: keeps the frame as the last one ...
void keep_frame(Coherence* c, const FrameData& frame);
// ... or only its rows that are traced or unchanged ...
void keep_rows(Coherence* c, const FrameData& frame);
// ... and measures a row of tiles: the changed ones or all of them.
void measure_tiles(Coherence* c, const FrameData& frame, std::uint32_t tile_row, bool all);

}  // namespace pocketray
