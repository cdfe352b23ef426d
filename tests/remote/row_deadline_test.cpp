// Deadlines within a row of a frame that is shared with a server.
#include <doctest/doctest.h>

#include <algorithm>

#include "engine/frame.h"
#include "split_rig.h"

using namespace pocketray;

namespace {

constexpr Vec3 kUntraced = {-1, -2, -3};
constexpr double kDeviceNs =
    20e6;  // per pixel: a row takes 1.28 s, longer than the time between polls: it is rendered in parts

SplitRigOptions slow_device(CoherenceMode coherence) {
  SplitRigOptions options;
  options.height = 24;
  options.device_ns = kDeviceNs;
  options.server_ns = {10e6};
  options.coherence = coherence;
  options.client.check_count = 0;  // spot checks trace pixels of the server's rows
  return options;
}

// A frame in slices, each with a deadline of a third of a row.
struct Slices {
  SplitRig* rig;
  bool counts = false;  // counts how often each pixel is traced; spoils the picture
  std::vector<int> traced;
  std::uint32_t within_row = 0;  // deadlines that fell within a row

  void begin(double seconds) {
    traced.assign(rig->device->renderer.image.count, 0);
    REQUIRE(begin_frame(&rig->device->renderer, &rig->client, seconds).ok);
  }

  bool advance() {
    Array<Vec3>& image = rig->device->renderer.image;
    if (counts) std::fill(image.begin(), image.end(), kUntraced);
    const std::uint64_t deadline_ns = rig->now() + std::uint64_t(kDeviceNs) * rig->options.width / 3;
    const bool complete = advance_frame(&rig->device->renderer, &rig->client, deadline_ns, nullptr);
    // The last part may begin just before the deadline.
    CHECK(rig->now() <= deadline_ns + work_ns_max(rig->client) + std::uint64_t(kDeviceNs));
    for (std::size_t i = 0; counts && i < image.count; ++i) traced[i] += !(image[i] == kUntraced);
    within_row += is_within_row();
    return complete;
  }

  bool is_within_row() const {
    const DeviceRow& row = rig->client.frame.device_row;
    return !rig->client.frame.complete && row.in_parts && row.columns_done > 0;
  }

  // False: the frame was not complete in time.
  bool finish() {
    for (int i = 0; i < 10'000; ++i)
      if (advance()) return true;
    return false;
  }

  void check(double seconds) {
    const std::uint32_t width = rig->options.width;
    if (!counts) {
      std::vector<std::uint8_t> merged(rig->client.picture.pixels.begin(), rig->client.picture.pixels.end());
      CHECK(merged == rig->local_pixels(seconds));
      return;
    }
    for (std::size_t i = 0; i < traced.size(); ++i) {
      const bool is_devices = rig->client.picture.merge.rows[i / width].state == RowState::device;
      CAPTURE(i);
      CHECK(traced[i] <= 1);
      if (is_devices && rig->options.coherence == CoherenceMode::off) CHECK(traced[i] == 1);
    }
  }
};

}  // namespace

// Goal: a deadline within a row that the device renders in parts ends the call in time; the next call continues the
// row, which is neither lost nor traced twice. Method: a virtual clock, slices of a third of a row; the merged frames
// equal the device's own. In a second run the image is cleared between slices, to count how often each pixel is traced.
TEST_CASE("row_deadline_continues_a_shared_row") {
  for (CoherenceMode coherence : {CoherenceMode::off, CoherenceMode::automatic})
    for (bool counts : {false, true}) {
      CAPTURE(counts);
      CAPTURE(coherence == CoherenceMode::off);
      SplitRig rig(slow_device(coherence));
      Slices slices = {&rig, counts};
      for (int i = 0; i < 6; ++i) {
        slices.begin(0.1 * i);
        REQUIRE(slices.finish());
        slices.check(0.1 * i);
      }
      CHECK(slices.within_row > 0);
      if (coherence == CoherenceMode::off) {
        CHECK(rig.client.share.server_rows[0] > 0);
        CHECK(rig.client.share.device_rows > 0);
      }
    }
}

// Goal: the frame after one that was given up within a row is right, and begins with no part of the old row. Method: as
// above; every frame is given up at the first deadline within a row, and the next one has another camera.
TEST_CASE("row_deadline_gives_up_a_shared_row") {
  for (CoherenceMode coherence : {CoherenceMode::off, CoherenceMode::automatic})
    for (bool counts : {false, true}) {
      CAPTURE(counts);
      CAPTURE(coherence == CoherenceMode::off);
      SplitRig rig(slow_device(coherence));
      Slices slices = {&rig, counts};
      slices.begin(0);
      REQUIRE(slices.finish());
      for (int i = 1; i < 5; ++i) {
        Camera camera = rig.device->renderer.view.camera;
        camera.eye = camera.eye * 0.9f + camera.target * 0.1f;
        REQUIRE(set_camera(&rig.device->renderer, camera).ok);
        slices.begin(0);
        while (!slices.advance() && !slices.is_within_row()) continue;
        CHECK(slices.is_within_row());
        camera.eye = camera.eye * 0.9f + camera.target * 0.1f;
        REQUIRE(set_camera(&rig.device->renderer, camera).ok);
        slices.begin(0);
        REQUIRE(slices.finish());
        slices.check(0);
      }
    }
}
