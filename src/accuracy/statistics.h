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

// The median of a distribution from independent values of it, at least one. The interval holds it in 95 of 100 cases,
// however the values are distributed: order statistics, interpolated [Hettmansperger & Sheather 1986, "Confidence
// intervals based on interpolated order statistics", Statistics & Probability Letters 4]. Of fewer than six values it
// is their range, which holds it less often: 1 - 2^(1 - count).
Interval median_interval(const std::vector<double>& values);

// The law e² = floor² + (c tˢ)², s < 0, that comes closest to errors at several times: least squares of the relative
// differences of e², floor² and c² not below 0. What does not depend on the time is so taken away without taking any
// one point for the floor. At least four points of time above 0. Errors below `resolution` count as much as those at
// it.
struct PowerLaw {
  double exponent;  // s; -∞ or 0 where it is steeper or flatter than can be told
  double misfit;    // root mean square of the relative differences between e and the law
};
PowerLaw fit_power_law(const std::vector<double>& time, const std::vector<double>& error, double resolution);

// Which points no other beats in both numbers: true for each that has less cost than all of equal or less error, and
// less error than all of equal or less cost. Of equal points the first. Errors closer than `resolution` count as equal:
// going up in cost, a point joins only with an error less by more than that than of all that have joined.
std::vector<bool> pareto_front(const std::vector<double>& cost, const std::vector<double>& error,
                               double resolution = 0);

}  // namespace pocketray
