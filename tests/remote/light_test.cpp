// Frames shared by effect: a server sends the indirect light of a frame, the device renders the rest and adds it.
#include "remote/client/light.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "engine/trace_frame.h"
#include "hostile_rig.h"
#include "light_rig.h"
#include "support/effort.h"
#include "wire/light_coder.h"

using namespace pocketray;

namespace {

// The lights of a frame as a device gets them, rendered here; free ones are negative.
std::vector<Vec3> lights_here(Renderer* renderer, std::uint32_t pitch) {
  const LightGrid grid = light_grid(renderer->settings, pitch);
  std::vector<Vec3> lights;
  for (std::uint32_t row = 0; row < grid.rows; ++row)
    for (std::uint32_t column = 0; column < grid.columns; ++column) {
      const Span span = {static_cast<std::uint16_t>(row * pitch), static_cast<std::uint16_t>(column * pitch),
                         static_cast<std::uint16_t>(column * pitch + 1)};
      trace_spans(&renderer->tracers[0], &span, 1, Aov::indirect_light, renderer->image.data);
      lights.push_back(renderer->image[span.row * renderer->settings.width + span.column_begin]);
    }
  return lights;
}

Message light_message(std::uint32_t frame, const std::vector<std::uint8_t>& bytes) {
  Message message;
  message.type = MessageType::light_map;
  message.light_map.frame = frame, message.light_map.light_ps = 1000;
  message.light_map.bytes = {bytes.data(), static_cast<std::uint32_t>(bytes.size())};
  return message;
}

}  // namespace

// Goal: a server sends the light that the frame's surfaces get, to a level. Method: two methods, a scene that moves,
// threads, pitches; rendered here pixel by pixel.
TEST_CASE("light_map_has_the_light_of_the_frame") {
  for (std::uint32_t threads : {1u, 3u}) {
    ServerOptions options;
    options.thread_count = threads;
    ServerRig rig(options);
    ScriptedClient client(&rig);
    std::uint32_t frame = 0;
    for (const char* scene : {"cube", "seesaw"})
      for (IndirectChoice indirect : {kAmbient, kVirtual})
        for (std::uint32_t pitch : {2u, 7u}) {
          FrameRequest q = frame_request(scene, ++frame, 62, 33);
          q.settings.indirect = indirect, q.seconds = 0.3;
          q.light_pitch = static_cast<std::uint8_t>(pitch);
          client.request(q);
          const auto come = client.wait_for(MessageType::light_map);
          const LightMapMessage& map = come->message.light_map;
          CHECK(map.frame == frame);
          const std::unique_ptr<BuiltScene> built = build_builtin(scene);
          const std::unique_ptr<TestRenderer> here = make_renderer(built->scene, q.settings);
          REQUIRE(begin_frame(&here->renderer, {q.seconds}).ok);
          const LightGrid grid = light_grid(q.settings, pitch);
          std::vector<Vec3> got(light_count(grid));
          REQUIRE(decode_light(map.bytes.data, map.bytes.count, grid.columns, grid.rows, got.data()));
          const std::vector<Vec3> right = lights_here(&here->renderer, pitch);
          const float least = 1e-4f / here->renderer.view.exposure;
          int compared = 0;
          for (std::size_t i = 0; i < got.size(); ++i)
            for (int c = 0; right[i].x >= 0 && c < 3; ++c, ++compared)
              REQUIRE(std::fabs(got[i][c] - right[i][c]) <= std::max(right[i][c] / 64, least));
          CHECK(compared > int(got.size()));
        }
  }
}

