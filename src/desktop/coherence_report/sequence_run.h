// A sequence rendered twice, frame by frame and coherently, with what the second way saved. Every frame is compared.
#pragma once
#include <vector>

#include "desktop/coherence_report/render_cost.h"
#include "session/progress.h"
#include "session/sequence.h"

namespace pocketray {

// Two renderers of one scene with equal settings, built, each in its own memory.
struct CoherencePair {
  Renderer* whole = nullptr;     // renders frame by frame
  Renderer* coherent = nullptr;  // planned with CoherenceMode::on
};

// Time of a coherent frame's steps; tracing and lighting take the rest.
struct CoherentSteps {
  double pose_ms = 0, refit_ms = 0, follow_ms = 0, find_ms = 0, keep_ms = 0;
};

struct FrameFigures {
  std::uint32_t frame = 0;
  RenderCost whole, coherent;
  CoherentSteps steps;
  std::uint64_t moving_rays = 0;  // search for changes, against the moving geometry alone; not in the cost's rays
  // Pixels that differ from the last frame: in any bit of radiance; in the bytes that an RGB888 screen shows. The first
  // frame differs everywhere.
  std::uint64_t changed = 0, shown = 0;
  std::uint64_t retraced = 0;
  const char* whole_because = nullptr;  // null: only what may have changed was traced
};

// Levels of a frame's retraced pixels, the others black [Jevans92, fig. 4].
struct RetracedPicture {
  std::uint32_t frame = 0;
  std::vector<std::uint8_t> rgb;
};

struct SequenceRun {
  FrameRange range;
  std::vector<FrameFigures> frames;       // finished ones
  std::vector<RetracedPicture> pictures;  // of those frames
  std::uint32_t width = 0, height = 0;
  std::size_t table_bytes = 0, coherence_bytes = 0;  // the voxels' tables; everything that coherence keeps
};

// Frames of the paper's table and of its figure.
constexpr std::uint32_t kTableFrames[] = {0, 1, 75, 150, 200, 350};
constexpr std::uint32_t kFigureFrames[] = {0, 1, 15, 35, 40, 75, 150, 200, 350};

// Number of renderings, for progress.
constexpr std::uint64_t rendering_count(const FrameRange& range) {
  return 2 * (std::uint64_t(range.last) - range.first + 1);
}

// Renders the range with memory sealed. If settings.coherence_by_tables, the frame-by-frame renderer also traces ray by
// ray. Keeps finished frames after an interrupt. Fails at the first pixel that differs. `done`: renderings before.
Status run_sequence(const CoherencePair& pair, const FrameRange& range, Progress* progress, std::uint64_t done,
                    SequenceRun* run);

// Sums over frames [begin, end) of the run.
FrameFigures sum_of(const SequenceRun& run, std::size_t begin, std::size_t end);
inline FrameFigures entire(const SequenceRun& run) { return sum_of(run, 0, run.frames.size()); }

// Returns part / whole; NaN if whole is 0.
double ratio_of(double part, double whole);

}  // namespace pocketray
