// Spot checks: which of the pixels that servers sent the device renders again, and how likely that finds a server that
// sends wrong ones. Pure: random numbers are handed in. They are as good as their seed, which nobody else may know.
#pragma once
#include <cstdint>

#include "base/rng.h"
#include "split/split.h"

namespace pocketray {

constexpr std::uint32_t kSpotChecksMax = 1024;  // in a frame

// What a server sends in a frame and how much of it is looked at.
struct SpotCheck {
  std::uint32_t rows = 0, width = 0;  // that it sends, and pixels of each
  std::uint32_t wrong_rows = 0;       // of them
  double wrong_share = 1;             // of the pixels of such a row: wrong; at least one pixel of them all is
  std::uint32_t pixels = 0;           // checked: different ones, any as likely as any other
};

// The probability that at least one of the checked pixels is wrong. Of M pixels, w of them wrong, n different ones are
// all right with the probability of n draws without replacement: (M − w)/M · (M − w − 1)/(M − 1) · … (hypergeometric).
// Exact to rounding, also where it is tiny.
double catch_probability(const SpotCheck& check);
// The same over so many frames alike, with pixels chosen anew in each.
double catch_probability(const SpotCheck& check, std::uint32_t frames);
// Of two independent chances, that at least one comes true.
constexpr double either_probability(double a, double b) { return a + b * (1 - a); }

// Uniform in [0, n), for n > 0.
std::uint32_t random_below(Rng* random, std::uint32_t n);
// `count` different numbers in [0, n), any set as likely as any other; count ≤ n.
void draw_distinct(Rng* random, std::uint32_t n, std::uint32_t count, std::uint32_t* numbers);

// Shares `count` checks among servers that have sent so many pixels: one each first, the others by their pixels at
// random; where there are fewer checks than such servers, some at random get one. None gets more than it has pixels.
void allot_checks(Rng* random, std::uint32_t count, const std::uint32_t* pixels, std::uint32_t server_count,
                  std::uint32_t* counts);

// When checks fall due that may take a share of the time, where a frame may pay for less than one. One falls at a
// random moment of each interval that pays for one: never more than were paid for, but one, and no frame is safe.
struct CheckSchedule {
  double paid = 0, interval = 0, due = 0;  // in checks since the start
};
CheckSchedule make_check_schedule(Rng* random);
// Another frame has paid for `checks`: how many are due, at most kSpotChecksMax.
std::uint32_t due_checks(CheckSchedule* schedule, double checks, Rng* random);

}  // namespace pocketray