// Goal: a request for rows and light brings the light first, then the rows of the frame, bit for bit; the request may
// be for light alone. Method: with a coarse picture, orders of rows, coherence of frames before and after.
TEST_CASE("light_map_comes_before_the_rows") {
  ServerRig rig;
  ScriptedClient client(&rig);
  std::uint32_t frame = 0;
  for (std::uint32_t pitch : {0u, 5u, 0u, 5u, 5u})
    for (bool coarse : {false, true}) {
      FrameRequest q = frame_request("seesaw", ++frame, 62, 33);
      q.settings.indirect = kVirtual, q.seconds = 0.05 * frame;
      q.light_pitch = static_cast<std::uint8_t>(pitch), q.coarse_first = coarse;
      q.row_begin = 7, q.row_end = 31;
      q.run_count = 2, q.runs[0] = {10, 1}, q.runs[1] = {14, 0};
      client.request(q);
      if (pitch > 0) CHECK(client.wait_for(MessageType::light_map)->message.light_map.frame == frame);
      if (coarse) client.wait_for(MessageType::coarse_picture);
      client.wait_for_rows(24);
      const std::vector<std::uint8_t> right = rendered_here(q), got = client.picture();
      const std::ptrdiff_t row_bytes = 62 * pixel_bytes(q.format);
      CHECK(std::equal(right.begin() + 7 * row_bytes, right.begin() + 31 * row_bytes, got.begin() + 7 * row_bytes));
    }
  FrameRequest q = frame_request("seesaw", ++frame, 62, 33);
  q.light_pitch = 5, q.row_begin = q.row_end = 9;
  client.request(q);
  CHECK(client.wait_for(MessageType::light_map)->message.light_map.frame == frame);
  q.frame = ++frame, q.light_pitch = 0, q.row_end = 20;
  client.request(q);
  client.wait_for_rows(11);
  q.frame = ++frame, q.row_end = 9;
  client.request(q, MessageType::frame_change);
  CHECK(client.wait_for(MessageType::error)->message.error.code == WireError::bad_request);
}

// Goal: a client that takes no message as long as the map's limit is refused, and rows still come.
TEST_CASE("light_map_that_fits_no_message_is_refused") {
  ServerRig rig;
  ScriptedClient client(&rig, false);
  Message hello = hello_message();
  hello.hello.message_bytes_max = 700;
  client.send(hello);
  FrameRequest q = frame_request("cube", 1, 40, 40);
  q.light_pitch = 2;
  client.request(q);
  CHECK(client.wait_for(MessageType::error)->message.error.code == WireError::too_large);
  q.frame = 2, q.light_pitch = 8;
  client.request(q);
  CHECK(client.wait_for(MessageType::light_map)->message.light_map.frame == 2);
  q.frame = 3, q.light_pitch = 0;
  client.request(q);
  client.wait_for_rows(40);
}

// Goal: the picture has the light of the method that servers render, close to the device's own rendering of it; the
// server sends little. Method: scenes at rest and in motion; errors next to those of ambient light.
TEST_CASE("effect_split_shows_the_server_s_light") {
  for (const char* scene : {"cornell", "cube", "seesaw"}) {
    CAPTURE(scene);
    SplitRigOptions o = effect_rig(scene);
    o.width = 96, o.height = 72;
    SplitRig rig(o);
    for (double seconds : {0.0, 0.4}) {
      const FrameShare& share = rig.frame(seconds);
      CHECK((share.by_effect && share.has_light && share.light_age == 0));
      CHECK(share.device_rows == 72);
      const std::vector<std::uint8_t> right = rig.local_pixels(seconds);
      CHECK(mean_error(pixels_of(rig.client), right) < 0.5 * mean_error(ambient_pixels(&rig, seconds), right));
      CHECK(share.light_bytes < 96 * 72 * 3 / 20);
    }
    CHECK(rig.log.empty());
  }
}

