// What a frame takes before its first pixel: on the device, which poses the scene and refits its accelerator, and on
// servers, which do the same.
#include <doctest/doctest.h>

#include <cmath>

#include "remote/client/frame.h"
#include "split_rig.h"
#include "support/effort.h"

using namespace pocketray;

namespace {

constexpr double kMillisecond = 1e6, kFrameSeconds = 0.04;

SplitRigOptions moving_scene(double device_ns, double device_prepare_ms) {
  SplitRigOptions options;
  options.scene = "seesaw";
  options.device_ns = device_ns;
  options.device_prepare_ns = device_prepare_ms * kMillisecond;
  options.coherence = CoherenceMode::off;
  options.line.latency_ns = 500'000, options.line.bytes_per_second = 2'000'000;
  options.client.check_count = 0;
  return options;
}

// Renders frames of an animation until the split has settled.
double settle(SplitRig* rig, int count = 16) {
  double seconds = 0;
  for (int i = 0; i < count; ++i) rig->frame(seconds += kFrameSeconds);
  return seconds;
}

}  // namespace

// Goal: servers work while the device prepares. Method: frames of a moving scene of which the device renders some rows;
// when their requests left, their time against the prediction, and against that of a device that need not prepare.
// Where nothing moves, the device prepares first, which counts, too.
TEST_CASE("preparation_begins_once_rows_are_requested") {
  double times[2];
  for (int prepare_ms : {0, 1}) {
    CAPTURE(prepare_ms);
    SplitRigOptions options = moving_scene(3000, prepare_ms);
    SplitRig rig(options);
    double seconds = settle(&rig);
    const FrameShare& share = rig.frame(seconds += kFrameSeconds);
    CHECK((share.device_rows > 0 && share.device_rows < options.height / 2));
    CHECK(rig.client.frame.prepared);
    CHECK(static_cast<double>(rig.client.servers[0].rows.frame.asked_ns - rig.client.frame.begin_ns) <
          0.01 * kMillisecond);
    CHECK(std::fabs(share.predicted_ns - share.measured_ns) < 0.1 * share.measured_ns);
    times[prepare_ms] = share.measured_ns;
  }
  CHECK(times[1] < times[0] + 0.5 * kMillisecond);
  SplitRigOptions still = moving_scene(1000, 1);
  still.scene = "cornell";
  SplitRig rig(still);
  const double seconds = settle(&rig);
  const std::uint64_t begin_ns = rig.now();
  const double measured_ns = rig.frame(seconds).measured_ns;  // from the first moment to the last
  CHECK(std::fabs(static_cast<double>(rig.now() - begin_ns) - measured_ns) < 0.1 * kMillisecond);
  CHECK(static_cast<double>(rig.client.servers[0].rows.frame.asked_ns - rig.client.frame.begin_ns) >= 1 * kMillisecond);
}

// Goal: a device that renders no row prepares nothing, and takes no time for it; once it must render or check, it
// prepares, and the pixels are right. Method: a device that prepares for longer than its server takes for the frame;
// then with spot checks, and with a server that stops.
TEST_CASE("preparation_is_left_out_where_servers_render_all") {
  constexpr double kPrepareMs = 200;
  SplitRig rig(moving_scene(1e5, kPrepareMs));
  double seconds = settle(&rig);
  for (int i = 0; i < 4; ++i) {
    const FrameShare& share = rig.frame(seconds += kFrameSeconds);
    CHECK(!rig.client.frame.prepared);
    CHECK(share.device_rows == 0);
    CHECK(share.measured_ns < 0.1 * kPrepareMs * kMillisecond);
    CHECK(std::fabs(share.predicted_ns - share.measured_ns) < 0.1 * share.measured_ns);
    CHECK(share.local_ns > kPrepareMs * kMillisecond);
  }
  CHECK(static_cast<double>(rig.client.plan.model.device_start_ns.value) == doctest::Approx(kPrepareMs * kMillisecond));

  rig.client.verifier.check_count = 2;
  CHECK(rig.frame(seconds += kFrameSeconds).checked[0] == 2);
  CHECK(rig.client.frame.prepared);
  CHECK(rig.client.share.device_rows == 0);
  rig.client.verifier.check_count = 0;
  rig.frame(seconds += kFrameSeconds);
  CHECK(!rig.client.frame.prepared);

  rig.stop_server(0);
  CHECK(rig.frame(seconds += kFrameSeconds).device_rows == rig.options.height);
  CHECK(rig.client.frame.prepared);
}

