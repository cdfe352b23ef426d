#include "desktop/accuracy/errors.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/check.h"

namespace pocketray {

PictureErrors picture_errors(const std::vector<double>& reference, const std::vector<double>& test) {
  CHECK_EQ(reference.size(), test.size());
  CHECK_GT(reference.size(), 0u);
  PictureErrors errors;
  std::vector<double> size(reference.size());
  double squares = 0, relative = 0, sum = 0, count = static_cast<double>(reference.size());
  for (std::size_t i = 0; i < reference.size(); ++i) {
    double difference = test[i] - reference[i];
    sum += difference;
    squares += difference * difference;
    relative += difference * difference / (reference[i] * reference[i] + kRelativeFloor);
    size[i] = std::fabs(difference);
  }
  // Smallest value that at least 99 % do not exceed.
  std::size_t rank = static_cast<std::size_t>(std::ceil(0.99 * count)) - 1;
  std::nth_element(size.begin(), size.begin() + static_cast<std::ptrdiff_t>(rank), size.end());
  errors.p99 = size[rank];
  errors.max = *std::max_element(size.begin(), size.end());
  errors.rmse = std::sqrt(squares / count);
  errors.rel_mse = relative / count;
  errors.bias = sum / count;
  errors.psnr = errors.rmse > 0 ? -20 * std::log10(errors.rmse) : std::numeric_limits<double>::infinity();
  return errors;
}

double reference_error(const std::vector<double>& one, const std::vector<double>& other) {
  return 0.5 * picture_errors(one, other).rmse;
}

double unbiased_rmse(const std::vector<double>& one, const std::vector<double>& other,
                     const std::vector<double>& test) {
  CHECK_EQ(one.size(), test.size());
  CHECK_EQ(other.size(), test.size());
  CHECK_GT(test.size(), 0u);
  double products = 0;
  for (std::size_t i = 0; i < test.size(); ++i) products += (test[i] - one[i]) * (test[i] - other[i]);
  return products > 0 ? std::sqrt(products / static_cast<double>(test.size())) : 0;
}

}  // namespace pocketray
