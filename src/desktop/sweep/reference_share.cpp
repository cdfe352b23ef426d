#include "desktop/sweep/reference_share.h"

#include <algorithm>

#include "base/check.h"

namespace pocketray {
namespace {

constexpr double kMeasureGrowth = 1.1;
// Chosen: a row of 320 pixels then takes a tenth of a second, and sending its 31 kB of sums a ten-thousandth of that.
constexpr std::uint32_t kBatchesAtOnce = 4;
// Chosen: while one process measures, the others are busy. Held-back samples take a few megabytes per round of a small
// picture; without any, rounds only list pieces.
constexpr std::size_t kRoundsAhead = 4, kUngatedRoundsAhead = 64;
// Portions of all threads that count as plenty.
constexpr std::size_t kPlenty = 4, kPiecesMax = 2;

}  // namespace

bool MeasureSchedule::is_due_after(std::uint32_t batch) {
  if (batch + 1 < at) return false;
  at = std::max(batch + 2, static_cast<std::uint32_t>(kMeasureGrowth * (batch + 1)));
  return true;
}

ReferenceShare::ReferenceShare(std::uint32_t samples, std::uint32_t part, std::uint32_t part_count, bool is_gated,
                               Accumulation* accumulation)
    : end_(samples),
      batch_(part - 1),
      batch_count_((samples + kReferenceBatch - 1) / kReferenceBatch),
      part_count_(part_count),
      is_gated_(is_gated),
      accumulation_(accumulation) {
  CHECK(part >= 1 && part <= part_count);
  CHECK_LE(samples, kReferenceSampleMax);
  look_ahead();
}

void ReferenceShare::look_ahead() {
  while (rounds_.size() < (is_gated_ ? kRoundsAhead : kUngatedRoundsAhead) && batch_ < batch_count_)
    rounds_.push_back(next_round());
}

ReferenceShare::Round ReferenceShare::next_round() {
  CHECK_LT(batch_, batch_count_);
  std::vector<SampleRange> ranges;
  Round round = {batch_ * kReferenceBatch, 0, 0};
  for (bool is_due = false; !is_due && batch_ < batch_count_; batch_ += part_count_) {
    SampleRange batch = {batch_ * kReferenceBatch, std::min(end_, (batch_ + 1) * kReferenceBatch)};
    const bool joins = !ranges.empty() && ranges.back().end == batch.begin &&
                       batch.end - ranges.back().begin <= kBatchesAtOnce * kReferenceBatch;
    if (joins)
      ranges.back().end = batch.end;
    else
      ranges.push_back(batch);
    round.end = batch.end, round.batches = batch_ + 1;
    is_due = schedule_.is_due_after(batch_);
    for (std::uint32_t row = 0; is_due && !round.is_measured && row < accumulation_->height; ++row)
      round.is_measured = !missing_samples(accumulation_->rows[row], batch).empty();
  }
  for (const SampleRange& range : ranges)
    for (std::uint32_t row = 0; row < accumulation_->height; ++row)
      for (const SampleRange& missing : missing_samples(accumulation_->rows[row], range))
        round.pieces.push_back({row, missing});
  round.missing = round.pieces.size();
  return round;
}

std::vector<ReferencePiece> ReferenceShare::take(std::uint32_t count) {
  std::vector<ReferencePiece> taken;
  for (Round& round : rounds_)
    for (; round.next < round.pieces.size() && taken.size() < count; ++round.next) {
      const ReferencePiece& piece = round.pieces[round.next];
      if (std::any_of(taken.begin(), taken.end(), [&](const ReferencePiece& t) { return t.row == piece.row; }))
        return taken;
      taken.push_back(piece);
    }
  return taken;
}

std::vector<ReferencePiece> ReferenceShare::take_portion(std::uint32_t threads, std::uint32_t all_threads) {
  CHECK(threads > 0 && threads <= all_threads);
  std::size_t left = 0;
  for (const Round& round : rounds_) left += round.pieces.size() - round.next;
  const std::size_t each = std::min(kPiecesMax, std::max<std::size_t>(1, left / (kPlenty * all_threads)));
  return take(threads * static_cast<std::uint32_t>(each));
}

Status ReferenceShare::add(RowSamples taken) {
  auto round = std::find_if(rounds_.begin(), rounds_.end(), [&](const Round& r) {
    return taken.samples.begin >= r.begin && taken.samples.begin < r.end;
  });
  if (round == rounds_.end() || round->missing == 0) return failure("samples that nobody requested");
  if (is_gated_ && round != rounds_.begin())
    round->held.push_back(std::move(taken));
  else
    RETURN_IF_ERROR(merge(taken, accumulation_));
  --round->missing;
  return success();
}

bool ReferenceShare::is_first_round_done() const { return !rounds_.empty() && rounds_.front().missing == 0; }

Status ReferenceShare::end_round() {
  CHECK(is_first_round_done());
  rounds_.pop_front();
  look_ahead();
  if (rounds_.empty()) return success();
  for (const RowSamples& held : rounds_.front().held) RETURN_IF_ERROR(merge(held, accumulation_));
  rounds_.front().held.clear();
  return success();
}

Status ReferenceShare::add_held() {
  for (Round& round : rounds_) {
    for (const RowSamples& held : round.held) RETURN_IF_ERROR(merge(held, accumulation_));
    round.held.clear();
  }
  return success();
}

}  // namespace pocketray
