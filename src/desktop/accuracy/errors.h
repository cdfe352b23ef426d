// Error metrics of a picture against a reference.
#pragma once
#include <cstddef>
#include <vector>

namespace pocketray {

// Over all channels of all pixels. `rmse` to `bias` have the unit of the values.
struct PictureErrors {
  double rmse = 0;     // √ mean of the squared differences
  double rel_mse = 0;  // mean of (difference / reference)², with kRelativeFloor added to the reference's square
  double p99 = 0;      // 99th percentile of the absolute differences
  double max = 0;      // largest absolute difference
  double bias = 0;     // mean difference: above 0 if the picture is too bright
  double psnr = 0;     // decibels, for values in which 1 is white; infinite for equal pictures
};

// Added to squares in the denominator of the relative error, which dark pixels would otherwise dominate [Rousselle et
// al. 2011, "Adaptive Sampling and Reconstruction using Greedy Error Minimization", sec. 5].
constexpr double kRelativeFloor = 0.01;

// Both have equal length, three values per pixel, at least one pixel.
PictureErrors picture_errors(const std::vector<double>& reference, const std::vector<double>& test);

// Estimates a reference's own error from two with independent seeds: the RMS of half their difference is the RMS error
// of their mean.
double reference_error(const std::vector<double>& one, const std::vector<double>& other);

// RMSE against the truth, from two noisy references with independent seeds, without the noise that they would add: √ of
// the mean of (test − one)(test − other), clamped at 0. All have equal length.
double unbiased_rmse(const std::vector<double>& one, const std::vector<double>& other, const std::vector<double>& test);

}  // namespace pocketray
