// Which rank traces which rows.
#include "remote/cluster/row_share.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <map>

#include "base/rng.h"

using namespace pocketray;

namespace {

constexpr std::uint32_t kWidth = 40, kHeight = 240;

FrameRequest request_of(std::uint32_t begin = 0, std::uint32_t end = kHeight) {
  FrameRequest request;
  request.settings.width = kWidth, request.settings.height = kHeight;
  request.row_begin = static_cast<std::uint16_t>(begin), request.row_end = static_cast<std::uint16_t>(end);
  return request;
}

PieceLimits limits_of(std::uint32_t window, std::uint32_t rows) {
  PieceLimits limits;
  limits.window = window, limits.rows = rows, limits.pixels = 1u << 20;
  return limits;
}

RowShare begun(const FrameRequest& request) {
  RowShare share;
  make_row_share(kHeight, &share);
  begin_row_share(request, false, &share);
  return share;
}

}  // namespace

// Goal: every pixel is given once, in order within the window, whatever the ranks' speeds; the front passes what is
// done without a gap. Method: 64 ranks on a virtual clock, with random limits, in whole rows and parts.
TEST_CASE("row_share_gives_every_pixel_once") {
  for (std::uint32_t seed = 0; seed < 20; ++seed) {
    Rng rng = make_rng(seed);
    RowShare share = begun(request_of());
    std::vector<int> given(kWidth * kHeight);
    std::multimap<std::uint32_t, std::pair<std::uint16_t, RowPiece>> ends;  // by time
    std::uint32_t now = 0;
    const std::uint32_t ranks = 1 + seed * 63 / 19;
    for (std::uint16_t rank = 0; rank < ranks; ++rank) ends.insert({0, {rank, RowPiece()}});
    while (!ends.empty()) {
      now = ends.begin()->first;
      const auto [rank, piece] = ends.begin()->second;
      ends.erase(ends.begin());
      if (pixel_count(piece) > 0) end_piece(&share, rank, piece);
      PieceLimits limits = limits_of(1 + next_u32(&rng) % 60, 1 + next_u32(&rng) % 9);
      if (next_u32(&rng) % 2) limits.pixels = 1 + next_u32(&rng) % (2 * kWidth);
      RowPiece next;
      const std::uint32_t front = share.front;
      if (!take_piece(&share, rank, limits, &next)) {
        if (share.front < share.count) ends.insert({now + 1, {rank, RowPiece()}});
        continue;
      }
      for (std::uint32_t row = next.row_begin; row < next.row_end; ++row) {
        CHECK(share.places[row] >= front);
        CHECK(share.places[row] < front + limits.window);
        for (std::uint32_t x = next.column_begin; x < next.column_end; ++x) ++given[row * kWidth + x];
      }
      CHECK(pixel_count(next) <= std::max(limits.pixels, 1u));
      CHECK(next.row_end - next.row_begin <= limits.rows);
      ends.insert({now + 1 + pixel_count(next) * (1 + rank % 7), {rank, next}});
    }
    CHECK(share.front == kHeight);
    CHECK(std::all_of(given.begin(), given.end(), [](int count) { return count == 1; }));
  }
}

// Goal: pieces end at multiples of four rows if they reach one, so that strips of tiles stay whole.
TEST_CASE("row_share_aligns_pieces") {
  RowShare share = begun(request_of(3, 231));
  std::vector<std::uint32_t> begins;
  RowPiece piece;
  while (take_piece(&share, 1, limits_of(kHeight, 8), &piece)) begins.push_back(piece.row_begin);
  CHECK(begins[0] == 224);
  CHECK(begins[1] == 216);
  CHECK(begins.back() == 3);
  for (std::size_t i = 0; i + 1 < begins.size(); ++i) CHECK(begins[i] % 4 == 0);
}

// Goal: ranks get the rows that they had; those of others only if allowed, or if nobody has them any more.
TEST_CASE("row_share_prefers_rows_of_the_last_frame") {
  RowShare share = begun(request_of());
  RowPiece piece;
  std::vector<RowPiece> first[3];
  for (std::uint16_t rank = 0; share.front < kHeight; rank = (rank + 1) % 3) {
    REQUIRE(take_piece(&share, rank, limits_of(kHeight, 8), &piece));
    CHECK(end_piece(&share, rank, piece));
    first[rank].push_back(piece);
  }
  begin_row_share(request_of(), true, &share);
  PieceLimits own = limits_of(kHeight, 8);
  own.any = false;
  for (const RowPiece& expected : first[1]) {
    REQUIRE(take_piece(&share, 1, own, &piece));
    CHECK(piece == expected);
  }
  CHECK(!take_piece(&share, 1, own, &piece));
  CHECK(!take_piece(&share, 3, own, &piece));
  take_back_rows(&share, 2);
  REQUIRE(take_piece(&share, 3, own, &piece));
  CHECK(piece == first[2][0]);
  REQUIRE(take_piece(&share, 1, limits_of(kHeight, 8), &piece));
  CHECK(piece == first[2][1]);
  begin_row_share(request_of(), false, &share);
  REQUIRE(take_piece(&share, 1, own, &piece));
  CHECK(piece == first[0][0]);
}

// Goal: rows of a rank that is gone are given again, whole, and only those that it had not completed.
TEST_CASE("row_share_takes_back_incomplete_rows") {
  RowShare share = begun(request_of(0, 16));
  RowPiece done, lost, part;
  REQUIRE(take_piece(&share, 1, limits_of(16, 4), &done));
  CHECK(end_piece(&share, 1, done));
  REQUIRE(take_piece(&share, 1, limits_of(16, 4), &lost));
  PieceLimits narrow = limits_of(16, 4);
  narrow.pixels = kWidth / 2;
  REQUIRE(take_piece(&share, 2, narrow, &part));
  CHECK(part.column_end == kWidth / 2);
  CHECK(!end_piece(&share, 2, part));
  take_back_rows(&share, 1);
  take_back_rows(&share, 2);
  CHECK(share.front == 4);
  CHECK(free_rows(share, 16) == 12);
  RowPiece again;
  REQUIRE(take_piece(&share, 3, limits_of(16, 4), &again));
  CHECK(again == lost);
  REQUIRE(take_piece(&share, 3, limits_of(16, 8), &again));
  CHECK(again.row_end == part.row_end);
  CHECK(again.column_begin == 0);
}