// Goal: nothing is requested while nothing changes, and the pixels stay; with a map for several frames, what moves has
// the light of the last one where that was, and what rests gets its own. Method: a camera that turns, then rests.
TEST_CASE("effect_split_asks_at_its_own_rate") {
  SplitRigOptions o = effect_rig("cornell");
  o.width = 96, o.height = 72, o.client.light.every = 4;
  SplitRig rig(o);
  Renderer* renderer = &rig.device->renderer;
  std::vector<std::uint32_t> ages;
  double late = 0, wrong = 0;
  for (int i = 0; i < 6; ++i) {
    turn(renderer, 1);
    const FrameShare& share = rig.frame(0);
    ages.push_back(share.light_age);
    CHECK((share.light_bytes > 0) == (share.light_age == 0));
    const std::vector<std::uint8_t> right = rig.local_pixels(0);
    late = std::max(late, mean_error(pixels_of(rig.client), right));
    wrong = std::max(wrong, mean_error(ambient_pixels(&rig, 0), right));
  }
  CHECK((ages == std::vector<std::uint32_t>{0, 1, 2, 3, 0, 1}));
  CHECK(late < 0.5 * wrong);           // what the mirror shows has the device's own light
  CHECK(rig.frame(0).light_age == 0);  // it rests
  const std::vector<std::uint8_t> resting = pixels_of(rig.client);
  for (int i = 0; i < 3; ++i) {
    CHECK(rig.frame(0).light_bytes == 0);
    CHECK(pixels_of(rig.client) == resting);
  }
  // As a client that begins here.
  SplitRigOptions fresh = o;
  SplitRig other(fresh);
  REQUIRE(set_camera(&other.device->renderer, renderer->view.camera).ok);
  other.frame(0);
  CHECK(pixels_of(other.client) == resting);
}

// Goal: without a server, frames have the device's own indirect light; when it dies, the light that has come stays, and
// when it returns, new light comes. No frame fails.
TEST_CASE("effect_split_goes_on_without_servers") {
  SplitRigOptions o = effect_rig("cube");
  SplitRig rig(o);
  rig.stop_server(0);
  rig.frame(0);
  CHECK(!rig.client.share.has_light);
  CHECK(pixels_of(rig.client) == ambient_pixels(&rig, 0));
  rig.start_server(0);
  for (int i = 0; i < 200 && !rig.client.share.has_light; ++i) rig.idle(100'000'000), rig.frame(0);
  REQUIRE(rig.client.share.has_light);
  const std::vector<std::uint8_t> lit = pixels_of(rig.client);
  rig.stop_server(0);
  rig.frame(0);
  CHECK(pixels_of(rig.client) == lit);
  turn(&rig.device->renderer, 1);
  rig.frame(0);
  CHECK(rig.client.share.has_light);
  CHECK(rig.client.share.light_age > 0);
  rig.start_server(0);
  for (int i = 0; i < 200 && rig.client.share.light_age > 0; ++i) rig.idle(100'000'000), rig.frame(0);
  CHECK(rig.client.share.light_age == 0);
}

// Goal: light that is late costs at most as long again as the device's tracing, and then counts for the frames after.
TEST_CASE("effect_split_waits_as_long_as_it_traced") {
  SplitRigOptions o = effect_rig("cornell");
  o.client.light.wait_ns = 0;
  o.server_ns = {2e6};  // per light: 176 ms, where the device traces for 3
  SplitRig rig(o);
  bool lit = false;
  for (int i = 0; i < 200 && !lit; ++i) {
    rig.frame(0);
    const double device_ns = o.device_ns * o.width * o.height;
    if (i > 0) CHECK(rig.client.share.measured_ns < 2.2 * device_ns);
    lit = rig.client.share.has_light;
  }
  CHECK(lit);
}

// Goal: where the light cannot be added, frames are shared by rows, and one line says why.
TEST_CASE("effect_split_that_does_not_fit_is_by_rows") {
  for (bool has_indirect : {false, true}) {
    SplitRigOptions o = effect_rig("cornell");
    o.compares = !has_indirect;
    o.client.light.indirect = has_indirect ? kVirtual : kAmbient;
    SplitRig rig(o);
    for (int i = 0; i < 3; ++i) rig.frame(0);
    CHECK(rig.client.share.by_effect == has_indirect);
    CHECK(rig.log.size() == (has_indirect ? 0 : 1));
    CHECK(rig.logged("not by effect") == !has_indirect);
  }
}

