// Measuring link and servers when the device's rows are slow and it rarely polls.
#include <doctest/doctest.h>

#include "remote/client/parts.h"
#include "split_rig.h"
#include "support/effort.h"

using namespace pocketray;

namespace {

constexpr double kNsPerByte = 5000, kLatencyNs = 500'000;

// A row takes the device 64 ms.
SplitRigOptions slow_link() {
  SplitRigOptions options;
  options.height = 240;
  options.device_ns = 1e6;
  options.server_ns = {3500};
  options.server_count = 3;
  options.compares = false;
  options.line.bytes_per_second = static_cast<std::uint64_t>(1e9 / kNsPerByte);
  options.line.latency_ns = static_cast<std::uint64_t>(kLatencyNs);
  return options;
}

// The tablet of Aranha et al. 2007 and its radio.
SplitRigOptions tablet() {
  SplitRigOptions options;
  options.width = 160, options.height = 120;
  options.device_ns = 8841, options.server_ns = {989};
  options.compares = false;
  options.line.bytes_per_second = 2'375'000;
  options.line.latency_ns = 1'000'000;
  return options;
}
constexpr double kTabletNsPerByte = 421, kTooLongNs = 60'000'000;

}  // namespace

// Goal: several servers behind one slow radio are each measured as if alone, whatever the device does. Method: figures
// of the overture, and then of frames, against the known speed of the line.
TEST_CASE("client_measures_a_slow_link_that_servers_share") {
  SplitRig rig(slow_link());
  for (int i = 0; i < 6; ++i) {
    rig.frame(0.1 * i);
    CAPTURE(i);
    CHECK(is_settled(rig.client));
    const CostModel& model = rig.client.plan.model;
    CHECK(static_cast<double>(model.link_ns_per_byte.value) > 0.9 * kNsPerByte);
    CHECK(static_cast<double>(model.link_ns_per_byte.value) < 1.6 * kNsPerByte);
    for (std::uint32_t s = 0; s < 3; ++s)
      CHECK(static_cast<double>(model.servers[s].ns_per_byte.value) < 1.6 * kNsPerByte);
  }
  CHECK(rig.client.share.device_rows == 0);
}

// Goal: while the device renders all rows and polls once per row, a row's time does not count as a server's answer
// time. Method: frames without servers' rows, with only pings.
TEST_CASE("client_start_is_measured_while_the_device_is_at_work") {
  SplitRig rig(slow_link());
  for (int i = 0; i < 3; ++i) rig.frame(0.1 * i);
  rig.client.options.device_share = 1;
  for (int i = 0; i < 12; ++i) rig.frame(0.3 + 0.1 * i);
  for (std::uint32_t s = 0; s < 3; ++s)
    CHECK(static_cast<double>(rig.client.plan.model.servers[s].start_ns.value) < 8 * kLatencyNs);
  rig.client.options.device_share = -1;
  CHECK(rig.frame(2).device_rows == 0);
}

// Goal: an answer time that was seen late in the overture does not stay: the first rows of a frame show that the server
// starts sooner. Method: a start set far too high.
TEST_CASE("client_start_is_bounded_by_the_first_rows") {
  SplitRig rig(tablet());
  for (int i = 0; i < 4; ++i) rig.frame(0.1 * i);
  RemoteServer* server = &rig.client.servers[0];
  REQUIRE(server->overture.phase == ServerPhase::ready);
  Smoothed* start = &rig.client.plan.model.servers[0].start_ns;
  *start = Smoothed(), start->value = static_cast<float>(kTooLongNs);
  server->link.round_trip_ns = kTooLongNs;
  for (int i = 4; i < 10; ++i) rig.frame(0.1 * i);
  CHECK(static_cast<double>(start->value) < kTooLongNs / 3);
  CHECK(static_cast<double>(start->value) > 2e6);
  CHECK(server->link.round_trip_ns < kTooLongNs / 2);
}

// Goal: of two servers that start alike, the one whose answers once came sooner does not get more rows for it, where
// the link keeps up. Method: a start set far too low.
TEST_CASE("client_start_is_bounded_by_the_last_rows") {
  SplitRigOptions options = tablet();
  options.server_count = 2;
  SplitRig rig(options);
  for (int i = 0; i < 12; ++i) rig.frame(0.1 * i);
  REQUIRE(is_settled(rig.client));
  const Smoothed* other = &rig.client.plan.model.servers[0].start_ns;
  Smoothed* start = &rig.client.plan.model.servers[1].start_ns;
  *start = Smoothed(), start->value = 1e5f;
  for (int i = 12; i < 24; ++i) rig.frame(0.1 * i);
  CHECK(static_cast<double>(start->value) > 0.7 * static_cast<double>(other->value));
  CHECK(static_cast<double>(start->value) < 1.5 * static_cast<double>(other->value));
}

