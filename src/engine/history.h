// The frame in progress, and the last one as far as the next may be built on it. Only begin_frame() and end_frame()
// open and close a frame (frame.h); everyone else reads this.
#pragma once
#include "engine/coherence_trial.h"
#include "engine/span_list.h"
#include "temporal/coherence.h"

namespace pocketray {

// Decides what a frame may be built on, and what is kept of it for the next.
enum class FramePurpose : std::uint8_t {
  whole,         // all pixels, or whichever a source hands out; nothing is kept
  changes,       // all pixels, of which only those are traced that can differ from the last frame
  shared_rows,   // likewise, but other machines trace some of the rows; shared_rows.h
  shared_light,  // rows whose indirect light another machine renders, or that light; nothing is kept
};

// A frame as a caller asks for it.
struct FrameTask {
  double seconds = 0;
  FramePurpose purpose = FramePurpose::whole;
  SpanSource source;          // for render_frame(); without next(): frame_source()
  RowRange rows = {0, 0};     // FramePurpose::shared_rows: rows that this machine may trace; empty: all
  Hit* first_hits = nullptr;  // receives first hits, see KeptRays; allowed where nothing is kept
};

inline FrameTask changes_at(double seconds, const std::atomic<bool>* stop = nullptr) {
  FrameTask task = {seconds, FramePurpose::changes};
  task.source.stop = stop;
  return task;
}

// How the last frame of changes or shared rows was traced.
struct CoherenceState {
  bool planned = false;
  const char* unplanned_because = "coherence is off";
  const char* whole_because = nullptr;  // why all pixels were traced; null: only those that may have changed
  std::uint64_t pixels_traced = 0;
  ChangeCounts search;  // rays traced to find these
  double follow_ms = 0, find_ms = 0, keep_ms = 0;
  CoherenceTrial trial;  // for CoherenceMode::automatic
};

// The frame's own spans: all of them, or those that may have changed, some rows of tiles at a time.
struct FrameSpans {
  SpanList list;
  std::uint32_t tile_row = 0;  // the next to list
  bool all = true;
};

// The rows of a frame that this renderer may trace; shared_rows.h.
struct SharedRows {
  std::uint32_t begin = 0, end = 0;
  bool searched = false;            // the search for changes is complete
  std::uint32_t tile_row = 0;       // the next to search
  std::uint32_t known_rows = 0;     // of the last frame ...
  std::uint64_t known_changes = 0;  // ... and pixels to trace in these
  Span parts[2 * kThreadCountMax];  // parts of a row, or rows far apart
};

struct History {
  Coherence coherence;  // set up if planned
  CoherenceState state;
  FramePurpose purpose = FramePurpose::whole;  // of the frame in progress or, if none is, the last
  bool is_open = false;                        // a frame is in progress
  bool is_complete = false;                    // all of its pixels are traced
  bool records = false;                        // it is followed and can be kept
  FrameSpans spans;
  SharedRows rows;
  std::uint64_t prepare_ns = 0;  // by the pace's clock: posing, accelerating and lighting the frame,
  std::uint64_t spent_ns = 0;    // then following, tracing and keeping it
};

// Returns whether the pixels of the frame in progress are traced for the frame that will be kept.
inline bool is_followed(const History& history) {
  return history.is_open && (history.purpose == FramePurpose::changes || history.purpose == FramePurpose::shared_rows);
}

// Has the next frame traced whole.
inline void forget_last_frame(History* history) { forget_frame(&history->coherence); }

}  // namespace pocketray
