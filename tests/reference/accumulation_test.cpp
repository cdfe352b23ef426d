// References in the making: exact sums, sets of samples, merging, files.
#include <algorithm>
#include <cstring>

#include "desktop/reference/accumulation.h"
#include "reference_helpers.h"
#include "scene/content_hash.h"

using namespace pocketray;

namespace {

// A floor under an area light.
struct LitFloor : GeneratedScene {
  LitFloor() {
    add_camera(this);
    std::uint32_t floor = add_material(this, white()), light = add_material(this, emitter(5));
    add_quad(this, {-1, 0, 1}, {1, 0, 1}, {1, 0, -1}, {-1, 0, -1}, floor);
    add_quad(this, {-0.3f, 1, -0.3f}, {0.3f, 1, -0.3f}, {0.3f, 1, 0.3f}, {-0.3f, 1, 0.3f}, light);
    bind();
  }
};

Accumulation empty(const std::string& key = "key") { return empty_accumulation(key, 8, 8); }

void take(const TestReference& t, SampleRange samples, Accumulation* a) {
  for (std::uint32_t row = 0; row < a->height; ++row) accumulate(t.reference, Transport::physical, row, samples, a);
}

bool same(const Accumulation& a, const Accumulation& b) { return encode_accumulation(a) == encode_accumulation(b); }

}  // namespace

// Goal: sums do not depend on the order, and are right. Method: terms of many magnitudes and signs, forwards and
// backwards; values at the limits.
TEST_CASE("exact_sums_ignore_the_order") {
  Rng rng = make_rng(3);
  std::vector<double> terms;
  for (int i = 0; i < 4000; ++i) terms.push_back((next_double(&rng) - 0.4) * std::ldexp(1, i % 60 - 30));
  ExactSum forwards, backwards;
  double plain = 0;
  for (double t : terms) add(exact_term(t), &forwards), plain += t;
  std::reverse(terms.begin(), terms.end());
  for (double t : terms) add(exact_term(t), &backwards);
  CHECK(forwards.low == backwards.low);
  CHECK(forwards.high == backwards.high);
  CHECK(value_of(forwards) == doctest::Approx(plain).epsilon(1e-12));
  for (double v : {0.0, 1.0, -1.0, 0x1p-64, -0x1p-64, 3.75, 1e9, -1e9}) CHECK(value_of(exact_term(v)) == v);
  CHECK(value_of(exact_term(NAN)) == 0);
  CHECK(value_of(exact_term(1e300)) == 0x1p38);
  CHECK(value_of(exact_term(-INFINITY)) == -0x1p38);
  ExactSum full;
  for (int i = 0; i < 1 << 12; ++i) add(exact_term(1e300), &full);
  CHECK(value_of(full) == 0x1p50);
}

// Goal: sets of samples. Method: ranges in random order against flags.
TEST_CASE("sample_sets_hold_what_was_added") {
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    CAPTURE(seed);
    Rng rng = make_rng(seed);
    SampleSet set;
    std::vector<bool> there(64, false);
    for (int i = 0; i < 20; ++i) {
      std::uint32_t begin = next_u32(&rng) % 64, end = std::min(64u, begin + 1 + next_u32(&rng) % 12);
      for (const SampleRange& r : missing_samples(set, {begin, end})) add_samples(r, &set);
      std::fill(there.begin() + begin, there.begin() + end, true);
      std::vector<bool> held(64, false);
      for (std::size_t k = 0; k < set.size(); ++k) {
        CHECK(set[k].begin < set[k].end);
        if (k > 0) CHECK(set[k - 1].end < set[k].begin);
        std::fill(held.begin() + set[k].begin, held.begin() + set[k].end, true);
      }
      CHECK(held == there);
      CHECK(sample_count(set) == static_cast<std::uint64_t>(std::count(there.begin(), there.end(), true)));
    }
  }
}

// Goal: a reference is the same, bit for bit, whichever runs took its samples. Method: one run, against two runs with
// alternating batches of unequal size, one of them stopped within the picture, merged in either order.
TEST_CASE("accumulations_of_several_runs_equal_one") {
  LitFloor s;
  TestReference t(s.scene);
  Accumulation one = empty(), a = empty(), b = empty();
  take(t, {0, 12}, &one);
  take(t, {0, 4}, &a), take(t, {9, 12}, &a);
  take(t, {4, 5}, &b);
  for (std::uint32_t row = 0; row < 3; ++row) accumulate(t.reference, Transport::physical, row, {5, 9}, &b);
  Accumulation resumed;
  std::vector<std::uint8_t> file = encode_accumulation(b);
  REQUIRE(decode_accumulation(file.data(), file.size(), &resumed).ok);
  CHECK(samples_of(resumed) == 2);
  for (std::uint32_t row = 3; row < 8; ++row) accumulate(t.reference, Transport::physical, row, {5, 9}, &resumed);
  Accumulation ab = a, ba = resumed;
  REQUIRE(merge(resumed, &ab).ok);
  REQUIRE(merge(a, &ba).ok);
  CHECK(same(ab, one));
  CHECK(same(ba, one));
  CHECK(samples_of(ab) == 24);
  // Its mean is the one that the tracer gives.
  ReferenceOptions o;
  o.samples_per_pixel = 12;
  std::vector<Vec3d> means(64);
  trace_reference(t.reference, o, 0, 8, means.data());
  std::vector<Vec3> half = mean_of_half(one, 0);
  for (std::size_t i = 0; i < half.size(); ++i)
    CHECK(static_cast<double>(half[i].y) == doctest::Approx(means[i].y).epsilon(1e-6));
  // The same samples twice would count as more than they are.
  Status twice = merge(a, &ab);
  CHECK_FALSE(twice.ok);
  CHECK(std::string(twice.message).find("samples 0 … 3 of row 0") != std::string::npos);
  CHECK(same(ab, one));
}

