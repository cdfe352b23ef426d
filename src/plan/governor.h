// Governor: which candidate of a front to render the next frame with, so that frames keep a time budget with the least
// error. Pure: times are handed in. A frame: next_candidate(); render; observe_frame().
//
// A frame of candidate i is taken to last price_i × pixels × e^(load + correction_i). The load is what all candidates
// share: the machine, the view. It is known by the last frames; a candidate is chosen by their second highest, so that
// a lone outlier is ignored, a lasting change is met at the second frame, and about 1 frame in 25 takes longer than
// assumed. The correction is what a candidate's price was wrong by, learnt at the switch to it. One whose price is not
// sure is tried for a frame when it would be the better choice and may well fit.
#pragma once
#include "plan/front.h"

namespace pocketray {

constexpr std::uint32_t kLoadFrameCount = 64;

struct Governor {
  Front front;
  double budget_ns = 0, pixel_count = 0;
  // Logarithms throughout.
  double loads[kLoadFrameCount] = {};  // of the last frames, a ring
  double rises[kLoadFrameCount] = {};  // of each over the middle of those before it
  double late_share = 0.03;            // of the last hundred frames or so
  std::uint32_t load_count = 0;        // frames seen; the ring holds the last of them
  double load_sum = 0;                 // of all frames
  double corrections[kFrontCandidateMax] = {};
  double doubts[kFrontCandidateMax] = {};  // how far a price may be off, either way
  bool ran[kFrontCandidateMax] = {};
  std::uint32_t switches_to[kFrontCandidateMax] = {};
  std::uint32_t current = 0;
  std::uint32_t frames_at_current = 0;           // since the switch to it
  double reference_low = 0, reference_high = 0;  // loads before the switch
  bool on_trial = false;                         // the current one, for a frame
  std::uint32_t home = 0;                        // what is at work but for trials
  std::uint32_t frames_to_trial = 0, trial_pause = 0;
  std::uint32_t switch_count = 0;
};

// `doubt`: the factor that prices may be wrong by against each other: about 1.25 where they were measured on this
// machine, 4 where they are a guess. `load_known`: they are this machine's, as they stand. The front must not be empty.
void start_governor(const Front& front, double budget_ns, double pixel_count, double doubt, bool load_known,
                    Governor* governor);

// The same for a single candidate, before its first frame.
void set_doubt(Governor* governor, std::uint32_t candidate, double doubt);

// The candidate of governor->front for the next frame.
std::uint32_t next_candidate(Governor* governor);
// Takes another instead, for the next frame.
void force_candidate(Governor* governor, std::uint32_t candidate);
// What that frame took, from its preparation until its pixels are packed. What is no time (NaN, zero, negative) is
// ignored.
void observe_frame(Governor* governor, double frame_ns);

// What a frame of the candidate is expected to take, by the middle of the last loads.
double expected_ns(const Governor& governor, std::uint32_t candidate);
// Whether even the fastest candidate is expected not to keep the budget.
bool budget_too_small(const Governor& governor);
// A pixel's price by what was learnt, at the mean load of all frames.
double learnt_price(const Governor& governor, std::uint32_t candidate);

}  // namespace pocketray
