// The origin of rows.
#include "split/merge.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <vector>

#include "base/rng.h"
#include "support/effort.h"

using namespace pocketray;

namespace {

struct OwnMerge {
  std::vector<std::uint8_t> block;
  Merge merge;
  explicit OwnMerge(std::uint32_t rows) : block(merge_need(rows) + kArenaAlignment) {
    Arena arena = make_arena("merge", block.data(), block.size());
    merge = make_merge(rows, &arena);
  }
};

}  // namespace

// Goal: the device goes down from the top, a server comes up from the bottom, they meet, and no row is done twice.
TEST_CASE("merge_device_and_server_meet") {
  OwnMerge own(10);
  Merge* m = &own.merge;
  begin_merge(m, 7);
  std::uint32_t begin, end;
  CHECK(take_rows(m, 3, &begin, &end));
  CHECK((begin == 0 && end == 3));
  CHECK(accept_rows(m, 7, 6, 10, 0) == 4);
  finish_rows(m, 0, 3);
  CHECK(take_rows(m, 8, &begin, &end));
  CHECK((begin == 3 && end == 6));
  CHECK(!is_complete(*m));
  finish_rows(m, 3, 6);
  CHECK(is_complete(*m));
  CHECK(!take_rows(m, 1, &begin, &end));
  CHECK(count_rows(*m, kDeviceRows) == 6);
  CHECK(count_rows(*m, 0) == 4);
  CHECK(count_rows(*m, 1) == 0);
}

// Goal: stale, future, duplicate and out-of-range chunks change nothing.
TEST_CASE("merge_ignores_chunks_that_do_not_fit") {
  OwnMerge own(10);
  Merge* m = &own.merge;
  begin_merge(m, 7);
  CHECK(accept_rows(m, 6, 0, 10, 0) == 0);
  CHECK(accept_rows(m, 8, 0, 10, 0) == 0);
  CHECK(accept_rows(m, 7, 5, 11, 0) == 0);
  CHECK(accept_rows(m, 7, 6, 5, 0) == 0);
  CHECK(accept_rows(m, 7, 0xFFFFFFFF, 0xFFFFFFFF, 0) == 0);
  CHECK(accept_rows(m, 7, 5, 8, 0) == 3);
  CHECK(accept_rows(m, 7, 4, 8, 1) == 1);
  CHECK(accept_rows(m, 7, 5, 8, 0) == 0);
  CHECK(m->row_count_done == 4);
  CHECK(count_rows(*m, 0) == 3);
  CHECK(count_rows(*m, 1) == 1);
  begin_merge(m, 8);
  CHECK(m->row_count_done == 0);
  CHECK(accept_rows(m, 7, 5, 8, 0) == 0);
}

// Goal: rows that arrive while the device is working on them are the server's, once.
TEST_CASE("merge_rows_that_come_while_taken_count_once") {
  OwnMerge own(4);
  Merge* m = &own.merge;
  std::uint32_t begin, end;
  CHECK(take_rows(m, 4, &begin, &end));
  CHECK(accept_rows(m, 0, 2, 4, 3) == 2);
  finish_rows(m, 0, 4);
  CHECK(is_complete(*m));
  CHECK(count_rows(*m, kDeviceRows) == 2);
  CHECK(count_rows(*m, 3) == 2);
  CHECK(accept_rows(m, 0, 0, 4, 3) == 0);
}

// Goal: whatever arrives in whatever order, the frame is completed, each row done once. Method: random chunks of three
// servers, late, duplicated or never sent; the device takes the missing rows.
TEST_CASE("merge_completes_under_random_arrivals") {
  Rng rng = make_rng(99);
  for (int round = 0; round < effort(2000); ++round) {
    std::uint32_t rows = next_u32(&rng) % 40;
    OwnMerge own(rows);
    Merge* m = &own.merge;
    begin_merge(m, 5);
    std::uint32_t done = 0, taken_begin = 0, taken_end = 0, steps = 0;
    while (!is_complete(*m)) {
      REQUIRE(++steps < 10000);
      if (next_u32(&rng) % 3 == 0) {
        std::uint32_t begin = next_u32(&rng) % (rows + 2), end = begin + next_u32(&rng) % 8;
        done += accept_rows(m, 4 + next_u32(&rng) % 3, begin, end, next_u32(&rng) % 3);
      } else if (taken_begin < taken_end) {
        done += m->rows[taken_begin].state == RowState::taken;
        finish_rows(m, taken_begin, taken_begin + 1);
        ++taken_begin;
      } else {
        take_rows(m, 1 + next_u32(&rng) % 5, &taken_begin, &taken_end);
      }
      REQUIRE(done == m->row_count_done);
    }
    CHECK(done == rows);
    CHECK(count_rows(*m, kDeviceRows) + count_rows(*m, 0) + count_rows(*m, 1) + count_rows(*m, 2) == rows);
  }
}

// Goal: the device can take any missing row; the others go on from the top. Method: the last row and one between, of
// five; one of them arrives meanwhile.
TEST_CASE("merge_takes_single_rows") {
  OwnMerge own(5);
  Merge* m = &own.merge;
  begin_merge(m, 1);
  take_row(m, 4), take_row(m, 2);
  accept_rows(m, 1, 4, 5, 0);
  finish_rows(m, 2, 3), finish_rows(m, 4, 5);
  CHECK(m->rows[2].state == RowState::device);
  CHECK(m->rows[4].state == RowState::server);
  std::uint32_t begin, end;
  REQUIRE(take_rows(m, 9, &begin, &end));
  CHECK(begin == 0);
  CHECK(end == 2);
  REQUIRE(take_rows(m, 9, &begin, &end));
  CHECK(begin == 3);
  CHECK(end == 4);
  finish_rows(m, 0, 2), finish_rows(m, 3, 4);
  CHECK(is_complete(*m));
}

// Goal: rows of an untrusted server are missing again, those of others stay, and the device takes them from the top.
// Method: against simple bookkeeping, over random frames.
TEST_CASE("merge_discards_the_rows_of_a_server") {
  Rng rng = make_rng(23);
  for (int round = 0; round < effort(300); ++round) {
    std::uint32_t rows = 1 + next_u32(&rng) % 40, begin, end;
    OwnMerge own(rows);
    Merge* m = &own.merge;
    begin_merge(m, 1);
    while (!is_complete(*m)) {
      std::uint32_t row = next_u32(&rng) % rows;
      if (next_u32(&rng) % 4 > 0)
        accept_rows(m, 1, row, std::min(rows, row + 3), next_u32(&rng) % 3);
      else if (take_rows(m, 2, &begin, &end))
        finish_rows(m, begin, end);
    }
    std::uint32_t theirs = count_rows(*m, 1), others = rows - theirs;
    CHECK(discard_rows(m, 1) == theirs);
    CHECK(count_rows(*m, 1) == 0);
    CHECK(m->row_count_done == others);
    CHECK(is_complete(*m) == (theirs == 0));
    std::uint32_t device_rows = count_rows(*m, kDeviceRows);
    while (take_rows(m, 5, &begin, &end)) finish_rows(m, begin, end);
    CHECK(is_complete(*m));
    CHECK(count_rows(*m, kDeviceRows) == device_rows + theirs);
    CHECK(discard_rows(m, 1) == 0);
  }
}
