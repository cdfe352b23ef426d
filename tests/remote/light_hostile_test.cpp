// Frames by effect, and a server that sends something else than the light, or nothing: no frame fails, other servers
// are asked, and one line tells.
#include <doctest/doctest.h>

#include "fault_world.h"
#include "hostile_rig.h"
#include "light_rig.h"
#include "wire/light_coder.h"

using namespace pocketray;

namespace {

constexpr double kSecondNs = 1e9;

// A map as a server sends it, of equal lights.
struct MapBytes {
  std::vector<std::uint8_t> bytes;
  explicit MapBytes(const LightGrid& grid) : bytes(light_bytes_max(light_count(grid))) {
    std::vector<Vec3> light(light_count(grid), Vec3{0.5f, 0.25f, 0.125f});
    bytes.resize(encode_light(light.data(), grid.columns, grid.rows, 0, bytes.data()));
  }
  Message message(std::uint32_t frame) const {
    Message message;
    message.type = MessageType::light_map;
    message.light_map.frame = frame, message.light_map.light_ps = 1000;
    message.light_map.bytes = {bytes.data(), static_cast<std::uint32_t>(bytes.size())};
    return message;
  }
};

// Two servers on a good line.
FaultPlan calm_plan(SplitKind split) {
  FaultPlan plan = draw_faults(1);
  plan.width = 16, plan.height = 12, plan.server_count = 2;
  plan.device_ns = 100e3, plan.server_ns[0] = plan.server_ns[1] = 1e3, plan.device_share = -1;
  plan.line = platform::NullLinkSettings(), plan.line.clock_step_ns = 20, plan.event_count = 0;
  plan.split = split;
  return plan;
}

bool logged(const std::vector<std::string>& log, const char* text) {
  return std::any_of(log.begin(), log.end(),
                     [&](const std::string& line) { return line.find(text) != std::string::npos; });
}

}  // namespace

// Goal: rows that a request for light alone has replaced may be in flight, under their own number or, from a hostile
// server, under the new one: neither aborts the device. Method: a server holds the rows of a frame back and answers the
// request for light with them, with their first chunk, their last, and one row.
TEST_CASE("light_request_ends_the_rows_before_it") {
  for (bool new_number : {false, true})
    for (std::uint32_t part = 0; part < 3; ++part) {
      CAPTURE(new_number);
      CAPTURE(part);
      LightOptions light = by_effect();
      light.split = SplitKind::automatic, light.wait_ns = 0;
      HostileRig rig(true, light);
      rig.frames_until_ready();
      FrameRequest held;
      bool is_sent = false;
      rig.act = [&](HostileRig* r, const Message& message) -> std::vector<Message> {
        if (!r->note_request(message)) return r->answer(message);
        const FrameRequest& q = r->request;
        if (q.row_begin < q.row_end) return held = q, std::vector<Message>();
        if (held.frame == 0) return {};
        is_sent = true;
        const RowSequence due = first_rows(held);
        const std::uint32_t rows = part == 0 ? next_chunk_rows(held, due) : part == 1 ? due.row_end - due.row_begin : 1;
        return {r->rows.chunk(new_number ? q.frame : held.frame, due.row_end - rows, rows)};
      };
      rig.client.options.device_share = 0.5;  // whatever the client learns about the server
      rig.frame();
      REQUIRE(held.frame > 0);
      rig.client.options.light.split = SplitKind::effect;
      for (int i = 0; i < 3; ++i) {
        turn(&rig.device->renderer, 1);
        CHECK(rig.frame() < 2.2);
      }
      CHECK(is_sent);
      CHECK(rig.log.empty());
    }
}

