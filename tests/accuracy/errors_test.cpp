// Errors of pictures.
#include "desktop/accuracy/errors.h"

#include <doctest/doctest.h>

#include <cmath>

#include "base/rng.h"

using namespace pocketray;

namespace {

bool near(double a, double b) { return std::fabs(a - b) <= 1e-12 * std::fabs(b); }

}  // namespace

// Goal: each metric meets its definition. Method: a hundred values, one off by 2 and another by -1; the percentile is
// by rank.
TEST_CASE("errors_meet_their_definitions") {
  std::vector<double> reference(100, 0.5), test = reference;
  test[17] = 2.5, test[60] = -0.5;
  PictureErrors e = picture_errors(reference, test);
  CHECK(near(e.rmse, std::sqrt(5.0 / 100)));
  CHECK(near(e.rel_mse, 5.0 / 100 / (0.25 + kRelativeFloor)));
  CHECK(near(e.bias, 0.01));
  CHECK(e.max == 2);
  CHECK(e.p99 == 1);
  CHECK(near(e.psnr, -10 * std::log10(0.05)));
  PictureErrors none = picture_errors(reference, reference);
  CHECK(none.rmse == 0);
  CHECK(none.max == 0);
  CHECK(std::isinf(none.psnr));
  CHECK(picture_errors({0}, {0.25}).p99 == 0.25);
}

// Goal: two noisy references tell how far their mean is from the truth. Method: Gaussian-like noise of known size about
// known values.
TEST_CASE("errors_of_a_reference_are_those_of_its_mean") {
  Rng rng = make_rng(2);
  std::vector<double> truth(30000, 0.7), one = truth, other = truth, mean = truth;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    auto noise = [&] { return 0.1 * (next_double(&rng) + next_double(&rng) + next_double(&rng) - 1.5); };
    one[i] += noise(), other[i] += noise();
    mean[i] = 0.5 * (one[i] + other[i]);
  }
  double told = reference_error(one, other), found = picture_errors(truth, mean).rmse;
  CHECK(std::fabs(told / found - 1) < 0.03);
}
