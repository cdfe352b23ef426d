// Which samples of a reference are taken next, and when its error is due to be measured. Neither talks nor looks at a
// clock: whatever order pieces come back in, the samples that count are those of one program alone.
#pragma once
#include <deque>

#include "reference/row_samples.h"

namespace pocketray {

// Samples of each half between which a row's may be saved; small, since an interrupt waits for them.
constexpr std::uint32_t kReferenceBatch = 4;

// When the error of a reference is measured: whenever the number of batches has grown by a tenth.
struct MeasureSchedule {
  std::uint32_t at = 2;
  // To be asked after each batch, in ascending order.
  bool is_due_after(std::uint32_t batch);
};

struct ReferencePiece {
  std::uint32_t row;
  SampleRange samples;  // of each half
};

class ReferenceShare {
 public:
  // Of at most `samples` per pixel and half; takes batches part − 1, part − 1 + part_count, … If `is_gated`, samples
  // beyond those to be measured next are held back. The accumulation must outlive it.
  ReferenceShare(std::uint32_t samples, std::uint32_t part, std::uint32_t part_count, bool is_gated,
                 Accumulation* accumulation);

  // The next pieces to be taken, of different rows; at most so many, and none if those that may be begun are.
  std::vector<ReferencePiece> take(std::uint32_t count);
  // The same for a helper of so many threads among all the team's: two pieces for each, as long as there are plenty, so
  // that threads wait little for each other; at last one, so that ranks do.
  std::vector<ReferencePiece> take_portion(std::uint32_t threads, std::uint32_t all_threads);
  // Samples of a piece that was given out.
  Status add(RowSamples taken);

  // A round is what lies between two measurements. True if all samples of the first are there.
  bool is_first_round_done() const;
  // The error should be measured: the samples are those of the batches before `batches`.
  bool is_measured() const { return rounds_.front().is_measured; }
  std::uint32_t batches() const { return rounds_.front().batches; }
  // Goes on with the next round.
  Status end_round();
  bool is_done() const { return rounds_.empty(); }

  // Adds what is held back, too: for when samples matter more than their number.
  Status add_held();

 private:
  struct Round {
    std::uint32_t begin, end, batches;  // samples; batches before its end
    bool is_measured = false;
    std::vector<ReferencePiece> pieces = {};
    std::size_t next = 0, missing = 0;  // pieces to be given out next, and not back yet
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
