// The viewer with and without servers in reach.
#include <doctest/doctest.h>

#include <atomic>
#include <thread>

#include "base/seal.h"
#include "desktop/split_report/virtual_world.h"
#include "platform/net/tcp.h"
#include "remote/client/servers.h"
#include "session/open_scene.h"
#include "support/scripted_client.h"
#include "viewer/viewer.h"

using namespace pocketray;

namespace {

// Views frames of a moving scene on the null screen.
ServersTotals view(const std::string& server, std::uint32_t frame_count, Viewer* viewer) {
  CommonOptions common;
  common.scene = "seesaw", common.size = "32x24", common.threads = 1;
  ServersOptions servers;
  servers.addresses = {server};
  ViewOptions options;
  options.backend = "null", options.rotation = 0, options.frame_count = frame_count;
  REQUIRE(open_viewer(options, "seesaw", 32, 24, viewer).ok);
  REQUIRE(kRenderServers.open(servers, nullptr, &viewer->servers).ok);
  OpenScene opened;
  REQUIRE(open_scene_with(viewer->servers, common, viewer_bytes, &opened).ok);
  REQUIRE(kRenderServers.start(viewer->servers, &opened.renderer, false, false).ok);
  bool again;
  REQUIRE(run_viewer(viewer, &opened.renderer, &again).ok);
  ServersTotals totals = kRenderServers.totals(*viewer->servers);
  kRenderServers.close(viewer->servers);
  close_viewer(viewer);
  return totals;
}

}  // namespace

// Goal: without a server in reach pictures are refined as usual, and a server that comes into reach takes its share
// from then on. Method: a port without a listener; a server on its own thread, and frames until it has taken part.
TEST_CASE("view_shares_its_pictures_while_servers_are_in_reach") {
  ServerRig rig(ServerOptions(), platform::NullLinkSettings(), platform::kTcpLink);
  std::string address = server_address(*rig.server);
  std::atomic<bool> stop{false};
  std::thread serving([&] {
    while (!stop) step_server(rig.server, kMs);
  });
  Viewer with;
  ServersTotals shared;
  std::uint32_t frame_count = 600;
  for (; shared.server_rows == 0 && frame_count < 600'000; frame_count *= 4) {  // a busy server takes longer
    with = Viewer();
    shared = view(address, frame_count, &with);
    CHECK(with.frames_finished == frame_count);
    CHECK(shared.frames <= frame_count);
  }
  stop = true;
  serving.join();
  unseal_memory();  // the rig's log seals
  CHECK(with.picture_merged);
  CHECK(shared.frames > 0);
  CHECK(shared.server_rows > 0);

  rig.close();
  Viewer without;
  ServersTotals alone = view(address, 20, &without);
  CHECK(without.frames_finished == 20);
  CHECK_FALSE(without.picture_merged);
  CHECK(alone.frames == 0);
}

// Goal: a slow device does not finish its first picture alone if a server comes into reach: both finish it. Method: an
// emulated device and its server on a virtual clock, null screen. Pixels refined before take few milliseconds of
// wall-clock time; each finished picture is a split one.
TEST_CASE("view_leaves_its_first_picture_to_servers") {
  VirtualWorld world;
  REQUIRE(open_world(platform::NullLinkSettings(), builtin_store(), 1, &world).ok);
  ServerOptions server;
  server.client_memory_bytes = 16u << 20;
  REQUIRE(start_server(&world, 0, server).ok);
  auto servers = std::make_unique<ConnectedServers>();
  servers->link = world.link;
  servers->addresses = world.addresses;

  CommonOptions common;
  common.scene = "seesaw", common.size = "128x128", common.threads = 1;
  ViewOptions options;
  options.backend = "null", options.rotation = 0, options.frame_count = 3;
  Viewer viewer;
  REQUIRE(open_viewer(options, "seesaw", 128, 128, &viewer).ok);
  viewer.servers = servers.get();
  OpenScene opened;
  REQUIRE(open_scene_with(servers.get(), common, viewer_bytes, &opened).ok);
  opened.renderer.pace.ns_per_pixel = 5e8 / 16;  // a picture alone takes eight minutes
  REQUIRE(kRenderServers.start(servers.get(), &opened.renderer, false, false).ok);
  opened.renderer.pace.ns_per_pixel = 3e6 / 16;
  std::uint64_t begin = world_now_ns(world);
  bool again;
  REQUIRE(run_viewer(&viewer, &opened.renderer, &again).ok);
  ServersTotals totals = kRenderServers.totals(*servers);
  CHECK(viewer.frames_finished == 3);
  CHECK(totals.frames == 3);
  CHECK(totals.server_rows > totals.device_rows);
  CHECK(world_now_ns(world) - begin < 512'000 * kMs);  // three pictures in less than the time of one
  close_client(&servers->client);
  close_viewer(&viewer);
}
