// Measuring the link to a server that returns.
#include <doctest/doctest.h>

#include <cmath>
#include <cstdio>

#include "split_rig.h"
#include "support/effort.h"

using namespace pocketray;

namespace {

constexpr double kNsPerByte = 2105;  // a radio of 475 kB/s
constexpr int kFrames = 24;          // after a return

// Turns the camera, so that rows take bytes.
void next_frame(SplitRig* rig, int frame) {
  Camera camera = rig->built->scene.cameras[0];
  double angle = 0.02 * (frame % 20 + 1);
  Vec3 arm = camera.eye - camera.target;
  auto c = static_cast<float>(std::cos(angle)), s = static_cast<float>(std::sin(angle));
  camera.eye = camera.target + Vec3{c * arm.x + s * arm.z, arm.y, c * arm.z - s * arm.x};
  camera.node = kNone;
  REQUIRE(set_camera(&rig->device->renderer, camera).ok);
  rig->frame(0);
}

double known_ns_per_byte(const SplitRig& rig, std::uint32_t server) {
  return static_cast<double>(rig.client.plan.model.servers[server].ns_per_byte.value);
}

}  // namespace

// Goal: a returning server's link is measured again, whatever the device and other servers do, and it gets its share of
// rows. Method: one to three servers behind a radio of known speed; one ends and returns while frames go on, on devices
// that poll rarely and often; each server's figure relative to the truth.
TEST_CASE("client_measures_the_link_of_a_server_that_is_back") {
  struct Case {
    std::uint32_t server_count, width;
    double device_ns, server_ns;
  };
  const Case cases[] = {{1, 64, 8841, 989}, {3, 64, 8841, 989}, {3, 32, 200e3, 20e3}};
  for (const Case& c : cases) {
    if (kEffortDivisor > 1 && &c != &cases[1]) continue;
    CAPTURE(c.server_count);
    CAPTURE(c.device_ns);
    SplitRigOptions options;
    options.server_count = c.server_count;
    options.width = c.width, options.height = 96;
    options.device_ns = c.device_ns;
    options.server_ns = {c.server_ns};
    options.compares = false;
    options.line.bytes_per_second = static_cast<std::uint64_t>(1e9 / kNsPerByte);
    options.line.latency_ns = 1'500'000, options.line.jitter_ns = 500'000;
    SplitRig rig(options);
    int frame = 0;
    for (int i = 0; i < 12; ++i) next_frame(&rig, frame++);
    for (int round = 0; round < 2; ++round) {
      rig.stop_server(0);
      for (int i = 0; i < 6; ++i) next_frame(&rig, frame++);
      rig.start_server(0);
      rig.idle(10 * kMs);
      std::uint64_t limit = rig.now() + 40'000 * kMs;
      while (rig.client.servers[0].overture.phase != ServerPhase::ready && rig.now() < limit) next_frame(&rig, frame++);
      REQUIRE(rig.client.servers[0].overture.phase == ServerPhase::ready);
      for (int i = 0; i < kFrames; ++i) next_frame(&rig, frame++);
      std::printf("%u servers, %.0f ns per pixel here, %.0f there: of %.0f ns per byte", c.server_count, c.device_ns,
                  c.server_ns, kNsPerByte);
      for (std::uint32_t s = 0; s < c.server_count; ++s) {
        CAPTURE(s);
        std::printf(" %.0f", known_ns_per_byte(rig, s));
        CHECK(known_ns_per_byte(rig, s) > 0.9 * kNsPerByte);
        CHECK(known_ns_per_byte(rig, s) < 1.1 * kNsPerByte);
        CHECK(rig.client.share.server_rows[s] > 0);
      }
      std::printf("\n");
    }
  }
}
