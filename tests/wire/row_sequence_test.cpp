// The order of a request's rows.
#include "wire/row_sequence.h"

#include <doctest/doctest.h>

#include <vector>

#include "support/effort.h"
#include "wire/sample_messages.h"

using namespace pocketray;

// Goal: a sequence passes every row of a request once: run by run in the order of their places, each from its lowest
// row upward, in chunks of at most the rows asked for. Method: random orders; parts of chunks as a sender may choose.
TEST_CASE("row_sequence_passes_every_row_once") {
  Rng rng = make_rng(13);
  for (int round = 0; round < effort(300); ++round) {
    const FrameRequest q = sample_message(MessageType::frame_request, &rng, {}).frame_request;
    std::vector<int> passed(q.settings.height, 0);
    std::uint32_t runs = 0, before = q.row_end;
    for (RowSequence at = first_rows(q); has_rows(at);) {
      const RowRange run = run_at(q, at.place);
      const std::uint32_t most = next_chunk_rows(q, at), count = 1 + next_u32(&rng) % most;
      REQUIRE(most >= 1);
      CHECK(most <= q.chunk_rows);
      CHECK(at.row_begin == run.begin);
      if (at.row_end == run.end)
        ++runs;
      else
        CHECK(at.row_end == before);
      for (std::uint32_t row = at.row_end - count; row < at.row_end; ++row) ++passed[row];
      before = at.row_end - count;
      pass_rows(q, count, &at);
    }
    CHECK(runs == (q.row_begin < q.row_end ? run_count(q) : 0));
    for (std::uint32_t row = 0; row < q.settings.height; ++row)
      REQUIRE(passed[row] == (row >= q.row_begin && row < q.row_end));
  }
}
