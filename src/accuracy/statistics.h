// What measurements say, and how surely.
#pragma once
#include <cstdint>
#include <vector>

namespace pocketray {

// A number and the interval that holds it in 95 of 100 cases.
struct Interval {
  double value = 0, low = 0, high = 0;
};

// Of at least one value; of an even number of them the mean of the middle two.
double median(std::vector<double> values);

// How many times as long as a baseline something took: the median of the ratios of runs of one round, which have the
// machine's moods in common, and its percentile bootstrap interval [Efron & Tibshirani 1993, An
// Introduction to the Bootstrap, ch. 13]. As many times as baselines, at least one, all above 0.
Interval median_ratio(const std::vector<double>& times, const std::vector<double>& baselines, std::uint64_t seed);

// The exponent s of a law e² = floor² + (c tˢ)², s < 0, from errors at several times: what an error does on logarithmic
// scales once what does not depend on the time is taken away. The last point has the most time; the others, at least
// three, all above 0 and with a larger error, are compared with it, so that the floor need not be known:
// e² − e_last² = c² (t²ˢ − t_last²ˢ). Least squares of the logarithms, weighted by what errors of equal relative size
// do to them; the interval is that of the profile [Seber & Wild 1989, Nonlinear Regression, sec. 5.4]. An end that the
// points do not tell of is infinite or 0.
Interval slope_to_limit(const std::vector<double>& time, const std::vector<double>& error);

// Which points no other beats in both numbers: true for each that has less cost than all of equal or less error, and
// less error than all of equal or less cost. Of equal points the first. Errors closer than `resolution` count as equal:
// going up in cost, a point joins only with an error less by more than that than of all that have joined.
std::vector<bool> pareto_front(const std::vector<double>& cost, const std::vector<double>& error,
                               double resolution = 0);

}  // namespace pocketray
