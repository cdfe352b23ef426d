// Frames shared both by effect and by rows, whichever way is the fastest.
#include <doctest/doctest.h>

#include "light_rig.h"

using namespace pocketray;

namespace {

// A link that takes about as long for a frame as the device, which takes little more than half as long with its own
// light.
SplitRigOptions balanced_rig(SplitKind split) {
  SplitRigOptions o = effect_rig("cornell");
  o.width = 96, o.height = 72;
  o.line.bytes_per_second = 1'000'000;
  o.client.own_light_pixel_ns = 550;
  o.client.light.split = split, o.client.light.wait_ns = 0;
  return o;
}

// Median time of the last frames of a turning camera, the very last of which is no trial.
double settled_ns(SplitRig* rig) {
  std::vector<double> times;
  for (int i = 0; i < 24 || rig->client.light.choice.on_trial; ++i) {
    turn(&rig->device->renderer, 0.5f);
    rig->frame(0);
    if (i >= 14) times.push_back(rig->client.share.measured_ns);
  }
  std::nth_element(times.begin(), times.begin() + 5, times.end());
  return times[5];
}

}  // namespace

// Goal: of both ways to share a frame the client takes the faster, by its measurements; rows keep their pixels. Method:
// a fast link and server, where rows are faster.
TEST_CASE("effect_split_automatic_takes_the_faster") {
  SplitRigOptions o = effect_rig("cornell");
  o.client.light.split = SplitKind::automatic;
  SplitRig rig(o);
  int effect = 0;
  for (int i = 0; i < 40; ++i) {
    REQUIRE(begin_frame(&rig.device->renderer, &rig.client, 0).ok);
    while (!advance_frame(&rig.device->renderer, &rig.client, ~std::uint64_t(0))) {
    }
    effect += rig.client.share.by_effect;
    if (!rig.client.share.by_effect) CHECK(pixels_of(rig.client) == rig.local_pixels(0));
  }
  CHECK(effect >= int(kTrialFrames));
  CHECK(effect <= 2 * int(kTrialFrames));
  CHECK(rig.client.light.effect_ns > rig.client.light.rows_ns);
}

// Goal: where both the device and the link are busy, servers have rows of frames that are shared by effect: these take
// less time than frames shared in either way alone, as predicted. The servers' rows are those of the device's own
// frame, and the others have the server's light.
TEST_CASE("effect_split_automatic_shares_rows_too") {
  SplitRig rows(balanced_rig(SplitKind::rows)), effect(balanced_rig(SplitKind::effect));
  SplitRig both(balanced_rig(SplitKind::automatic));
  const double rows_ns = settled_ns(&rows), effect_ns = settled_ns(&effect), both_ns = settled_ns(&both);
  CAPTURE(rows_ns);
  CAPTURE(effect_ns);
  CAPTURE(both_ns);
  CHECK(both_ns < 0.9 * std::min(rows_ns, effect_ns));
  const FrameShare& share = both.client.share;
  CHECK((share.by_effect && share.has_light && share.light_age == 0));
  CHECK((share.server_rows[0] > 8 && share.device_rows > 8));
  CHECK(share.device_rows + share.server_rows[0] == 72);
  CHECK(share.measured_ns == doctest::Approx(share.predicted_ns).epsilon(0.1));
  CHECK(share.local_ns == doctest::Approx(96 * 72 * 1000.0).epsilon(0.1));
  const std::vector<std::uint8_t> right = both.local_pixels(0), ambient = ambient_pixels(&both, 0);
  const std::size_t row_bytes = right.size() / 72;
  double off = 0, off_ambient = 0;
  for (std::uint32_t row = 0; row < 72; ++row) {
    const bool is_server_s = both.client.picture.merge.rows[row].state == RowState::server;
    for (std::size_t i = row * row_bytes; i < (row + 1) * row_bytes; ++i) {
      if (is_server_s) REQUIRE(both.client.picture.pixels[i] == right[i]);
      off += std::abs(int(both.client.picture.pixels[i]) - int(right[i]));
      if (!is_server_s) off_ambient += std::abs(int(ambient[i]) - int(right[i]));
    }
  }
  CHECK(off < 0.5 * off_ambient);
  CHECK(both.log.empty());
}

// Goal: a server that dies in such a frame costs its rows' time and the light, not the frame; afterwards frames go on,
// and when it is back, they are shared again.
TEST_CASE("effect_split_automatic_survives_its_server") {
  SplitRig rig(balanced_rig(SplitKind::automatic));
  settled_ns(&rig);
  REQUIRE((rig.client.share.by_effect && rig.client.share.server_rows[0] > 0));
  turn(&rig.device->renderer, 1);
  REQUIRE(begin_frame(&rig.device->renderer, &rig.client, 0).ok);
  rig.stop_server(0);
  while (!advance_frame(&rig.device->renderer, &rig.client, ~std::uint64_t(0))) {
  }
  CHECK(rig.client.share.device_rows + rig.client.share.server_rows[0] == 72);
  rig.frame(0);
  CHECK(!rig.client.share.by_effect);
  CHECK(pixels_of(rig.client) == rig.local_pixels(0));
  rig.start_server(0);
  for (int i = 0; i < 200 && !rig.client.share.has_light; ++i)
    rig.idle(100'000'000), turn(&rig.device->renderer, 0.1f), rig.frame(0);
  CHECK(rig.client.share.has_light);
}