// Goal: a link measured again is not taken for one without limits because an answer without payload once took longer
// than one with. Method: a round trip set far too high before the measurement.
TEST_CASE("client_link_measured_again_keeps_its_limits") {
  SplitRig rig(tablet());
  for (int i = 0; i < 4; ++i) rig.frame(0.1 * i);
  RemoteServer* server = &rig.client.servers[0];
  REQUIRE(server->overture.phase == ServerPhase::ready);
  for (int round = 0; round < 4; ++round) {
    server->link.round_trip_ns = kTooLongNs, server->link.scaled = kUnsound;
    for (int i = 0; i < 12; ++i) {
      rig.frame(1 + round + 0.02 * i);
      const double ns_per_byte = static_cast<double>(rig.client.plan.model.servers[0].ns_per_byte.value);
      REQUIRE(ns_per_byte > kTabletNsPerByte / 2);
      REQUIRE(ns_per_byte < 3 * kTabletNsPerByte);
      rig.idle(500'000'000);
    }
  }
}

// Goal: that servers start and end apart is not taken for a slow link. Method: three servers on one radio with
// jitter, which take long to code their rows; what the device believes of each link after every frame.
TEST_CASE("slow_link_is_not_what_servers_do_one_after_another") {
  constexpr std::uint64_t kBytesPerSecond = 475'000;
  double worst = 0;
  for (int run = 0; run < effort(12); ++run) {
    SplitRigOptions options;
    options.scene = "statue", options.width = 64, options.height = 240;
    options.server_count = 3, options.server_ns = {3000.0 + 200 * run}, options.device_ns = 16000;
    options.line.bytes_per_second = kBytesPerSecond;
    options.line.latency_ns = 1'500'000, options.line.jitter_ns = 1'000'000;
    options.encode = {45, 800};
    options.client.check_count = 0;
    options.compares = false;
    SplitRig rig(options);
    const Camera home = rig.device->renderer.view.camera;
    for (int frame = 0; frame < 40; ++frame) {
      Camera camera = home;
      camera.eye = home.eye + 0.01f * static_cast<float>(frame % 10) * cross(home.target - home.eye, home.up);
      REQUIRE(set_camera(&rig.device->renderer, camera).ok);
      rig.frame(0);
      for (const ServerModel& server : rig.client.plan.model.servers)
        worst = std::max(worst, static_cast<double>(server.ns_per_byte.value));
    }
  }
  CHECK(worst < 1.3e9 / kBytesPerSecond);
}

// Goal: a device that finds its servers' link slow assumes only now and then that it is faster, and takes that back.
// Method: three servers on one link that bounds the split; trials once the split has settled, and what is left of them.
TEST_CASE("slow_link_is_rarely_assumed_to_be_faster") {
  if (kEffortDivisor > 6) {
    MESSAGE("skipped: a million pixels take a minute under emulation");
    return;
  }
  constexpr std::uint64_t kBytesPerSecond = 300'000;
  SplitRigOptions options;
  options.width = 64, options.height = 96;
  options.server_count = 3, options.server_ns = {300}, options.device_ns = 8000;
  options.line.bytes_per_second = kBytesPerSecond;
  options.client.check_count = 0;
  options.compares = false;
  SplitRig rig(options);
  Renderer* renderer = &rig.device->renderer;
  std::uint32_t trials = 0, limited = 0;
  double fastest = 1e9;
  for (std::uint32_t frame = 0; frame < 160; ++frame) {
    Camera camera = renderer->view.camera;
    camera.eye = camera.eye + 0.005f * cross(camera.target - camera.eye, camera.up);
    REQUIRE(set_camera(renderer, camera).ok);
    rig.frame(0);
    if (frame < 96) continue;
    limited += rig.client.plan.link_trial.limited;
    trials += rig.client.plan.link_trial.before > 0;
    fastest = std::min(fastest, static_cast<double>(rig.client.plan.model.link_ns_per_byte.value));
  }
  CHECK(limited >= 60);
  CHECK(trials <= 12);
  CHECK(fastest > 0.88e9 / kBytesPerSecond);
}
