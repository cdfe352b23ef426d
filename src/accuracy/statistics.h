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

// Slope of log y over log x by least squares, with the interval that Student's distribution gives it. At least three
// points, all above 0; where all have the same x the interval is everything.
Interval log_log_slope(const std::vector<double>& x, const std::vector<double>& y);

// Which points no other beats in both numbers: true for each that has less cost than all of equal or less error, and
// less error than all of equal or less cost. Of equal points the first. Errors closer than `resolution` count as equal:
// going up in cost, a point joins only with an error less by more than that than of all that have joined.
std::vector<bool> pareto_front(const std::vector<double>& cost, const std::vector<double>& error,
                               double resolution = 0);

}  // namespace pocketray
