// Statistics of measurements, with confidence intervals.
#pragma once
#include <cstdint>
#include <vector>

namespace pocketray {

// A number with its 95 % confidence interval.
struct Interval {
  double value = 0, low = 0, high = 0;
};

// Median of at least one value; for an even count, the mean of the middle two.
double median(std::vector<double> values);

// Median of a distribution from at least one independent value, with a 95 % interval for any distribution: interpolated
// order statistics [Hettmansperger & Sheather 1986, "Confidence intervals based on interpolated order statistics",
// Statistics & Probability Letters 4]. With fewer than six values the interval is their range, whose coverage is 1 -
// 2^(1 - count).
Interval median_interval(const std::vector<double>& values);

// The law e² = floor² + (c tˢ)², s < 0, fitted to errors at several times by least squares of the
// relative differences of e², with floor² and c² at least 0. This separates the time-independent part
// without taking any single point as the floor. Needs at least four points with times above 0. Errors
// below `resolution` weigh as much as those at it.
struct PowerLaw {
  double exponent;  // s; -∞ or 0 if steeper or flatter than can be determined
  double misfit;    // root mean square of the relative differences between e and the law
};
PowerLaw fit_power_law(const std::vector<double>& time, const std::vector<double>& error, double resolution);

}  // namespace pocketray