// Goal: a server that answers pings and never sends light is dropped when that is overdue, is not waited for again, and
// one line tells that a frame has other light than was asked for. Method: a picture for a file, which waits for a
// minute, and some more.
TEST_CASE("light_that_is_overdue_drops_the_server") {
  LightOptions light = by_effect();
  light.wait_ns = static_cast<std::uint64_t>(60 * kSecondNs);
  HostileRig rig(true, light);
  rig.act = [](HostileRig* r, const Message& message) {
    return r->note_request(message) ? std::vector<Message>() : r->answer(message);
  };
  const std::uint64_t begin = rig.fake.now();
  rig.frame();
  const double first_ns = static_cast<double>(rig.fake.now() - begin);
  CHECK(first_ns > 29 * kSecondNs);
  CHECK(first_ns < 33 * kSecondNs);
  CHECK(!rig.client.share.has_light);
  CHECK(rig.client.servers[0].light.missed >= 1);
  for (int i = 0; i < 30; ++i) {
    turn(&rig.device->renderer, 1);
    CHECK(rig.frame() < 2.2);
  }
  REQUIRE(rig.log.size() == 2);
  CHECK(logged(rig.log, "did not send its light in time"));
  CHECK_MESSAGE(logged(rig.log, "instead of that of --indirect instant-radiosity"), rig.log[1]);
}

// Goal: where nobody waits for light, a frame without it is reported as well, once, but not while it may still come.
// Method: frames like those of a view; a server that sends light late, and one that never does.
TEST_CASE("light_that_is_missing_is_reported_once") {
  for (bool comes : {false, true}) {
    CAPTURE(comes);
    LightOptions light = by_effect();
    light.wait_ns = 0;
    HostileRig rig(true, light);
    const MapBytes map(light_grid(rig.client.settings, 6));
    const auto late_ns = static_cast<std::uint64_t>(2 * kSecondNs);
    std::uint64_t due_ns = 0;
    rig.act = [&](HostileRig* r, const Message& message) -> std::vector<Message> {
      if (!r->note_request(message)) return r->answer(message);
      if (due_ns == 0) due_ns = r->fake.now() + late_ns;
      return {};
    };
    rig.fake.flood = [&]() -> std::vector<std::uint8_t> {
      if (!comes || due_ns == 0 || rig.fake.now() < due_ns) return {};
      due_ns = 0;
      return bytes_of(map.message(rig.request.frame));
    };
    const std::uint64_t begin = rig.fake.now();
    while (rig.fake.now() - begin < static_cast<std::uint64_t>(10 * kSecondNs)) CHECK(rig.frame() < 2.2);
    CHECK(rig.log.size() == (comes ? 0 : 1));
    CHECK(logged(rig.log, "instead of that of --indirect") == !comes);
  }
}

// Goal: light of another frame than the last request's, which no earlier request is waiting for, ends the connection:
// it would count as the answer. Method: maps of the frame before, and of one to come.
TEST_CASE("light_of_another_frame_is_not_the_answer") {
  for (int off : {-1, 1}) {
    CAPTURE(off);
    LightOptions light = by_effect();
    light.wait_ns = 0;
    HostileRig rig(true, light);
    const MapBytes map(light_grid(rig.client.settings, 6));
    rig.act = [&](HostileRig* r, const Message& message) -> std::vector<Message> {
      if (!r->note_request(message)) return r->answer(message);
      return {map.message(static_cast<std::uint32_t>(static_cast<int>(r->request.frame) + off))};
    };
    for (int i = 0; i < 5; ++i) rig.frame();
    REQUIRE(rig.log.size() == 1);
    CHECK(logged(rig.log, "unrequested message"));
  }
}

// Goal: rows that come before their light, as from a server that leaves it out, end the connection. Method: frames by
// effect with rows of a server.
TEST_CASE("light_that_is_left_out_drops_the_server") {
  LightOptions light = by_effect();
  light.split = SplitKind::automatic, light.wait_ns = 0;
  HostileRig rig(true, light);
  int asked = 0;
  rig.act = [&](HostileRig* r, const Message& message) -> std::vector<Message> {
    if (!r->note_request(message)) return r->answer(message);
    asked += r->request.light_pitch > 0 && r->request.row_begin < r->request.row_end;
    return r->rows.rows(r->request);
  };
  rig.client.options.own_light_pixel_ns = 0.9 * kDeviceNs;
  for (int i = 0; i < 60 && asked == 0; ++i) turn(&rig.device->renderer, 1), rig.frame();
  rig.frame();
  CHECK(asked == 1);
  CHECK(logged(rig.log, "it sent rows without their light"));
}

