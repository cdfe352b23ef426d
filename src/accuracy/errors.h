// How far a picture is from a reference, in numbers.
#pragma once
#include <cstddef>
#include <vector>

namespace pocketray {

// Of the channels of all pixels. `rmse` to `bias` in the unit of the values.
struct PictureErrors {
  double rmse = 0;     // √ mean of the squared differences
  double rel_mse = 0;  // mean of (difference / reference)², the square of the reference raised by kRelativeFloor
  double p99 = 0;      // 99th percentile of the absolute differences
  double max = 0;      // largest absolute difference
  double bias = 0;     // mean difference: above 0 where the picture is too bright
  double psnr = 0;     // decibels, for values of which 1 is white; infinite for equal pictures
};

// Added to squares in the denominator of the relative error, which would otherwise be all of dark pixels
// [Rousselle et al. 2011, "Adaptive Sampling and Reconstruction using Greedy Error Minimization", sec. 5].
constexpr double kRelativeFloor = 0.01;

// Both of the same length, three values a pixel, at least one.
PictureErrors picture_errors(const std::vector<double>& reference, const std::vector<double>& test);

// What a reference of one seed may itself err by, from two of independent seeds: the root mean square of half their
// difference is that of their mean.
double reference_error(const std::vector<double>& one, const std::vector<double>& other);

// √ mean of the squared differences to the truth that two noisy references of independent seeds tell of, without what
// their noise adds: the mean of (test − one)(test − other), not below 0. All of the same length.
double unbiased_rmse(const std::vector<double>& one, const std::vector<double>& other, const std::vector<double>& test);

}  // namespace pocketray
