// Quick scans of arrays, against loops over single elements.
#include "base/scan.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <vector>

#include "base/rng.h"

using namespace pocketray;

namespace {

std::vector<std::uint32_t> random_words(std::size_t count, Rng* rng) {
  std::vector<std::uint32_t> words(count);
  for (std::uint32_t& word : words) word = next_u32(rng) >> next_u32(rng) % 32;
  return words;
}

std::vector<Vec3> random_points(std::size_t count, Rng* rng) {
  std::vector<Vec3> points(count);
  for (Vec3& p : points)
    for (int axis = 0; axis < 3; ++axis) {
      const std::uint32_t bits = next_u32(rng) % 7 == 0 ? (next_u32(rng) & 1) << 31 : next_u32(rng) & 0xBFFFFFFFu;
      std::memcpy(&p[axis], &bits, sizeof bits);  // of any exponent below 2, also denormal, or ±0
    }
  return points;
}
Array<const Vec3> view(const std::vector<Vec3>& points) {
  return {points.data(), static_cast<std::uint32_t>(points.size())};
}

}  // namespace

// Goal: the largest word is found wherever it is. Method: all counts up to a few rows, two masks, and each word of a
// long array in turn.
TEST_CASE("scan_finds_the_largest_word") {
  Rng rng = make_rng(501);
  for (std::size_t count = 0; count < 40; ++count)
    for (std::int32_t mask : {0x7FFFFFFF, 0x3FFFFFF}) {
      const std::vector<std::uint32_t> words = random_words(count, &rng);
      std::int32_t expected = 0;
      for (std::uint32_t word : words) expected = std::max(expected, static_cast<std::int32_t>(word) & mask);
      CHECK(largest_word(words.data(), count, mask) == expected);
    }
  for (std::size_t i = 0; i < 60; ++i) {
    std::vector<std::uint32_t> words(60, 5 | 1u << 31);
    words[i] = 7;
    CHECK(largest_word(words.data(), words.size(), 0x7FFFFFFF) == 7);
  }
}

// Goal: each remainder by three has its own maximum. Method: as above.
TEST_CASE("scan_finds_the_largest_of_three") {
  Rng rng = make_rng(502);
  for (std::size_t count = 0; count < 20; ++count)
    for (int shift : {1, 26, 31}) {
      const std::vector<std::uint32_t> words = random_words(3 * count, &rng);
      std::int32_t expected[3] = {0, 0, 0};
      for (std::size_t i = 0; i < words.size(); ++i)
        expected[i % 3] = std::max(expected[i % 3], static_cast<std::int32_t>(words[i] >> shift));
      const LargestOfThree largest = largest_of_three(words.data(), count, shift);
      for (int k = 0; k < 3; ++k) CHECK(largest.of[k] == expected[k]);
    }
}

// Goal: a word is found wherever it is, and no other. Method: every place of arrays of several lengths.
TEST_CASE("scan_finds_a_word") {
  for (std::size_t count : {0, 1, 3, 4, 11, 12, 13, 47, 48, 49, 100})
    for (std::size_t i = 0; i <= count; ++i) {
      std::vector<std::uint32_t> words(count, 0x80000003u);
      if (i < count) words[i] = 0xFC000002u;
      CHECK(has_word(words.data(), count, 0x3FFFFFF, 2) == (i < count));
      CHECK(has_word(words.data(), count, 0x3FFFFFF, 3) == (count > (i < count ? 1u : 0u)));
      CHECK(!has_word(words.data(), count, 0x3FFFFFF, 0));
    }
}

