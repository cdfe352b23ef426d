// What a sweep says of rows from render servers.
#include "desktop/sweep/network/sent_frames.h"

#include <doctest/doctest.h>
#include <stdlib.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "desktop/accuracy/display.h"
#include "desktop/sweep/references.h"
#include "session/interrupt.h"

using namespace pocketray;

namespace {

AccuracyOptions small(const char* pixel_format) {
  AccuracyOptions o;
  o.common.scene = "cornell", o.common.size = "64x48", o.common.memory = "64M";
  o.common.threads = 2;
  o.output = pixel_format;
  return o;
}

Levels rendered(const Rig& rig, const Configuration& configuration) {
  const Renderer& r = rig.opened.renderer;
  return displayed_levels(r.image.data, r.settings.width, r.settings.height, display_of(r),
                          kOutputFormats[configuration.output]);
}

int largest_difference(const Levels& a, const Levels& b) {
  REQUIRE(a.rgb.size() == b.rgb.size());
  int largest = 0;
  for (std::size_t i = 0; i < a.rgb.size(); ++i) largest = std::max(largest, std::abs(a.rgb[i] - b.rgb[i]));
  return largest;
}

}  // namespace

// Goal: the judged frame is the baseline's, whatever the camera did before: shown as it is, or near-losslessly with
// some channels off by one level of the format, for fewer bytes. Method: each format; the picture before and after.
TEST_CASE("sent_frames_end_in_the_judged_picture") {
  for (const OutputFormat& output : kOutputFormats) {
    CAPTURE(std::string(output.name));
    std::unique_ptr<Rig> rig;
    REQUIRE(open_rig(small(output.name), kCornellSphereColumns, &rig).ok);
    Configuration configuration = rig->baseline;
    double ns_per_pixel;
    REQUIRE(time_frame(rig.get(), configuration, 0, &ns_per_pixel).ok);
    const Levels judged = rendered(*rig, configuration);
    SentPicture lossless, near;
    REQUIRE(send_frames(rig.get(), configuration, 0, &lossless).ok);
    CHECK(lossless.levels.rgb == judged.rgb);
    configuration.near_lossless = true;
    REQUIRE(send_frames(rig.get(), configuration, 0, &near).ok);
    CHECK(rendered(*rig, configuration).rgb == judged.rgb);        // what was traced
    const int level = output.format.bits_per_pixel == 16 ? 9 : 1;  // of 255, rounded up: 5 bits have 31
    const int difference = largest_difference(near.levels, judged);
    CHECK((difference > 0 && difference <= level));
    CHECK(near.bytes_per_frame > 0);
    CHECK(near.bytes_per_frame < 0.9 * lossless.bytes_per_frame);
    REQUIRE(time_frame(rig.get(), rig->baseline, 0, &ns_per_pixel).ok);
    CHECK(rendered(*rig, rig->baseline).rgb == judged.rgb);  // the camera is back
  }
}

// Goal: an interrupt ends the frames. Method: set before the first.
TEST_CASE("sent_frames_stop_at_an_interrupt") {
  std::unique_ptr<Rig> rig;
  REQUIRE(open_rig(small("rgb565"), kCornellSphereColumns, &rig).ok);
  SentPicture sent;
  interrupted = true;
  const Status status = send_frames(rig.get(), rig->baseline, 0, &sent);
  interrupted = false;
  CHECK(status.ok);
  CHECK(std::isnan(sent.bytes_per_frame));
}

// Goal: a sweep judges near-lossless rows by ꟻLIP beside the baseline, with the bytes of both, and leaves them out of
// the front. Method: a small sweep; after it, the same folder again, which measures nothing and says the same.
TEST_CASE("sweep_judges_near_lossless_rows") {
  char path[] = "/tmp/pocketray_XXXXXX";
  REQUIRE(mkdtemp(path) != nullptr);
  setenv("XDG_CACHE_HOME", path, 1);
  AccuracyOptions o = small("rgb565-dithered");
  o.folder = path, o.reference_samples = 8, o.rounds = 1, o.price_limit = 1;
  double bytes[2] = {};
  for (int run = 0; run < 2; ++run) {
    Sweep sweep;
    bool whole;
    SweptFront front;
    const Status status = measure_sweep(o, &sweep, &whole, &front);
    REQUIRE_MESSAGE(status.ok, status.message);
    const Measured *on = nullptr, *off = nullptr;
    for (const Measured& m : sweep.measured) {
      if (m.knob == "near-lossless") (m.value == "on" ? on : off) = &m;
      CHECK(std::isfinite(m.bytes_per_frame) == (m.is_default || m.knob == "near-lossless"));
    }
    REQUIRE((on && off));
    CHECK(off->is_default);
    CHECK_FALSE(on->is_default);
    CHECK(on->errors.rmse == off->errors.rmse);  // nothing else is traced
    CHECK(on->flip_before == off->flip_before);
    CHECK(on->model.flip > off->model.flip);
    CHECK(on->model.flip < off->model.flip + 0.05);
    CHECK(on->bytes_per_frame < 0.9 * off->bytes_per_frame);
    CHECK_FALSE(on->pareto);
    if (run == 1) CHECK(on->bytes_per_frame == bytes[0]);
    if (run == 1) CHECK(off->bytes_per_frame == bytes[1]);
    bytes[0] = on->bytes_per_frame, bytes[1] = off->bytes_per_frame;
    for (const Strip& strip : sweep.strips)
      for (const StripRow& row : strip.rows) CHECK(std::isfinite(row.bytes) == (strip.knob == "near-lossless"));
  }
  CHECK(std::system(("rm -r " + std::string(path)).c_str()) == 0);
}
