// A device without the scene: servers render every row, and others take over the rows of one that fails.
#include <doctest/doctest.h>

#include "engine/frame.h"
#include "remote/server/state.h"
#include "split_rig.h"
#include "support/effort.h"

using namespace pocketray;

namespace {

SplitRigOptions thin(std::uint32_t server_count) {
  SplitRigOptions options;
  options.server_count = server_count;
  options.client.has_scene = false;
  return options;
}

// Begins a frame and waits until some of its rows have come.
void begin_frame(SplitRig* rig, double seconds) {
  REQUIRE(begin_frame(&rig->device->renderer, &rig->client, seconds).ok);
  std::uint64_t limit = rig->now() + 1000 * kMs;
  while (rig->client.picture.merge.row_count_done == 0 && rig->now() < limit)
    advance_frame(&rig->device->renderer, &rig->client, rig->now() + kMs / 10);
  REQUIRE(rig->client.picture.merge.row_count_done > 0);
  REQUIRE(!has_all_rows(rig->client));
}

bool advance(SplitRig* rig, std::uint64_t ns) {
  return advance_frame(&rig->device->renderer, &rig->client, rig->now() + ns);
}

// Checks that the merged pixels equal those the device would have rendered.
void check_pixels(SplitRig* rig, double seconds) {
  std::vector<std::uint8_t> merged(rig->client.picture.pixels.begin(), rig->client.picture.pixels.end());
  CHECK(merged == rig->local_pixels(seconds));
}

}  // namespace

// Goal: the servers' rows equal the frame of a device with the scene, byte for byte. Method: static and moving scenes,
// with their own and a stated camera, one to three servers, both formats; the rig compares every frame.
TEST_CASE("thin_client_frames_equal_local_ones") {
  for (const char* scene : {"cornell", "seesaw"})
    for (std::uint32_t server_count : {1u, 3u})
      for (WireFormat format : {WireFormat::rgb565, WireFormat::rgb888}) {
        SplitRigOptions options = thin(server_count);
        options.scene = scene;
        options.width = effort_side(options.width), options.height = effort_side(options.height);
        options.client.format = format;
        options.client.dither = format == WireFormat::rgb565;
        SplitRig rig(options);
        CAPTURE(scene);
        CAPTURE(server_count);
        for (int i = 0; i < 4; ++i) {
          if (i == 3) {
            Camera camera = rig.device->renderer.view.camera;
            camera.eye = camera.eye * 0.9f + camera.target * 0.1f;
            REQUIRE(set_camera(&rig.device->renderer, camera).ok);
          }
          const FrameShare& share = rig.frame(0.1 * i);
          CHECK(share.device_rows == 0);
          if (i > 0)
            for (std::uint32_t s = 0; s < server_count; ++s) CHECK(share.server_rows[s] > 0);
        }
        CHECK(rig.log.empty());
      }
}

// Goal: rows are divided among servers by speed. Method: one is four times as fast as the other; frame time against
// both working to the end.
TEST_CASE("thin_client_shares_rows_by_speed") {
  SplitRigOptions options = thin(2);
  options.server_ns = {500, 2000};
  options.height = 96;
  SplitRig rig(options);
  for (int i = 0; i < 6; ++i) rig.frame(0);
  const FrameShare& share = rig.client.share;
  CHECK(share.server_rows[0] > 2 * share.server_rows[1]);
  CHECK(share.server_rows[1] > 0);
  double ideal = options.width * options.height / (1 / 500.0 + 1 / 2000.0);
  CHECK(share.measured_ns < 1.35 * ideal);
}

// Goal: no row is lost while one server is alive. Method: all but the last of two or three end during a frame.
TEST_CASE("thin_client_rows_of_a_lost_server_come_from_the_others") {
  for (std::uint32_t server_count : {2u, 3u}) {
    SplitRigOptions options = thin(server_count);
    options.server_ns = {20000};
    SplitRig rig(options);
    rig.frame(0);
    begin_frame(&rig, 0.5);
    for (std::uint32_t i = 0; i + 1 < server_count; ++i) rig.stop_server(i);
    REQUIRE(advance(&rig, 1000 * kMs));
    CHECK(rig.client.share.server_rows[server_count - 1] > rig.options.height / server_count);
    CHECK(rig.log.size() == server_count - 1);
    check_pixels(&rig, 0.5);
    rig.frame(1);
    for (std::uint32_t i = 0; i + 1 < server_count; ++i) rig.start_server(i);
    rig.idle(3000 * kMs);
    rig.frame(1.5);
    CHECK(rig.client.share.server_rows[0] > 0);
  }
}

// Goal: a stalled server delays a frame only a little: the others take its rows long before it counts as lost. Method:
// one of two stops running during a frame and continues later.
TEST_CASE("thin_client_takes_over_from_a_server_that_stands_still") {
  SplitRigOptions options = thin(2);
  options.server_ns = {20000};
  SplitRig rig(options);
  for (int i = 0; i < 3; ++i) rig.frame(0.1 * i);
  begin_frame(&rig, 0.5);
  Server* still = rig.world.servers[0];
  rig.world.servers[0] = nullptr;
  std::uint64_t begin = rig.now();
  bool complete = advance(&rig, 1000 * kMs);
  std::uint64_t took = rig.now() - begin;
  rig.world.servers[0] = still;
  REQUIRE(complete);
  CHECK(took < 300 * kMs);  // silence would be noticed after 3 s
  CHECK(rig.log.empty());
  check_pixels(&rig, 0.5);
  for (int i = 0; i < 3; ++i) rig.frame(0.1 * i);
}

// Goal: without any server the frame waits and reports it; it then continues where it stopped.
TEST_CASE("thin_client_waits_for_servers_to_come_back") {
  SplitRigOptions options = thin(1);
  options.server_ns = {20000};
  SplitRig rig(options);
  rig.frame(0);
  begin_frame(&rig, 0.5);
  rig.stop_server(0);
  CHECK(!advance(&rig, 1000 * kMs));
  CHECK(!is_cut_off(rig.client));
  CHECK(!advance(&rig, 6000 * kMs));
  CHECK(is_cut_off(rig.client));
  CHECK(rig.log.size() == 1);
  rig.start_server(0);
  REQUIRE(advance(&rig, 60'000 * kMs));
  CHECK(!is_cut_off(rig.client));
  CHECK(rig.logged("in use again"));
  check_pixels(&rig, 0.5);
}