// Goal: a good second server lights the frames where the first sends no light, in pictures for files and in views.
// Method: two servers, one of which is hostile; until the light comes, then while the other comes back.
TEST_CASE("light_comes_from_the_next_server") {
  for (std::uint64_t wait_ns : {std::uint64_t(0), std::uint64_t(60 * kSecondNs)})
    for (std::uint32_t bad : {0u, 1u}) {
      CAPTURE(wait_ns);
      CAPTURE(bad);
      FaultPlan plan = calm_plan(SplitKind::effect);
      plan.light_wait_ns = wait_ns;
      plan.malice[bad] = Malice::no_light;
      FaultWorld world;
      open_fault_world(plan, &world);
      Renderer* renderer = device_renderer(plan);
      auto frame = [&](int second) {
        REQUIRE(render_frame(renderer, &world.client, kFaultSeconds[second]).ok);
        return world.client.share.has_light;
      };
      const std::uint64_t begin = world.elapsed();
      bool is_lit = frame(0);
      if (wait_ns > 0) CHECK(is_lit);
      for (int i = 1; !is_lit && i < 10'000; ++i) is_lit = frame(i % 2);
      CHECK(is_lit);
      CHECK(world.elapsed() - begin < 2 * kSilenceNs);
      // The other returns meanwhile.
      for (int i = 0; world.elapsed() - begin < 6 * kSilenceNs; ++i) {
        CHECK(frame(i % 5));
        CHECK(world.client.share.light_age <= 2);
      }
      CHECK(world.client.servers[bad].overture.phase >= ServerPhase::probing);
      CHECK(world.log.size() <= 1);
      close_client(&world.client);
      close_fault_world(&world);
    }
}

// Goal: a server that is asked for nothing, as others light all frames, keeps its connection. Method: two servers and
// frames by effect, for much longer than servers keep a silent client.
TEST_CASE("light_of_one_server_keeps_the_other_connected") {
  const FaultPlan plan = calm_plan(SplitKind::effect);
  FaultWorld world;
  open_fault_world(plan, &world);
  for (int i = 0; world.elapsed() < 5 * kServerIdleNs; ++i)
    REQUIRE(render_frame(device_renderer(plan), &world.client, kFaultSeconds[i % 2]).ok);
  for (std::uint32_t i = 0; i < 2; ++i) CHECK(world.client.servers[i].overture.phase >= ServerPhase::probing);
  CHECK(world.log.empty());
  close_client(&world.client);
  close_fault_world(&world);
}

// Goal: where the faster way is taken, a server whose rows never come in time does not keep frames from being shared by
// effect. Method: two servers, one of which takes a second for a row, and a camera that turns.
TEST_CASE("light_is_tried_beside_a_server_that_never_gets_ready") {
  SplitRigOptions o = effect_rig("cornell");
  o.client.light.split = SplitKind::automatic, o.client.light.wait_ns = 0;
  o.server_count = 2;
  o.device_ns = 100e3, o.server_ns = {20e6, 10e3};
  SplitRig rig(o);
  int by_effect = 0;
  for (int i = 0; by_effect < int(kTrialFrames) && i < 300; ++i) {
    turn(&rig.device->renderer, 1);
    by_effect += rig.frame(0).by_effect;
  }
  CHECK(rig.client.servers[0].overture.phase == ServerPhase::probing);
  CHECK(rig.client.servers[1].overture.phase == ServerPhase::ready);
  CHECK(by_effect >= int(kTrialFrames));
}
