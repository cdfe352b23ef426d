// The governor chooses the front's candidate for the next frame, so that frames keep a time budget with the least
// error. Pure: the caller measures the times. Per frame: next_candidate(); render; observe_frame().
//
// A frame of candidate i is expected to take price_i × pixels × e^(load + correction_i). The load is common to all
// candidates: machine and view. It is estimated from the last frames; choices use the second highest load, so a single
// outlier is ignored, a lasting change is met at the second frame, and about 1 frame in 25 takes longer than assumed.
// The correction is the error of a candidate's price, learnt on switching to it. A candidate with an uncertain price is
// tried for one frame if it would be the better choice and may well fit.
#pragma once
#include "plan/front.h"

namespace pocketray {

constexpr std::uint32_t kLoadFrameCount = 64;  // derived: three of them are 4.7 %, just within the 5 % that may be late

struct Governor {
  Front front;
  double budget_ns = 0, pixel_count = 0;
  // All logarithms.
  double loads[kLoadFrameCount] = {};  // of the last frames, a ring
  double rises[kLoadFrameCount] = {};  // each load minus the median of those before it
  double late_share = 0.03;            // over about the last hundred frames; starts as if no more frames may be late
  std::uint32_t load_count = 0;        // frames seen; the ring holds the latest of them
  double load_sum = 0;                 // over all frames
  double corrections[kFrontCandidateMax] = {};
  double doubts[kFrontCandidateMax] = {};  // possible error of a price, either way
  bool ran[kFrontCandidateMax] = {};
  std::uint32_t switches_to[kFrontCandidateMax] = {};
  std::uint32_t current = 0;
  std::uint32_t frames_at_current = 0;           // since the last switch
  double reference_low = 0, reference_high = 0;  // loads before the switch
  bool on_trial = false;                         // the current candidate runs for one frame only
  std::uint32_t home = 0;                        // the candidate that trials return to
  std::uint32_t frames_to_trial = 0, trial_pause = 0;
  std::uint32_t switch_count = 0;
};

// `doubt`: possible factor between true and assumed relative prices: about 1.25 if measured on this machine, 4 if
// guessed. `load_known`: prices were measured on this machine and hold as they are. The front must not be empty.
void start_governor(const Front& front, double budget_ns, double pixel_count, double doubt, bool load_known,
                    Governor* governor);

// Sets the doubt of a single candidate, before its first frame.
void set_doubt(Governor* governor, std::uint32_t candidate, double doubt);

// Returns the index in governor->front of the candidate for the next frame.
std::uint32_t next_candidate(Governor* governor);
// Forces another candidate for the next frame.
void force_candidate(Governor* governor, std::uint32_t candidate);
// Reports that frame's duration, from preparation until its pixels are packed. Ignores NaN, zero and negative times.
void observe_frame(Governor* governor, double frame_ns);

// Expected duration of the candidate's frames, at the median of the last loads.
double expected_ns(const Governor& governor, std::uint32_t candidate);
// Returns whether even the fastest candidate is expected to exceed the budget.
bool budget_too_small(const Governor& governor);
// Learnt price of a pixel, at the mean load of all frames.
double learnt_price(const Governor& governor, std::uint32_t candidate);

}  // namespace pocketray
