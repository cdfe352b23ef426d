// Very slow servers and devices do not count as lost.
#include <doctest/doctest.h>

#include <algorithm>

#include "remote/server/state.h"
#include "split_rig.h"

using namespace pocketray;

// Goal: a live server never counts as lost, however long a row takes on either side. Method: rows of 10 s on either
// side or on both, far beyond the silence after which a server counts as lost.
TEST_CASE("client_keeps_servers_whose_rows_take_long") {
  constexpr double kDearNs = 10e9 / 32, kCheapNs = 1e5;  // per pixel
  const double times[][2] = {{kDearNs, kDearNs}, {kDearNs, kCheapNs}, {kCheapNs, kDearNs}};
  for (const double(&time)[2] : times) {
    double device_ns = time[0], server_ns = time[1];
    SplitRigOptions options;
    options.scene = "cube";
    options.width = 32, options.height = 4;
    options.server_count = 2;
    options.device_ns = device_ns;
    options.server_ns = {server_ns};
    SplitRig rig(options);
    CAPTURE(device_ns);
    CAPTURE(server_ns);
    std::uint32_t rows = 0;
    for (int i = 0; i < 5; ++i) {
      const FrameShare& share = rig.frame(0.1 * i);
      if (i >= 2) rows += share.server_rows[0];
    }
    CHECK_MESSAGE(rig.log.empty(), rig.log.front());
    if (server_ns <= device_ns) CHECK(is_settled(rig.client));
    if (server_ns <= device_ns) CHECK(rows > 0);
  }
}

// Goal: a server polls its clients often and answers them, whatever a pixel costs. Method: 0.3 s per pixel; the longest
// uninterrupted work, including the first, is a few pixels.
TEST_CASE("server_looks_up_often_whatever_a_pixel_costs") {
  constexpr std::uint64_t kPixelNs = 300 * kMs;
  ServerOptions options;
  options.pace.ns_per_pixel = static_cast<double>(kPixelNs);
  ServerRig rig(options);
  ScriptedClient client(&rig);
  client.request(frame_request("cube", 1, 32, 2));
  std::uint64_t longest_ns = 0, later_ns = 0;
  rig.run_until(
      [&] {
        const Work& work = rig.server->work;
        std::uint64_t took = work.session < 0 ? 0 : work.end_ns - work.begin_ns;
        longest_ns = std::max(longest_ns, took);
        if (rig.server->sessions[0].trace_ns > 0) later_ns = std::max(later_ns, took);
        client.poll();
        return client.rows_come == 2;
      },
      60'000 * kMs);
  CHECK(longest_ns <= 8 * kPixelNs);
  CHECK(later_ns <= 2 * kPixelNs);
}
