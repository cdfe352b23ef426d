// How frames of a sequence are shared out to ranks.
#include <doctest/doctest.h>

#include <algorithm>

#include "base/rng.h"
#include "session/sequence_share.h"

using namespace pocketray;

namespace {

std::vector<std::uint32_t> frames_of(std::uint32_t count) {
  std::vector<std::uint32_t> frames;
  for (std::uint32_t i = 0; i < count; ++i) frames.push_back(10 + i + i / 7);  // some are finished already
  return frames;
}

}  // namespace

// Goal: every frame is given out once, whatever the pace of the ranks. Method: ranks come at random, one of them
// rarely.
TEST_CASE("sequence_share_gives_every_frame_once") {
  Rng rng = make_rng(3);
  for (std::uint32_t count : {0u, 1u, 2u, 5u, 100u, 351u})
    for (std::uint32_t ranks : {1u, 2u, 3u, 7u, 64u}) {
      CAPTURE(count);
      CAPTURE(ranks);
      SequenceShare share(frames_of(count), ranks);
      std::vector<std::uint32_t> given;
      CHECK(share.left() == count);
      for (std::uint32_t calls = 0; share.left() > 0; ++calls) {
        REQUIRE(calls < 100000);
        auto rank = static_cast<std::uint32_t>(next_double(&rng) * ranks);
        if (rank == 0 && calls % 50 != 0) continue;
        std::vector<std::uint32_t> taken = share.take(rank, 1 + calls % 4);
        CHECK(!taken.empty());
        CHECK(std::is_sorted(taken.begin(), taken.end()));
        given.insert(given.end(), taken.begin(), taken.end());
      }
      CHECK(share.take(ranks - 1, 3).empty());
      std::sort(given.begin(), given.end());
      CHECK(given == frames_of(count));
    }
}

// Goal: frames of a rank are neighbours, but for few jumps: each makes a frame that is traced whole. Method: counts
// them for ranks of equal pace and for one that is ten times slower.
TEST_CASE("sequence_share_gives_neighbours_to_a_rank") {
  for (std::uint32_t slow : {1u, 10u}) {
    CAPTURE(slow);
    constexpr std::uint32_t kRanks = 4;
    std::vector<std::uint32_t> frames;
    for (std::uint32_t i = 0; i < 400; ++i) frames.push_back(i);
    SequenceShare share(frames, kRanks);
    std::uint32_t last[kRanks] = {}, jumps = 0, rendered[kRanks] = {};
    for (std::uint32_t tick = 0; share.left() > 0; ++tick)
      for (std::uint32_t rank = 0; rank < kRanks; ++rank) {
        if (rank == 0 && tick % slow != 0) continue;
        for (std::uint32_t frame : share.take(rank, 1)) {
          jumps += rendered[rank]++ > 0 && frame != last[rank] + 1;
          last[rank] = frame;
        }
      }
    CHECK(jumps <= (slow == 1 ? 0 : 30));
    CHECK(rendered[0] <= (slow == 1 ? 100 : 20));
  }
}
