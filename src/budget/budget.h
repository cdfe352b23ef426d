// A time budget for frames: opens a scene with memory for its front, picks settings frame by frame and saves the
// measured prices.
#pragma once
#include <string>
#include <vector>

#include "plan/governor.h"
#include "plan/resolve.h"
#include "present/hud_text.h"
#include "session/front_file.h"
#include "session/open_scene.h"
#include "session/report.h"

namespace pocketray {

// Chosen: shorter than a frame of any picture, and 2.8 hours.
constexpr double kBudgetMsMin = 0.001, kBudgetMsMax = 1e7;

struct BudgetOptions {
  double ms = 0;        // per frame; 0: none given
  double flip_max = 0;  // maximum measured mean ꟻLIP of the settings; 0: any
  std::string front;    // a file; empty: the scene's front in the cache
};
// Returns whether a front provides the settings: the least error within the time, or the fastest within the error.
inline bool chooses_settings(const BudgetOptions& options) { return options.ms > 0 || options.flip_max > 0; }
inline void add_budget_uses(const BudgetOptions& o, Uses* uses) {
  uses->add(Use::budget, chooses_settings(o), o.ms > 0 ? "--budget-ms" : "--flip-max");
  uses->add(Use::front, !o.front.empty());
}

// The settings to choose from for an open scene.
struct OpenFront {
  Front front;
  Candidate best;           // the most accurate, before --flip-max excluded any
  Front measured;           // prices measured on this machine
  Front file;               // if is_whole: the whole contents of the file
  EffectMask effects = 0;   // effects that are on; candidates that differ only in others are equal here
  std::string scene, path;  // where prices are saved; empty: nowhere
  bool is_whole = false;    // the file holds the whole front, not only prices
  bool is_guess = false;    // nothing measured yet: prices are the ladder's
  bool is_priced = false;   // some prices come from `measured`
  std::vector<std::string> notes;
};
void print_notes(const OpenFront& front);  // one line each, on stderr

struct FrontSource {
  std::string file;            // empty: the cache
  bool may_be_new = false;     // the file need not exist yet
  double flip_max = 0;         // drops candidates with a larger error; 0: none
  bool fastest = false;        // keeps only the fastest
  bool shows_24_bits = false;  // judges pictures so; otherwise as a screen of 16 bits shows them
};
inline FrontSource front_source(const BudgetOptions& o, bool shows_24_bits) {
  return {o.front, false, o.flip_max, o.ms == 0, shows_24_bits};
}
// Opens the scene, ready for rendering, with memory for the most expensive candidate. Drops candidates that do not fit,
// with a note.
Status open_scene_with_front(const CommonOptions& common, const FrontSource& source,
                             const std::function<std::size_t(const Settings&)>& output_bytes, OpenScene* opened,
                             OpenFront* front);
// Returns the whole front with the prices of `priced`. Keeps every candidate, even those that this scene ignores or
// this memory cannot hold; prices missing in `priced` are scaled along with the others.
Front with_prices(const OpenFront& front, const Front& priced);
// Saves the measured prices: in the front's file if it holds the whole front, otherwise as this machine's prices.
Status keep_measured(const OpenFront& front, const Front& measured);

struct Budget {
  OpenFront front;
  Governor governor;
  double ms = 0, flip_max = 0;         // as in BudgetOptions
  bool pinned = false;                 // the user chose the candidate
  std::uint32_t previous = 0;          // previous candidate, for reporting what a change trades
  std::uint32_t frames = 0, late = 0;  // late: beyond 110 %
  std::uint32_t last = 0;              // candidate of the last frame
  std::uint32_t uses[kFrontCandidateMax] = {};
  std::vector<double> frame_ms;  // of the first frames, up to the reserved count
};

// Call once the scene is open. Records the times of the first `frame_count` frames.
void start_budget(const BudgetOptions& options, const OpenFront& front, const Renderer& renderer,
                  std::size_t frame_count, Budget* budget);
// Call before a frame: chooses settings and applies them to the renderer. Allocates nothing.
Status begin_budget_frame(Budget* budget, Renderer* renderer);
// Moves `steps` candidates along the front, positive meaning more accurate, and pins that candidate whatever its frame
// times; 0 returns the choice to the budget.
void move_along_front(Budget* budget, int steps);
// Call after a frame. `ns`: time from the frame's preparation until its pixels are packed.
void end_budget_frame(Budget* budget, std::uint64_t ns);
// Saves prices that were missing or wrong by more than a fifth; prints a note on stderr on failure.
void finish_budget(const Budget& budget);

// Writes the current settings and what they trade, for the overlay. Allocates nothing.
void write_budget_lines(const Budget& budget, HudText* text);
// Prints the settings chosen for most frames, or for the last one, what they trade against the most accurate, and the
// expected error.
void print_budget(const Budget& budget, bool last_alone);
Json budget_json(const Budget& budget);
std::string error_text(const Candidate& candidate);  // "0.0123", or "unknown"

}  // namespace pocketray
