// Decides which samples of a reference are taken next, and when its error is due to be measured. Neither communicates
// nor reads a clock: whatever order pieces return in, the samples that count equal those of a single process.
#pragma once
#include <deque>

#include "desktop/reference/row_samples.h"

namespace pocketray {

// Samples of each half between possible saves of a row; small, since an interrupt waits for them.
constexpr std::uint32_t kReferenceBatch = 4;

// Schedule for measuring a reference's error: whenever the number of batches has grown by a tenth.
struct MeasureSchedule {
  std::uint32_t at = 2;
  // Call after each batch, in ascending order.
  bool is_due_after(std::uint32_t batch);
};

struct ReferencePiece {
  std::uint32_t row;
  SampleRange samples;  // of each half
};

class ReferenceShare {
 public:
  // Takes at most `samples` per pixel and half, in batches part − 1, part − 1 + part_count, … If `is_gated`, samples
  // beyond the next measurement are held back. The accumulation must outlive it.
  ReferenceShare(std::uint32_t samples, std::uint32_t part, std::uint32_t part_count, bool is_gated,
                 Accumulation* accumulation);

  // Returns the next pieces to take, of different rows, at most `count`; none if all that may begin have begun.
  std::vector<ReferencePiece> take(std::uint32_t count);
  // Returns pieces for a helper with `threads` of the team's threads: two per thread while there are plenty, so that
  // threads rarely wait for each other; finally one, so that ranks rarely do.
  std::vector<ReferencePiece> take_portion(std::uint32_t threads, std::uint32_t all_threads);
  // Adds the samples of a piece that was given out.
  Status add(RowSamples taken);

  // A round is the interval between two measurements. Returns whether the first round's samples are complete.
  bool is_first_round_done() const;
  // True if the error should be measured: the samples are those of the batches before `batches`.
  bool is_measured() const { return rounds_.front().is_measured; }
  std::uint32_t batches() const { return rounds_.front().batches; }
  // Continues with the next round.
  Status end_round();
  bool is_done() const { return rounds_.empty(); }

  // Also adds what is held back, when samples matter more than their number.
  Status add_held();

 private:
  struct Round {
    std::uint32_t begin, end, batches;  // samples; batches before its end
    bool is_measured = false;
    std::vector<ReferencePiece> pieces = {};
    std::size_t next = 0, missing = 0;  // next piece to give out, pieces not back yet
    std::vector<RowSamples> held = {};
  };
  void look_ahead();
  Round next_round();

  std::uint32_t end_, batch_, batch_count_, part_count_;
  bool is_gated_;
  Accumulation* accumulation_;
  MeasureSchedule schedule_;
  std::deque<Round> rounds_;
};

}  // namespace pocketray
