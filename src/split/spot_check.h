// Spot checks: which servers' pixels the device renders again, and how likely this is to catch a server that sends
// wrong ones. Pure: the caller passes the random numbers, which are only as good as their secret seed.
#pragma once
#include <cstdint>

#include "base/rng.h"
#include "split/split.h"

namespace pocketray {

// Per frame. Chosen: finds one wrong row of 216 in a single frame with 99 %, so more would only take memory and time.
constexpr std::uint32_t kSpotChecksMax = 1024;

// A server's pixels in a frame, and how many of them are checked.
struct SpotCheck {
  std::uint32_t rows = 0, width = 0;  // rows that it sends, pixels per row
  std::uint32_t wrong_rows = 0;       // number of these that are wrong
  double wrong_share = 1;             // fraction of wrong pixels in such a row; at least one pixel in total is wrong
  std::uint32_t pixels = 0;           // number checked: distinct, all equally likely
};

// Probability that at least one of the checked pixels is wrong. With w of M pixels wrong, n distinct ones are all right
// with the probability of n draws without replacement: (M − w)/M · (M − w − 1)/(M − 1) · … (hypergeometric). Exact to
// rounding, even if tiny.
double catch_probability(const SpotCheck& check);
// Probability over `frames` equal frames, with new pixels chosen in each.
double catch_probability(const SpotCheck& check, std::uint32_t frames);
// Probability that at least one of two independent events happens.
constexpr double either_probability(double a, double b) { return a + b * (1 - a); }

// Uniform in [0, n), for n > 0.
std::uint32_t random_below(Rng* random, std::uint32_t n);
// `count` distinct numbers in [0, n), all sets equally likely; count ≤ n.
void draw_distinct(Rng* random, std::uint32_t n, std::uint32_t count, std::uint32_t* numbers);

// Distributes `count` checks among servers that have sent these numbers of pixels: one each first, the rest at random
// in proportion to the pixels; with fewer checks than such servers, random ones get one. None gets more checks than it
// has pixels.
void allot_checks(Rng* random, std::uint32_t count, const std::uint32_t* pixels, std::uint32_t server_count,
                  std::uint32_t* counts);

// Decides when checks are due if a frame's share of time pays for less than one. One check falls at a random moment of
// each interval that pays for one: there is never more than one unpaid check, and no frame is safe.
struct CheckSchedule {
  double paid = 0, interval = 0, due = 0;  // number of checks since the start
};
CheckSchedule make_check_schedule(Rng* random);
// Adds a frame's payment for `checks`; returns how many are due, at most kSpotChecksMax.
std::uint32_t due_checks(CheckSchedule* schedule, double checks, Rng* random);

}  // namespace pocketray