// Goal: hostile files end with one line. Method: a file cut at many lengths, with each byte changed, and with bytes of
// its structure changed under a correct hash.
TEST_CASE("accumulations_refuse_hostile_files") {
  LitFloor s;
  TestReference t(s.scene);
  Accumulation a = empty("a key"), read;
  take(t, {0, 2}, &a);
  take(t, {4, 6}, &a);
  std::vector<std::uint8_t> file = encode_accumulation(a);
  REQUIRE(decode_accumulation(file.data(), file.size(), &read).ok);
  CHECK(read.key == "a key");
  CHECK(same(a, read));
  for (std::size_t length = 0; length < file.size(); length += length < 1200 ? 1 : 37)
    CHECK_FALSE(decode_accumulation(file.data(), length, &read).ok);
  for (std::size_t at = 0; at < file.size(); at += at < 1200 ? 1 : 37) {
    std::vector<std::uint8_t> changed = file;
    changed[at] ^= 0x10;
    CHECK_FALSE(decode_accumulation(changed.data(), changed.size(), &read).ok);
  }
  std::vector<std::uint8_t> longer = file;
  longer.push_back(0);
  CHECK_FALSE(decode_accumulation(longer.data(), longer.size(), &read).ok);
  auto forge = [&](std::size_t at, std::uint8_t value) {
    std::vector<std::uint8_t> forged(file.begin(), file.end() - 16);
    forged[at] = value;
    ContentHash hash = content_hash(forged.data(), forged.size());
    for (std::uint64_t word : {hash.low, hash.high})
      for (int i = 0; i < 8; ++i) forged.push_back(static_cast<std::uint8_t>(word >> 8 * i));
    return decode_accumulation(forged.data(), forged.size(), &read).ok;
  };
  const std::size_t structure = 12 + 8 * 8 * 12;  // magic, key, ranges of each row
  std::size_t key = structure + 23, ranges = key + 4 + 5;
  CHECK(forge(key + 4, 'b'));
  CHECK_FALSE(forge(structure + 1, 'q'));
  for (std::size_t i = 0; i < 4; ++i) CHECK_FALSE(forge(key + i, 0xFF));
  for (std::size_t i = 0; i < 4; ++i) CHECK_FALSE(forge(ranges + i, 0xFF));  // ranges of row 0
  CHECK_FALSE(forge(ranges + 4, 3));                                         // begins behind its end
  CHECK_FALSE(forge(ranges + 12, 1));                                        // overlaps the one before
  CHECK_FALSE(forge(ranges + 19, 0x7F));                                     // more samples than any file has
  std::string text = "PF\n8 8\n-1.0\n";
  std::vector<std::uint8_t> plain(text.begin(), text.end());
  plain.resize(12 + 8 * 8 * 12);
  Status status = decode_accumulation(plain.data(), plain.size(), &read);
  CHECK(std::string(status.message).find("without its samples") != std::string::npos);
}

// Goal: the error that two halves tell is the true one, as a whole and per quarter of the picture. Method: the RMS of
// half their difference, against the distance of their mean from a picture with 256 times the samples; 30 runs with
// other samples. A ratio of 1 within its scatter; within a factor of 2 in 9 of 10 quarters.
TEST_CASE("accumulations_know_their_error") {
  LitFloor s;
  TestReference t(s.scene);
  Accumulation truth = empty();
  take(t, {1u << 16, (1u << 16) + 4096}, &truth);
  std::vector<Vec3> exact = mean_of_half(truth, 0), more = mean_of_half(truth, 1);
  for (std::size_t i = 0; i < exact.size(); ++i) exact[i] = exact[i] * 0.5f + more[i] * 0.5f;
  constexpr std::uint32_t kRuns = 30;
  double told_sum = 0, true_sum = 0;
  int covered = 0;
  for (std::uint32_t run = 0; run < kRuns; ++run) {
    Accumulation a = empty();
    take(t, {16 * run, 16 * run + 16}, &a);
    std::vector<Vec3> one = mean_of_half(a, 0), other = mean_of_half(a, 1);
    for (std::uint32_t quarter = 0; quarter < 4; ++quarter) {
      double told = 0, is = 0;
      for (std::uint32_t i = 0; i < 64; ++i) {
        if ((i / 32) * 2 + (i % 8) / 4 != quarter) continue;
        for (int c = 0; c < 3; ++c) {
          double difference = 0.5 * static_cast<double>(one[i][c] - other[i][c]);
          double error = 0.5 * static_cast<double>(one[i][c] + other[i][c]) - static_cast<double>(exact[i][c]);
          told += difference * difference, is += error * error;
        }
      }
      told_sum += told, true_sum += is;
      double ratio = std::sqrt(told / is);
      covered += ratio > 1 / 2.0 && ratio < 2.0;
    }
  }
  double ratio = std::sqrt(told_sum / true_sum);
  CAPTURE(ratio);
  CHECK(ratio > 0.85);
  CHECK(ratio < 1.15);
  CAPTURE(covered);
  CHECK(covered >= 0.9 * 4 * kRuns);
}
