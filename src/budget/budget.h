// A time budget for frames: opens a scene with all that its front may ask for, picks settings frame by frame, and keeps
// what was learnt of prices.
#pragma once
#include <string>
#include <vector>

#include "budget/front_file.h"
#include "plan/governor.h"
#include "present/hud_text.h"
#include "session/open_scene.h"
#include "session/report.h"

namespace pocketray {

constexpr double kBudgetMsMin = 0.001, kBudgetMsMax = 1e7;

struct BudgetOptions {
  double ms = 0;      // a frame; 0: no budget
  std::string front;  // a file; empty: the scene's in the cache
};

// What there is to choose from for a scene that is open.
struct OpenFront {
  Front front;
  Front measured;           // of these the prices that were measured on this machine
  Front file;               // where is_whole: what is to stand in the file, all of it
  EffectMask effects = 0;   // that are on: two candidates of the file may be one to the scene
  std::string scene, path;  // where prices are kept; empty: nowhere
  bool is_whole = false;    // the file is the front itself, not prices alone
  bool is_guess = false;    // nothing was ever measured: prices are those of the ladder
  bool is_priced = false;   // by `measured`, at least in part
  std::vector<std::string> notes;
};
void print_notes(const OpenFront& front);  // one line each, on stderr

struct FrontSource {
  std::string file;         // empty: the cache
  bool may_be_new = false;  // the file need not be there yet
};
// Opens the scene, ready for rendering, with memory for the dearest candidate; those that do not fit are left out, with
// a note.
Status open_scene_with_front(const CommonOptions& common, const FrontSource& source,
                             const std::function<std::size_t(const Settings&)>& output_bytes, OpenScene* opened,
                             OpenFront* front);
// The file of a front that is whole with other prices; it keeps all its candidates, whatever this scene ignores and
// this memory holds. What `priced` lacks follows the others.
Front with_prices(const OpenFront& front, const Front& priced);
// Keeps what was measured: in the front's file with what was not, or as the prices of this machine.
Status keep_measured(const OpenFront& front, const Front& measured);

struct Budget {
  OpenFront front;
  Governor governor;
  double ms = 0;
  bool pinned = false;                 // the candidate was chosen by hand
  std::uint32_t previous = 0;          // candidate, to say what a change gave up
  std::uint32_t frames = 0, late = 0;  // late: beyond 110 %
  std::uint32_t last = 0;              // candidate of the last frame
  std::uint32_t uses[kFrontCandidateMax] = {};
  std::vector<double> frame_ms;  // of the first ones, as many as there was room for
};

// With the scene open. `frame_count`: frames whose times are to be kept.
void start_budget(const BudgetOptions& options, const OpenFront& front, const Renderer& renderer,
                  std::size_t frame_count, Budget* budget);
// Before a frame: chooses, and changes the renderer's settings. Allocates nothing.
Status begin_budget_frame(Budget* budget, Renderer* renderer);
// Goes so many candidates along the front, up being more accurate, and stays there, whatever frames take; 0 leaves the
// choice to the budget again.
void move_along_front(Budget* budget, int steps);
// After it: `ns` from the frame's preparation until its pixels are packed.
void end_budget_frame(Budget* budget, std::uint64_t ns);
// Afterwards: keeps prices that were wrong by more than a fifth, or of which there were none. Fails where a file was
// named for them; a cache that cannot be written to is worth a line on standard error.
Status finish_budget(const Budget& budget);

// What the present settings are, what they gave up and gained, for a display over the picture. Allocates nothing.
void write_budget_lines(const Budget& budget, HudText* text);
// Lines for people: what was chosen, for most frames or for the last one alone, what it gave up against the most
// accurate, the error to expect.
void print_budget(const Budget& budget, bool last_alone);
Json budget_json(const Budget& budget);
std::string error_text(const Candidate& candidate);  // "0.0123", or "unknown"

}  // namespace pocketray
