// Shared frames of which device and servers trace only what may have changed.
#include <doctest/doctest.h>

#include "split_rig.h"

using namespace pocketray;

namespace {

SplitRigOptions moving_scene(std::uint32_t server_count) {
  SplitRigOptions options;
  options.scene = "seesaw";
  options.server_count = server_count;
  options.width = 64, options.height = 48;
  return options;
}

}  // namespace

// Goal: a frame that equals the last one costs nothing: no pixel, no byte on the wire; the next change is followed.
// Method: the same time again and again; another time; another exposure, which changes every displayed pixel.
TEST_CASE("client_sends_nothing_while_nothing_changes") {
  SplitRigOptions options = moving_scene(2);
  options.client.check_count = 0;
  SplitRig rig(options);
  for (int i = 0; i < 10; ++i) rig.frame(0.1 * i);
  REQUIRE(is_settled(rig.client));
  for (int round = 0; round < 3; ++round) {
    CAPTURE(round);
    const double seconds = 2 + 0.1 * round;
    CHECK(!rig.frame(seconds).unchanged);
    for (int i = 0; i < 5; ++i) {
      const FrameShare& share = rig.frame(seconds);
      CHECK(share.unchanged);
      CHECK(share.bytes_in + share.bytes_out == 0);
      CHECK(share.device_pixels == 0);
      rig.idle(30 * kMs);
    }
  }
  CHECK(rig.frame(2.2).unchanged);
  rig.device->renderer.view.exposure *= 1.5f;
  CHECK(!rig.frame(2.2).unchanged);
  CHECK(rig.frame(2.2).unchanged);
  // The device alone has rendered in between: the servers' rows of its picture are stale.
  REQUIRE(render_frame(&rig.device->renderer, 3).ok);
  CHECK(!rig.frame(2.2).unchanged);
  CHECK(rig.log.empty());
}

// Goal: device and servers trace a small part of their rows, whatever the share. Method: fixed shares; without
// coherence all of them are traced.
TEST_CASE("client_and_servers_trace_what_changes") {
  for (CoherenceMode mode : {CoherenceMode::on, CoherenceMode::off}) {
    SplitRigOptions options = moving_scene(1);
    options.coherence = mode;
    options.client.device_share = 0.5;
    SplitRig rig(options);
    for (int i = 0; i < 4; ++i) rig.frame(7 + i / 30.0);
    REQUIRE(is_settled(rig.client));
    std::uint64_t device_pixels = 0, rows = 0;
    double server_part = 0;
    for (int i = 4; i < 12; ++i) {
      const FrameShare& share = rig.frame(7 + i / 30.0);
      device_pixels += share.device_pixels, rows += share.device_rows;
      for (const RowModel& row : rig.client.plan.model.rows)
        if (row.holder == 0) server_part += static_cast<double>(row.holder_part) / share.server_rows[0] / 8;
    }
    REQUIRE(rows > 0);
    const double device_part = static_cast<double>(device_pixels) / (static_cast<double>(rows) * options.width);
    CAPTURE(device_part);
    CAPTURE(server_part);
    const bool coherent = mode == CoherenceMode::on;
    CHECK((coherent ? device_part < 0.25 : device_part == 1));
    CHECK((coherent ? server_part < 0.25 : server_part == doctest::Approx(1)));
  }
}

// Goal: rows in which nothing can have changed cost a server no pixel, and the wire a few bytes a chunk: asking only
// for the others would save no more. Method: the lowest rows of a moving scene; frames in which none of them changes.
TEST_CASE("client_receives_unchanged_rows_in_a_few_bytes") {
  SplitRigOptions options = moving_scene(1);
  options.coherence = CoherenceMode::on;
  options.client.device_share = 0.92;
  options.client.device_goes_on = false;
  options.client.check_count = 0;
  SplitRig rig(options);
  for (int i = 0; i < 10; ++i) rig.frame(i / 30.0);
  REQUIRE(is_settled(rig.client));
  int quiet = 0;
  for (int i = 10; i < 50; ++i) {
    CAPTURE(i);
    const FrameShare& share = rig.frame(i / 30.0);
    CHECK(!share.unchanged);
    REQUIRE(share.server_rows[0] > 0);
    CHECK(share.kept_rows <= share.server_rows[0]);
    CHECK(share.kept_bytes <= share.server_bytes[0]);
    if (share.kept_rows < share.server_rows[0]) continue;
    ++quiet;
    CHECK(share.kept_bytes == share.server_bytes[0]);
    CHECK(share.bytes_in + share.bytes_out < 200);
  }
  CHECK(quiet >= 10);
}

// Goal: a server that comes while frames of changes are shorter than its round trip is in use as soon as frames are
// long again, and costs nothing until then. Method: its first rows come too late for every frame of an animation; then
// the camera moves, and frames are traced whole.
TEST_CASE("client_uses_a_server_that_came_during_short_frames") {
  SplitRigOptions options = moving_scene(1);
  options.line.latency_ns = 3 * kMs;
  options.device_ns = 10000;
  SplitRig rig(options);
  rig.stop_server(0);
  double before = 0, during = 0;
  for (int i = 0; i < 60; ++i) {
    if (i == 20) rig.start_server(0);
    const FrameShare& share = rig.frame(7 + i / 300.0);
    rig.idle(10 * kMs);
    if (i >= 10 && i < 20) before += share.measured_ns;
    if (i >= 50) during += share.measured_ns;
  }
  CHECK(during <= 1.05 * before);
  REQUIRE(rig.client.servers[0].overture.phase == ServerPhase::probing);
  Camera camera = rig.device->renderer.view.camera;
  int first_used = -1;
  for (int i = 0; i < 8; ++i) {
    camera.eye.x += 0.05f;
    REQUIRE(set_camera(&rig.device->renderer, camera).ok);
    const FrameShare& share = rig.frame(7.2);
    const bool is_ready = rig.client.servers[0].overture.phase == ServerPhase::ready;
    if (first_used < 0 && is_ready && share.server_rows[0] > 0) first_used = i;
    rig.idle(10 * kMs);
  }
  CAPTURE(first_used);
  CHECK(first_used >= 0);
  CHECK(first_used <= 1);
}