// Goal: the first change is found, wherever it is. Method: every place, every word of the triple, also from behind it.
TEST_CASE("scan_finds_the_next_change") {
  const std::uint32_t count = 70;
  for (std::uint32_t at = 1; at < count; ++at)
    for (std::uint32_t k = 0; k < 3; ++k) {
      std::vector<std::uint32_t> words(3 * count, 1);
      for (std::uint32_t i = at; i < count; ++i) words[3 * i + k] |= 1u << 31;
      CHECK(find_change(words.data(), 1, count, 1u << 31) == at);
      CHECK(find_change(words.data(), 1, count, 1u) == count);
      CHECK(find_change(words.data(), at, count, 1u << 31) == at);
      CHECK(find_change(words.data(), at + 1, count, 1u << 31) == count);
    }
}

// Goal: bounds and the smallest magnitude are those of a loop over points, with denormals and zeros of either sign.
TEST_CASE("scan_bounds_points") {
  Rng rng = make_rng(503);
  CHECK(is_empty(bounds_of({})));
  CHECK(least_magnitude({}) == std::numeric_limits<float>::infinity());
  for (std::size_t count = 1; count < 300; count += count < 40 ? 1 : 37) {
    CAPTURE(count);
    const std::vector<Vec3> points = random_points(count, &rng);
    Box expected = empty_box();
    float least = std::numeric_limits<float>::infinity();
    for (const Vec3& p : points) {
      expected = merge(expected, p);
      for (int axis = 0; axis < 3; ++axis)
        if (p[axis] != 0) least = std::min(least, std::fabs(p[axis]));
    }
    const Box box = bounds_of(view(points));
    CHECK(box.low == expected.low);
    CHECK(box.high == expected.high);
    CHECK(least_magnitude(view(points)) == least);
  }
}

// Goal: without an FPU, no vector outside is taken for one inside, and few inside are left undecided.
TEST_CASE("scan_decides_squares_in_fixed_point") {
  Rng rng = make_rng(504);
  const SquareRange range = range_within(0.98f, 1.02f);
  int decided = 0;
  for (int i = 0; i < 100000; ++i) {
    auto coordinate = [&] { return 2 * next_float(&rng) - 1; };
    const float x = coordinate(), y = coordinate();
    const Vec3 v = Vec3{x, y, coordinate()}, unit = normalize(v) * (0.97f + 0.06f * next_float(&rng));
    const float square = dot(unit, unit);
    const bool inside = is_surely_inside(unit, range);
    if (inside && !(square >= 0.98f && square <= 1.02f)) FAIL_CHECK("square ", static_cast<double>(square));
    decided += inside;
  }
  CHECK(decided > 25000);
  CHECK(is_surely_inside({0, 0, 1}, range));
  const float nan = std::nanf(""), inf = std::numeric_limits<float>::infinity();
  for (const Vec3& bad : {Vec3{nan, 0, 1}, Vec3{0, inf, 0}, Vec3{0, 0, 1.2f}, Vec3{0, 0, 0}, Vec3{1e30f, 0, 0}})
    CHECK(!is_surely_inside(bad, range));
}

// Goal: no vector outside is passed over. Method: a long, a short, a NaN and an infinite one at every place.
TEST_CASE("scan_finds_squares_outside") {
  const std::uint32_t count = 23;
  const float inf = std::numeric_limits<float>::infinity();
  for (std::uint32_t at = 0; at < count; ++at)
    for (const Vec3& bad :
         {Vec3{1, 0.2f, 0}, Vec3{0.9f, 0, 0}, Vec3{std::nanf(""), 0, 1}, Vec3{0, inf, 0}, Vec3{0, 0, 0}}) {
      std::vector<Vec3> vectors(count, Vec3{0.6f, 0, -0.8f});
      CHECK(find_square_outside(view(vectors), 0, 0.98f, 1.02f) == count / 4 * 4);
      vectors[at] = bad;
      CHECK(find_square_outside(view(vectors), 0, 0.98f, 1.02f) == at / 4 * 4);
      CHECK(find_square_outside(view(vectors), at, 0.98f, 1.02f) == at);
      CHECK(find_square_outside(view(vectors), at + 1, 0.98f, 1.02f) == at + 1 + (count - at - 1) / 4 * 4);
    }
}
