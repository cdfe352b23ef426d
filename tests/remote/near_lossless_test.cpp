// Rows that a user allows to be off by a level: never more, fewer bytes, and no honest server is accused.
#include <doctest/doctest.h>

#include <algorithm>
#include <cstdlib>

#include "remote/client/parts.h"
#include "split_rig.h"
#include "support/effort.h"
#include "support/lying_server.h"

using namespace pocketray;

namespace {

SplitRigOptions slow_link(std::uint32_t server_count, WireFormat format, bool near_lossless) {
  SplitRigOptions options;
  options.scene = "seesaw";
  options.width = 96, options.height = 72;
  options.server_count = server_count;
  options.compares = false;
  options.coherence = CoherenceMode::off;
  options.device_ns = 20000;
  options.line.bytes_per_second = 2'000'000;  // slow enough that rows are coded
  options.client.format = format;
  options.client.near_lossless = near_lossless;
  options.client.check_count = 64;
  return options;
}

// Largest difference of a channel in levels.
int largest_difference(const SplitRig& rig, const std::vector<std::uint8_t>& right) {
  const bool is_565 = rig.client.options.format == WireFormat::rgb565;
  const std::uint8_t* shown = rig.client.picture.pixels.data;
  int largest = 0;
  for (std::size_t i = 0; i < right.size(); i += is_565 ? 2 : 3)
    for (int c = 0; c < 3; ++c) {
      const auto level = [&](const std::uint8_t* p) {
        return static_cast<int>(is_565 ? channel_of<Pixel565>(Pixel565::load(p), c)
                                       : channel_of<Pixel888>(Pixel888::load(p), c));
      };
      largest = std::max(largest, std::abs(level(shown + i) - level(&right[i])));
    }
  return largest;
}

}  // namespace

// Goal: with near-lossless rows, frames are off by at most a level, take fewer bytes, and pass the spot checks of a
// device, which would drop a server that is off by more; without, they are exact. Method: a moving scene, both formats;
// the same frames both ways.
TEST_CASE("near_lossless_frames_are_off_by_at_most_a_level") {
  for (WireFormat format : {WireFormat::rgb565, WireFormat::rgb888}) {
    std::uint64_t bytes[2] = {};
    for (bool near_lossless : {false, true}) {
      SplitRig rig(slow_link(1, format, near_lossless));
      int largest = 0;
      for (int i = 0; i < effort(12); ++i) {
        rig.frame(0.04 * i);
        largest = std::max(largest, largest_difference(rig, rig.local_pixels(0.04 * i)));
        bytes[near_lossless] += rig.client.share.row_bytes;
      }
      CHECK(largest == (near_lossless ? 1 : 0));
      CHECK(rig.client.servers[0].checks.checked > 0);
      CHECK(!rig.client.servers[0].overture.lied);
      CHECK(rig.log.empty());
    }
    CHECK(10 * bytes[true] < 9 * bytes[false]);
  }
}

// Goal: a liar is found all the same. Method: a server whose pixels are all inverted, beside an honest one.
TEST_CASE("near_lossless_rows_of_a_liar_are_found") {
  SplitRig rig(slow_link(2, WireFormat::rgb888, true));
  make_liar(&rig.world, 1, [](std::uint32_t, std::uint32_t, std::uint32_t) { return true; });
  for (int i = 0; i < 8 && !rig.client.servers[1].overture.lied; ++i) rig.frame(0.04 * i);
  forget_lies();
  CHECK(rig.client.servers[1].overture.lied);
  CHECK(!rig.client.servers[0].overture.lied);
}

// Goal: a device without the scene accuses none of several honest servers, of which two may differ by two levels.
TEST_CASE("near_lossless_servers_do_not_dispute") {
  SplitRigOptions options = slow_link(3, WireFormat::rgb565, true);
  options.client.has_scene = false;
  options.client.check_count = 1;
  SplitRig rig(options);
  std::uint64_t checked = 0;
  for (int i = 0; i < effort(30); ++i) {
    rig.frame(0.04 * i);
    for (std::uint32_t s = 0; s < 3; ++s) checked += rig.client.share.checked[s];
  }
  CHECK(checked > 0);
  CHECK(rig.log.empty());
  CHECK(!rig.client.verifier.disputed);
}
