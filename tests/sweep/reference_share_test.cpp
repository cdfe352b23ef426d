// How samples of a reference are shared out, whoever takes them and whenever they come back.
#include <doctest/doctest.h>

#include <algorithm>
#include <set>

#include "base/rng.h"
#include "desktop/sweep/reference_share.h"

using namespace pocketray;

namespace {

constexpr std::uint32_t kWidth = 2, kHeight = 7;

Accumulation nothing() { return empty_accumulation("key", kWidth, kHeight); }

// Sums that tell which samples they are of.
RowSamples taken(const ReferencePiece& piece) {
  RowSamples row = {piece.row, piece.samples, std::vector<ExactSum>(kReferenceHalfCount * kWidth * 3)};
  for (std::uint32_t s = piece.samples.begin; s < piece.samples.end; ++s)
    for (std::size_t i = 0; i < row.sums.size(); ++i) row.sums[i].low += (s + 1) * (s + 1) + i;
  return row;
}

void add_now(const ReferencePiece& piece, Accumulation* accumulation) { CHECK(merge(taken(piece), accumulation).ok); }

// What one program has after these batches, of that part.
Accumulation after(std::uint32_t samples, std::uint32_t batches, std::uint32_t part, std::uint32_t part_count,
                   Accumulation accumulation) {
  for (std::uint32_t batch = part - 1; batch < batches; batch += part_count) {
    SampleRange range = {batch * kReferenceBatch, std::min(samples, (batch + 1) * kReferenceBatch)};
    for (std::uint32_t row = 0; row < kHeight; ++row)
      for (const SampleRange& missing : missing_samples(accumulation.rows[row], range))
        add_now({row, missing}, &accumulation);
  }
  return accumulation;
}

bool same(const Accumulation& a, const Accumulation& b) { return encode_accumulation(a) == encode_accumulation(b); }

}  // namespace

// Goal: with a measured end, the samples at each measurement are those of one program alone, measured at the same
// batches, however many pieces are out and in whatever order they come back. Method: several takers at random, from
// nothing or from samples that are there already, in parts or whole.
TEST_CASE("share_of_reference_equals_one_program_at_each_measurement") {
  Rng rng = make_rng(7);
  auto below = [&](std::size_t n) { return static_cast<std::size_t>(next_double(&rng) * static_cast<double>(n)); };
  struct Row {
    std::uint32_t samples, part, part_count, batches_there;
  };
  for (const Row& r : {Row{270, 1, 1, 0}, Row{270, 2, 3, 0}, Row{269, 1, 1, 20}, Row{3, 1, 1, 0}, Row{64, 1, 1, 16}}) {
    CAPTURE(r.samples);
    CAPTURE(r.part_count);
    Accumulation there = after(r.samples, r.batches_there, 1, 1, nothing());
    if (r.batches_there == 20) add_now({3, {100, 102}}, &there), add_now({4, {120, 140}}, &there);
    Accumulation sum = there;
    ReferenceShare share(r.samples, r.part, r.part_count, true, &sum);
    std::vector<ReferencePiece> out;
    MeasureSchedule schedule;
    std::vector<std::uint32_t> due, measured;
    const std::uint32_t batch_count = (r.samples + kReferenceBatch - 1) / kReferenceBatch;
    for (std::uint32_t batch = r.part - 1; batch < batch_count; batch += r.part_count)
      if (schedule.is_due_after(batch) && batch >= r.batches_there) due.push_back(batch + 1);
    while (!share.is_done()) {
      for (const ReferencePiece& piece : share.take(static_cast<std::uint32_t>(below(9)))) out.push_back(piece);
      if (!out.empty()) {
        std::swap(out[below(out.size())], out.back());
        CHECK(share.add(taken(out.back())).ok);
        out.pop_back();
      }
      while (share.is_first_round_done()) {
        if (share.is_measured()) {
          measured.push_back(share.batches());
          CHECK(same(sum, after(r.samples, share.batches(), r.part, r.part_count, there)));
        }
        CHECK(share.end_round().ok);
      }
    }
    CHECK(out.empty());
    CHECK(measured == due);
    CHECK(same(sum, after(r.samples, batch_count, r.part, r.part_count, there)));
  }
}

// Goal: threads take the pieces of a portion at once, so they are of different rows; each sample is given out once.
TEST_CASE("share_of_reference_gives_each_sample_once_and_rows_of_a_portion_differ") {
  Accumulation sum = nothing();
  add_now({2, {1, 2}}, &sum);  // leaves two gaps in a batch
  ReferenceShare share(100, 1, 1, false, &sum);
  std::size_t portions = 0;
  while (!share.is_done()) {
    std::vector<ReferencePiece> portion = share.take(1000);
    std::set<std::uint32_t> rows;
    for (const ReferencePiece& piece : portion) {
      CHECK(rows.insert(piece.row).second);
      CHECK(share.add(taken(piece)).ok);  // fails if it is there already
    }
    CHECK(portion.size() <= kHeight);
    while (share.is_first_round_done()) CHECK(share.end_round().ok);
    REQUIRE(++portions < 1000);
  }
  CHECK(samples_of(sum) == 200);
}

// Goal: samples beyond the next measurement are kept if the reference is interrupted; without a measured end nothing is
// held back.
TEST_CASE("share_of_reference_keeps_what_it_held_back") {
  for (bool is_gated : {true, false}) {
    CAPTURE(is_gated);
    Accumulation sum = nothing();
    ReferenceShare share(100, 1, 1, is_gated, &sum);
    std::vector<ReferencePiece> first = share.take(kHeight), second = share.take(kHeight);
    REQUIRE(second[0].samples.begin > first[0].samples.begin);
    CHECK(share.add(taken(second[0])).ok);
    CHECK(sample_count(sum.rows[second[0].row]) == (is_gated ? 0 : second[0].samples.end - second[0].samples.begin));
    CHECK(share.add_held().ok);
    CHECK(sample_count(sum.rows[second[0].row]) > 0);
  }
}

// Goal: samples that nobody asked for, or of another picture, are refused and change nothing.
TEST_CASE("share_of_reference_refuses_what_it_did_not_ask_for") {
  Accumulation sum = nothing();
  ReferenceShare share(8, 1, 1, false, &sum);
  ReferencePiece piece = share.take(1)[0];
  CHECK(!share.add(taken({0, {800, 804}})).ok);
  RowSamples narrow = taken(piece);
  narrow.sums.pop_back();
  CHECK(!share.add(narrow).ok);
  CHECK(!share.add(taken({kHeight, piece.samples})).ok);
  CHECK(same(sum, nothing()));
  CHECK(share.add(taken(piece)).ok);
  CHECK(!share.add(taken(piece)).ok);
}
