// Which differences can be claimed against noisy references.
#include "desktop/accuracy/claim.h"

#include <doctest/doctest.h>

#include <cmath>

#include "base/rng.h"
#include "desktop/accuracy/display.h"
#include "desktop/accuracy/flip.h"

using namespace pocketray;

namespace {

constexpr std::uint32_t kSide = 40;
using Picture = std::vector<float>;

Picture smooth_picture() {
  Picture picture;
  for (std::uint32_t i = 0; i < kSide * kSide; ++i)
    for (int c = 0; c < 3; ++c)
      picture.push_back(0.5f +
                        0.2f * std::sin(0.13f * static_cast<float>(i % kSide + 7 * static_cast<std::uint32_t>(c))));
  return picture;
}

// The picture with noise of that size, or with every second pixel changed by it.
Picture noisy(Picture picture, float size, Rng* rng) {
  for (float& v : picture) v += size * static_cast<float>(next_double(rng) + next_double(rng) - 1);
  return picture;
}
Picture changed(Picture picture, float by) {
  for (std::size_t i = 0; i < picture.size(); i += 2) picture[i] += by;
  return picture;
}
Picture mean_picture(const Picture& a, const Picture& b) {
  Picture mean;
  for (std::size_t i = 0; i < a.size(); ++i) mean.push_back(0.5f * (a[i] + b[i]));
  return mean;
}

Distance distance_between(const Picture& test, const Picture& one, const Picture& other) {
  const auto flips = [&](const Picture& reference) { return flip_errors(reference, test, kSide, kSide, 23.6); };
  const std::vector<float> by_one = flips(one), by_other = flips(other);
  return {without_noise(mean_of(flips(mean_picture(one, other))), mean_of(by_one), mean_of(by_other)),
          block_means(by_one, kSide, kSide), block_means(by_other, kSide, kSide)};
}

}  // namespace

// Goal: blocks tile the picture and have the means of their pixels. Method: pictures whose sides blocks do and do not
// divide, and smaller ones; the mean weighted by the pixels of each block is that of the picture.
TEST_CASE("claim_blocks_are_means_of_their_pixels") {
  std::vector<float> errors(16 * 8);
  for (std::size_t i = 0; i < errors.size(); ++i) errors[i] = static_cast<float>(i % 16 / 2 + 8 * (i / 16));
  const std::vector<float> means = block_means(errors, 16, 8);
  REQUIRE(means.size() == 64);
  for (std::size_t i = 0; i < 64; ++i) CHECK(means[i] == static_cast<float>(i % 8 + 8 * (i / 8)));
  CHECK(block_means({0.25f, 0.5f}, 2, 1) == std::vector<float>{0.25f, 0.5f});
  CHECK(block_means(std::vector<float>(19 * 3, 0.5f), 19, 3) == std::vector<float>(8 * 3, 0.5f));
}

// Goal: the mean ꟻLIP without noise is that against a clean reference. Method: pictures that differ by more than the
// noise, against clean and noisy references; against the noisy mean it is off several times as far.
TEST_CASE("claim_leaves_out_the_noise_of_the_reference") {
  Rng rng = make_rng(3);
  const Picture truth = smooth_picture();
  for (float by : {0.03f, 0.05f}) {
    const Picture test = changed(truth, by);
    const double clean = mean_of(flip_errors(truth, test, kSide, kSide, 23.6));
    double without = 0, against = 0;
    for (int i = 0; i < 10; ++i) {
      const Picture one = noisy(truth, 0.06f, &rng), other = noisy(truth, 0.06f, &rng);
      without += 0.1 * distance_between(test, one, other).flip;
      against += 0.1 * mean_of(flip_errors(mean_picture(one, other), test, kSide, kSide, 23.6));
    }
    CAPTURE(clean);
    CAPTURE(without);
    CHECK(against - clean > 0.002);
    CHECK(std::fabs(without - clean) < 0.6 * (against - clean));
  }
  CHECK(without_noise(0.3, 0.31, 0.33) == doctest::Approx(0.28));
  CHECK(without_noise(0.3, 0.2, 0.2) == 0.3);
  CHECK(without_noise(0.1, 0.4, 0.4) == 0);
}

// Goal: the standard error of a difference is its spread over references, and far below the reference's own error.
// Method: two pictures against many references with noise of their own.
TEST_CASE("claim_knows_the_error_of_a_difference") {
  Rng rng = make_rng(5);
  const Picture truth = smooth_picture(), near = changed(truth, 0.10f), far = changed(truth, 0.11f);
  constexpr int kRuns = 60;
  double sum = 0, squares = 0, errors = 0, own = 0;
  int claims = 0;
  for (int i = 0; i < kRuns; ++i) {
    const Picture one = noisy(truth, 0.1f, &rng), other = noisy(truth, 0.1f, &rng);
    const Difference d = difference(distance_between(far, one, other), distance_between(near, one, other));
    sum += d.value, squares += d.value * d.value, errors += d.error;
    claims += d.value > 0 && is_claimed(d);
    own += mean_of(flip_errors(one, other, kSide, kSide, 23.6)) / kRuns;
  }
  const double spread = std::sqrt(squares / kRuns - sum / kRuns * (sum / kRuns));
  CAPTURE(spread);
  CAPTURE(errors / kRuns);
  CHECK(errors / kRuns > 0.5 * spread);
  CHECK(errors / kRuns < 2 * spread);
  CHECK(spread < 0.1 * own);
  CHECK(claims > kRuns / 2);  // ten times the reference's own error would claim none
  CHECK(!is_claimed(difference(distance_between(near, truth, truth), distance_between(near, truth, truth))));
}

// Goal: in order of cost, a point joins the front if it is claimed to be nearer than the last by a visible step.
// Method: random points with and without noise in their differences.
TEST_CASE("claim_front_is_what_nothing_beats") {
  Rng rng = make_rng(6);
  for (int round = 0; round < 50; ++round) {
    std::vector<double> cost;
    std::vector<Distance> distances(20);
    std::vector<const Distance*> pointers;
    for (Distance& d : distances) {
      cost.push_back(next_u32(&rng) % 8), d.flip = 0.1 * (1 + next_u32(&rng) % 8);
      pointers.push_back(&d);
    }
    const std::vector<bool> front = claimed_front(cost, pointers);
    for (std::size_t i = 0; i < cost.size(); ++i) {
      bool beaten = false;
      for (std::size_t j = 0; j < cost.size(); ++j) {
        const bool better = cost[j] < cost[i] || distances[j].flip < distances[i].flip || j < i;
        beaten = beaten || (j != i && cost[j] <= cost[i] && distances[j].flip <= distances[i].flip && better);
      }
      CHECK(front[i] == !beaten);
    }
  }
  Distance base = {0.5, {0.5f}, {0.5f}}, noisy_gain = {0.4, {0.5f}, {0.3f}}, clear_gain = {0.4, {0.41f}, {0.39f}},
           tiny_gain = {0.498, {0.498f}, {0.498f}};
  CHECK(claimed_front({1, 2}, {&base, &noisy_gain}) == std::vector<bool>{true, false});
  CHECK(claimed_front({1, 2}, {&base, &clear_gain}) == std::vector<bool>{true, true});
  CHECK(claimed_front({1, 2}, {&base, &tiny_gain}) == std::vector<bool>{true, false});
}