// Goal: a light map that is not due, or cannot be decoded, ends the connection. Method: a server that deviates in one
// way.
TEST_CASE("light_map_that_is_not_due_ends_the_connection") {
  enum Deviation { none, unasked, twice, undecodable };
  for (Deviation deviation : {none, unasked, twice, undecodable}) {
    CAPTURE(static_cast<int>(deviation));
    LightOptions light = by_effect();
    light.wait_ns = 0;
    if (deviation == unasked) light.split = SplitKind::rows;
    HostileRig rig(true, light);
    Settings settings;
    settings.width = kWidth, settings.height = kHeight;
    const LightGrid grid = light_grid(settings, 6);
    std::vector<Vec3> map(light_count(grid), Vec3{8, 8, 8});
    std::vector<std::uint8_t> bytes(light_bytes_max(map.size()));
    bytes.resize(encode_light(map.data(), grid.columns, grid.rows, 0, bytes.data()));
    std::vector<std::uint8_t> wrong = bytes;
    wrong.assign(light_bytes_max(map.size()), 0xFF);
    std::uint32_t asked = 0;
    rig.act = [&](HostileRig* r, const Message& message) -> std::vector<Message> {
      if (!r->note_request(message)) return r->answer(message);
      const FrameRequest& q = r->request;
      if (deviation == unasked) {
        std::vector<Message> rows = r->rows.rows(q);
        rows.push_back(light_message(q.frame, bytes));
        return rows;
      }
      ++asked;
      CHECK(q.light_pitch == 6);
      std::vector<Message> answers = {light_message(q.frame, deviation == undecodable ? wrong : bytes)};
      if (deviation == twice) answers.push_back(answers[0]);
      return answers;
    };
    int lit = 0;
    for (int i = 0; i < 8 && rig.log.empty(); ++i) {
      turn(&rig.device->renderer, 1);
      rig.frame();
      lit += rig.client.share.has_light;
    }
    CHECK((asked > 0) == (deviation != unasked));
    CHECK((lit > 0) == (deviation == none));
    CHECK(rig.log.empty() == (deviation == none));
    for (const std::string& line : rig.log)
      CHECK(line.find(deviation == undecodable ? "cannot be decoded" : "unrequested") != std::string::npos);
  }
}

// Goal: the map of a frame that was given up may still come, and is not used: nobody knows what it shows.
TEST_CASE("light_map_of_a_frame_given_up_is_not_used") {
  HostileRig rig(true, by_effect());
  const LightGrid grid = light_grid(rig.client.settings, 6);
  std::vector<std::uint8_t> bytes[2];
  for (int i = 0; i < 2; ++i) {
    std::vector<Vec3> map(light_count(grid), i == 0 ? Vec3{0.25f, 0.25f, 0.25f} : Vec3{64, 64, 64});
    bytes[i].resize(light_bytes_max(map.size()));
    bytes[i].resize(encode_light(map.data(), grid.columns, grid.rows, 0, bytes[i].data()));
  }
  rig.client.options.light.wait_ns = 0;
  std::uint32_t asked = 0, given_up = 0;
  rig.act = [&](HostileRig* r, const Message& message) -> std::vector<Message> {
    if (!r->note_request(message)) return r->answer(message);
    ++asked;
    if (asked == 1) return {light_message(r->request.frame, bytes[0])};
    if (asked == 2) return given_up = r->request.frame, std::vector<Message>();
    return {light_message(given_up, bytes[1])};
  };
  for (int i = 0; i < 20 && !rig.client.share.has_light; ++i) rig.frame();
  REQUIRE(asked == 1);
  const std::vector<std::uint8_t> lit = pixels_of(rig.client);
  turn(&rig.device->renderer, 1);
  REQUIRE(begin_frame(&rig.device->renderer, &rig.client, 0).ok);
  advance_client(&rig.client, 1'000'000);
  REQUIRE(asked == 2);
  rig.frame();
  CHECK(asked == 3);
  CHECK(rig.client.share.light_age == 2);
  CHECK(rig.client.share.light_bytes > 0);
  CHECK(rig.client.servers[0].light.due == 1);
  CHECK(mean_error(pixels_of(rig.client), lit) < 16);
  CHECK(rig.log.empty());
}
