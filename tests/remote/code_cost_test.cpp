// What coding rows costs: emulated devices and servers take that time, and frames are planned by it.
#include <doctest/doctest.h>

#include <algorithm>

#include "remote/client/parts.h"
#include "split_rig.h"
#include "support/effort.h"

using namespace pocketray;

namespace {

SplitRigOptions moving_scene() {
  SplitRigOptions o;
  o.scene = "seesaw";
  o.coherence = CoherenceMode::off;
  o.line.bytes_per_second = 2'000'000;  // slow enough that rows are coded
  return o;
}

// Times are virtual: real CPUs tell as much.
bool too_slow() {
  if (kEffortDivisor > 6) MESSAGE("skipped: it takes a minute under emulation");
  return kEffortDivisor > 6;
}

// Means over frames after the first ones.
struct Mean {
  double ms = 0, device_rows = 0;
};
Mean mean_of(SplitRig* rig) {
  for (int i = 0; i < 8; ++i) rig->frame(0.04 * i);
  Mean mean;
  for (int i = 8; i < 16; ++i) {
    const FrameShare& share = rig->frame(0.04 * i);
    mean.ms += share.measured_ns * 1e-6 / 8, mean.device_rows += share.device_rows / 8.0;
  }
  return mean;
}

}  // namespace

// Goal: decoding and coding take an emulated device and server their time. Method: the servers' rows alone, with costs
// of pixels that exceed all others.
TEST_CASE("code_cost_is_taken") {
  if (too_slow()) return;
  SplitRigOptions o = moving_scene();
  o.client.device_share = 0, o.client.device_goes_on = false;
  SplitRig free(o);
  const double free_ms = mean_of(&free).ms, pixels = 64 * 48;
  o.client.decode = {20'000, 0};
  SplitRig decodes(o);
  CHECK(mean_of(&decodes).ms > pixels * 20'000e-6);
  CHECK(mean_of(&decodes).ms < pixels * 20'000e-6 + free_ms + 1);
  o.client.decode = {20'000, 10'000};
  SplitRig decodes_code(o);
  CHECK(mean_of(&decodes_code).ms > pixels * 20'000e-6 + 1);
  o.client.decode = CodeCost();
  o.encode = {20'000, 0};
  SplitRig codes(o);
  const double ms = mean_of(&codes).ms;
  // The last rows leave when they are traced; those before have been coded.
  CHECK(ms > 0.6 * pixels * 20'000e-6);
  CHECK(ms < pixels * 20'000e-6 + free_ms);
}

// Goal: a device that must decode the servers' rows takes none of theirs that would keep it from that. Method: a row of
// the device takes a part of the servers' frame, and decoding what is left of it and more.
TEST_CASE("code_cost_leaves_rows_to_servers") {
  if (too_slow()) return;
  SplitRigOptions o = moving_scene();
  o.server_ns = {10'000}, o.device_ns = 500'000;
  o.client.decode = {8'000, 0};  // 31 ms a frame, 32 ms a row of the device, 25 ms to decode a frame
  SplitRig chooses(o);
  const Mean chosen = mean_of(&chooses);
  o.client.device_share = 0, o.client.device_goes_on = false;
  SplitRig servers(o);
  const double servers_ms = mean_of(&servers).ms;
  MESSAGE("chosen ", chosen.ms, " ms, ", chosen.device_rows, " rows; servers alone ", servers_ms, " ms");
  CHECK(chosen.ms < 1.05 * servers_ms);
}

// Goal: rows come coded where that pays on this device. Method: devices that decode quickly and slowly, over a link
// between both; a device that knows nothing yet goes by the link alone.
TEST_CASE("code_cost_decides_how_rows_come") {
  if (too_slow()) return;
  for (double pixel_ns : {50.0, 5'000.0}) {
    CAPTURE(pixel_ns);
    SplitRigOptions o = moving_scene();  // 500 ns a byte: 1.5 µs a pixel of RGB888
    o.client.device_share = 0, o.client.decode = {pixel_ns, 0};
    SplitRig rig(o);
    mean_of(&rig);
    const RemoteServer& server = rig.client.servers[0];
    CHECK((server.rows.asked.coding == RowCoding::raw) == (pixel_ns > 1'000));
    CHECK(static_cast<double>(rig.client.plan.decode_ns.value) == doctest::Approx(pixel_ns).epsilon(0.01));
  }
  Client unknown;
  CHECK(row_coding(59, code_threshold(unknown, unknown.servers[0]), false) == RowCoding::raw);
  CHECK(row_coding(61, code_threshold(unknown, unknown.servers[0]), false) == RowCoding::lossless);
  CHECK(row_coding(61, code_threshold(unknown, unknown.servers[0]), true) == RowCoding::near_lossless);
}

// Goal: frames take as long as predicted over a link with jitter, where the quickest ping overstates how late a server
// starts. Method: the servers' rows alone, after some frames.
TEST_CASE("code_cost_and_start_predict_frames") {
  if (too_slow()) return;
  SplitRigOptions o = moving_scene();
  o.server_ns = {10'000}, o.device_ns = 200'000;
  o.line.latency_ns = 1'500'000, o.line.jitter_ns = 4'000'000;
  o.client.device_share = 0, o.client.device_goes_on = false;
  SplitRig rig(o);
  for (int i = 0; i < 30; ++i) rig.frame(0.04 * i);
  double predicted = 0, measured = 0;
  for (int i = 30; i < 50; ++i) {
    const FrameShare& share = rig.frame(0.04 * i);
    predicted += share.predicted_ns, measured += share.measured_ns;
  }
  MESSAGE("predicted ", predicted / 20e6, " ms, measured ", measured / 20e6);
  CHECK(predicted == doctest::Approx(measured).epsilon(0.02));
}