// Goal: what preparation takes counts towards the 1 % of the time that automatic checks may take. Method: frames of
// such a device with automatic checks; the time of those that prepared over the time of all.
TEST_CASE("preparation_for_checks_takes_a_hundredth") {
  SplitRigOptions options = moving_scene(1e5, 20);
  options.client.check_count = kCheckCountAuto;
  options.compares = false;
  SplitRig rig(options);
  double seconds = settle(&rig), all = 0, prepared = 0, checks = 0;
  for (int i = 0; i < effort(2000); ++i) {
    const FrameShare& share = rig.frame(seconds += kFrameSeconds);
    all += share.measured_ns;
    prepared += rig.client.frame.prepared ? 20 * kMillisecond : 0;
    checks += share.checked[0];
  }
  CHECK(prepared < 0.02 * all + 20 * kMillisecond);
  if (effort(2000) == 2000) CHECK(checks > 0);
}

// Goal: frames that do not change are still recognised, and cost no message. Method: an animation that stands still
// between two moving parts, with coherence.
TEST_CASE("preparation_comes_first_where_nothing_changes") {
  SplitRigOptions options = moving_scene(1000, 1);
  options.coherence = CoherenceMode::on;
  SplitRig rig(options);
  const double seconds = settle(&rig);
  rig.frame(seconds);
  CHECK(rig.client.share.unchanged);
  CHECK(rig.frame(seconds).bytes_out == 0);
  CHECK(!rig.frame(seconds + kFrameSeconds).unchanged);
  CHECK(!rig.frame(seconds + 2 * kFrameSeconds).unchanged);
  CHECK(rig.client.share.bytes_out > 0);
}

// Goal: a picture that only servers rendered never counts as the one that the device kept. Method: a frame that the
// device keeps, one of another camera that it does not prepare, then the first again, for which the device prepares
// before it asks, since only the camera moved.
TEST_CASE("preparation_left_out_keeps_no_picture") {
  SplitRigOptions options = moving_scene(20'000, 0);
  options.coherence = CoherenceMode::on;
  options.client.device_share = 0.5;
  SplitRig rig(options);
  Renderer* renderer = &rig.device->renderer;
  const double duration = renderer->scene.animations[0].duration;
  const Camera camera = renderer->view.camera;
  Camera moved = camera;
  moved.eye = 1.1f * camera.eye;
  REQUIRE(set_camera(renderer, camera).ok);
  const double seconds = settle(&rig, 40);
  REQUIRE((rig.client.frame.joined && rig.client.frame.prepared));
  REQUIRE(set_camera(renderer, moved).ok);
  rig.client.options.device_share = 0;  // servers render all
  rig.client.options.device_goes_on = false;
  rig.frame(seconds + kFrameSeconds);
  rig.frame(seconds + duration);
  CHECK(!rig.client.frame.prepared);
  REQUIRE(set_camera(renderer, camera).ok);
  CHECK(!rig.frame(seconds + duration).unchanged);  // and its pixels are right
  CHECK(rig.client.frame.prepared);
}

// Goal: the model's start of each server includes its preparation, also where several share a link, whether it keeps up
// with them or not. Method: servers that prepare for 3 ms behind a latency of half a millisecond each way.
TEST_CASE("preparation_of_servers_is_in_their_start") {
  struct Case {
    std::uint32_t count;
    std::uint64_t bytes_per_second;
  };
  for (const Case& one : {Case{1, 0}, Case{2, 0}, Case{3, 0}, Case{2, 500'000}}) {
    const std::uint32_t count = one.count;
    const std::uint64_t bytes_per_second = one.bytes_per_second;
    if (kEffortDivisor > 6 && count != 2) continue;
    CAPTURE(count);
    CAPTURE(bytes_per_second);
    SplitRigOptions options = moving_scene(1e4, 1);
    options.server_ns = {1000};
    options.server_count = count;
    options.server_prepare_ns = 3 * kMillisecond;
    if (bytes_per_second > 0)
      options.width = 160, options.height = 120, options.server_ns = {100},
      options.line.bytes_per_second = bytes_per_second;
    SplitRig rig(options);
    double seconds = settle(&rig, 40);
    for (std::uint32_t i = 0; i < count; ++i) {
      CAPTURE(i);
      const double start_ns = static_cast<double>(rig.client.plan.model.servers[i].start_ns.value);
      CHECK(start_ns == doctest::Approx(4 * kMillisecond).epsilon(0.3));
    }
    const FrameShare& share = rig.frame(seconds += kFrameSeconds);
    CHECK(std::fabs(share.predicted_ns - share.measured_ns) < 0.1 * share.measured_ns);
  }
}
