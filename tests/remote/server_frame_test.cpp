// Frames from a server: the pixels of local rendering, in fair turns.
#include <doctest/doctest.h>

#include <algorithm>

#include "base/rng.h"
#include "platform/net/tcp.h"
#include "remote/server/session.h"
#include "scene/baked.h"
#include "support/effort.h"
#include "support/generated_scene.h"
#include "support/scripted_client.h"
#include "support/test_environment.h"

using namespace pocketray;

namespace {

// Requests the frame and compares it with local rendering.
void check_frame(ScriptedClient* client, const FrameRequest& request, MessageType type = MessageType::frame_request) {
  client->request(request, type);
  client->wait_for_rows(request.settings.height);
  CHECK(client->picture() == rendered_here(request));
}

}  // namespace

// Goal: a frame in chunks equals local rendering bit for bit, in every format. Method: several frames on one
// connection: scene, camera, time, exposure and settings change while the codec's picture stays; pixel formats and
// sizes, which restart it, change too.
TEST_CASE("server_frames_equal_local_ones") {
  ServerOptions options;
  options.thread_count = 2;
  ServerRig rig(options);
  ScriptedClient client(&rig);
  FrameRequest request = frame_request("cornell", 1);
  check_frame(&client, request);
  CHECK(client.chunks.front().row_begin == 40);  // the lowest comes first
  CHECK(client.chunks.back().row_begin == 0);

  request = frame_request("seesaw", 2);
  request.seconds = 1.7;
  check_frame(&client, request);
  request.frame = 3, request.seconds = 2.3;
  check_frame(&client, request);

  request = frame_request("cornell", 4);
  request.dither = true;
  check_frame(&client, request);
  request.frame = 5, request.camera_stated = true, request.exposure = 0.4f;
  request.camera.eye = {0.3f, 1.2f, 2.5f}, request.camera.target = {0, 1, 0};
  check_frame(&client, request);
  request.frame = 6, request.camera.eye.x = -0.2f;
  check_frame(&client, request, MessageType::frame_change);
  request.frame = 7, request.format = WireFormat::rgb888, request.dither = false, request.coding = RowCoding::lossless;
  check_frame(&client, request);
  request.frame = 8, request.camera_stated = false, request.exposure = 0, request.settings.tone = Tone::film;
  check_frame(&client, request);
  request = frame_request("statue", 9, 40, 30);
  request.settings.samples_per_pixel = 4, request.chunk_rows = 7, request.coding = RowCoding::raw;
  check_frame(&client, request);
  request.frame = 10, request.run_count = 3;
  request.runs[0] = {9, 1}, request.runs[1] = {14, 0}, request.runs[2] = {7, 2};
  check_frame(&client, request, MessageType::frame_change);
  const std::uint32_t rows[] = {16, 9, 2, 0,
                                23};  // from the 14 rows' lowest upward, then the upper ones, then the lowest
  REQUIRE(client.chunks.size() == 5);
  for (std::size_t i = 0; i < 5; ++i) CHECK(client.chunks[i].row_begin == rows[i]);
  CHECK(server_totals(*rig.server).frame_count == 10);
  CHECK(server_totals(*rig.server).row_count == 8 * 48 + 2 * 30);
}

// Goal: every setting that changes pixels takes effect, as do the choices of camera and animation, whatever came
// before. Method: a scene with all features, selected in turn on one connection; three cameras, one of which moves.
TEST_CASE("server_frames_follow_every_setting") {
  auto generated = generate_scene(kAllFeatures, 3);
  generated->cameras.assign(3, generated->cameras[0]);
  generated->cameras[1].eye = {-2, 2.5f, 3};
  generated->cameras[2].node = 0;
  for (int i = 0; i < 24; ++i) {  // as many as source selection takes
    Light light;
    light.position = {static_cast<float>(i % 5) - 2, 2 + static_cast<float>(i % 3), static_cast<float>(i % 7) - 3};
    light.intensity = {0.1f, 0.1f, 0.1f};
    generated->lights.push_back(light);
  }
  for (Material& m : generated->materials) m.emission_texture = {};
  generated->bind();
  const TestEnvironment even = even_environment({0.3f, 0.3f, 0.3f});
  even.give(&generated->scene);
  std::vector<std::uint8_t> bytes(baked_size(generated->scene));
  baked_write(generated->scene, bytes.data());
  SceneStore store;
  store.scenes.resize(1);
  StoredScene* stored = &store.scenes[0];
  stored->bytes = bytes.data(), stored->byte_count = bytes.size();
  stored->hash = content_hash(bytes.data(), bytes.size());
  stored->scene = generated->scene;
  ServerRig rig(ServerOptions(), platform::NullLinkSettings(), platform::kNullLink, store);
  ScriptedClient client(&rig);
  FrameRequest plain = frame_request("cube", 0, 40, 30), request;
  plain.scene = stored->hash;
  std::uint32_t frame = 0;
  std::vector<std::uint8_t> before;
  auto check = [&](const FrameRequest& asked, bool differs) {
    CAPTURE(frame);
    FrameRequest numbered = asked;
    numbered.frame = ++frame;
    client.request(numbered);
    client.wait_for_rows(30);
    std::vector<std::uint8_t> picture = client.picture();
    CHECK(picture == rendered_here(numbered, store));
    if (differs) CHECK(picture != before);
    before = picture;
  };
  auto check_and_back = [&](const std::function<void(FrameRequest*)>& change, bool differs = true) {
    request = plain;
    change(&request);
    check(request, differs);
    check(plain, differs);
  };
  check(plain, false);
  for (const SettingRow& row : kSettingList) {
    CAPTURE(std::string(row.name));
    if (row.wire_bytes == 0) continue;
    double usual = row.field.get(plain.settings);
    double coarse = row.sweep.values[row.sweep.values[0] == usual ? row.sweep.count / 2 : 0];
    if (row.effects == bit(Effect::instant_radiosity)) continue;   // below
    const bool shows = row.name != std::string("reconstruction");  // the scene stores no radiosity
    check_and_back([&](FrameRequest* r) { row.field.set(&r->settings, coarse); }, shows);
  }
  for (std::uint32_t count : {16u, 64u}) {
    request = plain;
    request.settings.indirect = indirect_choice(Effect::instant_radiosity), request.settings.virtual_lights = count;
    check(request, true);
  }
  request.settings.compensation = Compensation::rays;
  check(request, true);
  check(plain, true);
  check_and_back([](FrameRequest* r) { r->settings.forced_off = bit(Effect::shadow); });
  check_and_back([](FrameRequest* r) { r->camera_index = 1; });
  check_and_back([](FrameRequest* r) { r->camera_index = 2, r->seconds = 0.6; });
  check_and_back([](FrameRequest* r) { r->camera_index = 2, r->seconds = 0.9; });
  check_and_back([](FrameRequest* r) { r->camera_stated = true, r->camera.eye = {0, 3, 5}; });
  for (std::uint32_t animation : {0u, kNone, 0u}) {
    request = plain;
    request.seconds = 0.6, request.animation = animation;
    check(request, true);
  }
  check_and_back([](FrameRequest* r) { r->exposure = 0.2f; });
  check_and_back([](FrameRequest* r) { r->settings.texture_side_max = 1; });
  request = plain;
  request.camera_index = 2, request.camera_stated = true, request.camera.eye = {0, 3, 5};
  check(request, true);
  request.camera_stated = false, request.seconds = 0.6;  // back to the moving camera
  check(request, true);
  request.settings.cut_off_levels = 0;
  check(request, false);
}

// Goal: rows are not rendered long before they can be sent, so that cancelling saves time and bytes. Method: a slow
// line that holds 2 KiB; rendered rows are ahead of received ones by at most the contents of line, queue and a chunk.
TEST_CASE("server_makes_rows_no_earlier_than_they_can_be_sent") {
  platform::NullLinkSettings settings;
  settings.bytes_per_second = 100'000;
  settings.pipe_bytes = 2048;
  ServerRig rig(ServerOptions(), settings);
  ScriptedClient client(&rig);
  FrameRequest request = frame_request("cube", 1, 320, 240);
  request.format = WireFormat::rgb888, request.coding = RowCoding::raw, request.chunk_rows = 4;
  client.request(request);
  std::uint64_t ahead_max = 0;
  rig.run_until([&] {
    client.poll();
    std::uint64_t ahead = server_totals(*rig.server).row_count - client.rows_come;
    if (ahead > ahead_max) ahead_max = ahead;
    return client.rows_come == 240;
  });
  CHECK(ahead_max * 960 <= 2048 + kAheadBytes + 2 * 4 * 960);
}

// Goal: the same over sockets. Method: two clients at once, by loopback.
TEST_CASE("server_frames_equal_local_ones_over_tcp") {
  ServerRig rig(ServerOptions(), platform::NullLinkSettings(), platform::kTcpLink);
  ScriptedClient first(&rig), second(&rig);
  FrameRequest request = frame_request("cornell", 1), other = frame_request("statue", 1, 40, 30);
  first.request(request);
  second.request(other);
  rig.run_until([&] { return first.poll(), second.poll(), first.rows_come == 48 && second.rows_come == 30; });
  CHECK(first.picture() == rendered_here(request));
  CHECK(second.picture() == rendered_here(other));
}

// Goal: only the requested band of a frame is sent, and the rest of the client's picture stays. Method: rows 10 to 29
// in chunks of 8: 22–29, 14–21, 10–13.
TEST_CASE("server_sends_the_rows_of_the_band_from_below") {
  ServerRig rig;
  ScriptedClient client(&rig);
  FrameRequest request = frame_request("cornell", 1);
  request.row_begin = 10, request.row_end = 30;
  client.request(request);
  client.wait_for_rows(20);
  REQUIRE(client.chunks.size() == 3);
  const std::uint32_t begins[] = {22, 14, 10}, counts[] = {8, 8, 4};
  for (std::size_t i = 0; i < 3; ++i) {
    CHECK(client.chunks[i].row_begin == begins[i]);
    CHECK(client.chunks[i].row_count == counts[i]);
  }
  std::vector<std::uint8_t> expected = rendered_here(request), picture = client.picture();
  for (std::size_t i = 0; i < expected.size(); ++i) {
    std::size_t row = i / (64 * 2);
    if (row < 10 || row >= 30) expected[i] = 0;
  }
  CHECK(picture == expected);
}

// Goal: no chunk is larger than the client accepts. Method: one accepts messages of 3 KiB, requests chunks of 48 rows
// and gets several; one whose limit is below a row is told that the picture is too large.
TEST_CASE("server_cuts_chunks_to_the_size_that_the_client_takes") {
  ServerRig rig;
  ScriptedClient client(&rig, false), small(&rig, false);
  Message hello = hello_message();
  hello.hello.message_bytes_max = 3072;
  client.send(hello);
  FrameRequest request = frame_request("cornell", 1);
  request.chunk_rows = 48, request.coding = RowCoding::raw;
  client.request(request);
  client.wait_for_rows(48);
  CHECK(client.chunks.size() > 2);
  CHECK(client.picture() == rendered_here(request));
  hello.hello.message_bytes_max = 100;
  small.send(hello);
  small.request(request);
  CHECK(small.wait_for(MessageType::error)->message.error.code == WireError::too_large);
}

// Goal: chunks waiting for room are sent as soon as there is some. Method: 16 threads trace 32 rows at once, more bytes
// than may be queued; the server may sleep for a second in every step, but the frame takes less.
TEST_CASE("server_sends_chunks_that_waited_without_delay") {
  ServerOptions options;
  options.thread_count = 16;
  ServerRig rig(options);
  ScriptedClient client(&rig);
  FrameRequest request = frame_request("cube", 1, 320, 240);
  request.format = WireFormat::rgb888, request.coding = RowCoding::raw, request.chunk_rows = 4;
  std::uint64_t start = rig.now();
  client.request(request);
  while (client.rows_come < 240 && rig.now() - start < 5000 * kMs) {
    rig.step(1000 * kMs);
    client.poll();
  }
  CHECK(rig.now() - start < 100 * kMs);
  CHECK(client.picture() == rendered_here(request));
}

// Goal: a request replaces the previous one; cancelling ends it. Method: an emulated CPU of 1 µs per pixel; after the
// first chunk of a frame request another, cancel that after its first chunk, then request a last one.
TEST_CASE("server_drops_what_is_replaced_or_cancelled") {
  ServerOptions options;
  options.pace.ns_per_pixel = 1000;
  ServerRig rig(options);
  ScriptedClient client(&rig);
  FrameRequest request = frame_request("cornell", 1);
  client.request(request);
  rig.run_until([&] { return client.poll(), client.rows_come >= 8; });
  rig.step();  // begins another chunk
  request.frame = 2, request.camera_stated = true;
  request.camera.eye = {0.3f, 1.2f, 2.5f}, request.camera.target = {0, 1, 0};
  client.request(request);
  client.wait_for_rows(48);
  CHECK(client.picture() == rendered_here(request));
  CHECK(server_totals(*rig.server).frame_count == 1);
  CHECK(server_totals(*rig.server).row_count <= 48 + 16);

  request.frame = 3;
  client.request(request);
  rig.run_until([&] { return client.poll(), client.rows_come >= 8; });
  Message cancel;
  cancel.type = MessageType::cancel;
  cancel.cancel.frame = 3;
  client.send(cancel);
  std::uint64_t until = rig.now() + 500 * kMs;
  rig.run_until([&] { return client.poll(), rig.now() >= until; });
  CHECK(client.rows_come <= 24);
  request.frame = 4;
  client.request(request);
  client.wait_for_rows(48);
  CHECK(client.picture() == rendered_here(request));
}

// Goal: an emulated CPU keeps its pace, and chunks and pongs report the time per pixel. Method: 64 × 48 pixels at 2 µs
// by the simulated clock, on a link without delay: 6.144 ms, and 2 000 000 ps per pixel.
TEST_CASE("server_keeps_the_pace_of_the_emulated_cpu") {
  ServerOptions options;
  options.pace.ns_per_pixel = 2000;
  ServerRig rig(options);
  ScriptedClient client(&rig);
  FrameRequest request = frame_request("cornell", 1);
  client.request(request);
  client.wait_for_rows(48);  // the first frame includes the build
  request.frame = 2;
  std::uint64_t start = rig.now();
  client.request(request);
  client.wait_for_rows(48);
  double took = static_cast<double>(rig.now() - start);
  CHECK(took == doctest::Approx(64 * 48 * 2000.0).epsilon(0.02));
  for (const RowChunk& chunk : client.chunks) CHECK(chunk.pixel_ps == doctest::Approx(2e6).epsilon(0.02));
  Message ping;
  ping.type = MessageType::ping;
  ping.ping = {77, 5000};
  client.send(ping);
  auto pong = client.wait_for(MessageType::pong);
  CHECK(pong->message.pong.id == 77);
  CHECK(pong->message.pong.bytes.count == 5000);
  CHECK(pong->message.pong.pixel_ps == doctest::Approx(2e6).epsilon(0.02));
}

// Goal: a small frame does not wait for a slow row of a large one. Method: 1 ms per pixel, rows of 1.28 s; the small
// frame gets the CPU half of the time, and the large one completes.
TEST_CASE("server_interrupts_rows_that_take_long") {
  ServerOptions options;
  options.pace.ns_per_pixel = 1'000'000;
  ServerRig rig(options);
  ScriptedClient first(&rig), second(&rig);
  FrameRequest large = frame_request("cube", 1, 1280, 16), small = frame_request("cube", 1, 16, 12);
  large.chunk_rows = 3;
  first.request(large);
  std::uint64_t start = rig.now();
  rig.run_until([&] { return rig.now() - start > 500 * kMs; });
  second.request(small);
  start = rig.now();
  second.wait_for_rows(12);
  CHECK(rig.now() - start < 450 * kMs);
  CHECK(second.picture() == rendered_here(small));
  rig.run_until([&] { return first.poll(), first.rows_come == 16; }, 30'000 * kMs);
  CHECK(first.picture() == rendered_here(large));
}

// Goal: clients get equal shares of the CPU, whatever they request, and learn the resulting price. Method: two
// clients of an emulated CPU request frame after frame for 4 s, once they are no newcomers: one small pictures in
// chunks of a row, the other large ones in chunks of 16 rows. A third that comes later gets no more than its share.
TEST_CASE("server_shares_its_time_fairly") {
  ServerOptions options;
  options.pace.ns_per_pixel = 20'000;
  ServerRig rig(options);
  ScriptedClient first(&rig), second(&rig), third(&rig);
  FrameRequest requests[3] = {frame_request("cornell", 0, 40, 30), frame_request("cornell", 0, 96, 72),
                              frame_request("cube", 0)};
  requests[0].chunk_rows = 1;
  requests[1].chunk_rows = 16;
  ScriptedClient* clients[3] = {&first, &second, &third};
  std::uint64_t pixels[3] = {0, 0, 0};
  auto run_for = [&](std::uint64_t ns, int client_count) {
    std::uint64_t until = rig.now() + ns;
    for (std::uint64_t& count : pixels) count = 0;
    rig.run_until([&] {
      for (int i = 0; i < client_count; ++i) {
        FrameRequest* request = &requests[i];
        std::uint32_t before = clients[i]->rows_come;
        clients[i]->poll();
        pixels[i] += std::uint64_t(clients[i]->rows_come - before) * request->settings.width;
        if (request->frame == 0 || clients[i]->rows_come == request->settings.height) {
          ++request->frame;
          clients[i]->request(*request);
        }
      }
      return rig.now() >= until;
    });
  };
  run_for(800 * kMs, 2);
  run_for(4000 * kMs, 2);
  CHECK(static_cast<double>(pixels[0]) == doctest::Approx(100'000).epsilon(0.1));
  CHECK(static_cast<double>(pixels[1]) == doctest::Approx(100'000).epsilon(0.1));
  CHECK(second.chunks.back().pixel_ps == doctest::Approx(2e7).epsilon(0.05));
  CHECK(second.chunks.back().price == doctest::Approx(2 * kPriceUnit).epsilon(0.1));
  run_for(800 * kMs, 3);
  run_for(3000 * kMs, 3);
  for (std::uint64_t count : pixels) CHECK(static_cast<double>(count) == doctest::Approx(50'000).epsilon(0.1));
}

// Goal: a server traces of a client's frames what may have changed since it traced these rows for the last frame, as
// the chunks tell; pixels are those of whole frames. Method: seesaw: the same frame again, the next frame, rows it did
// not have, a frame cancelled half-way; with coherence off, all of it.
TEST_CASE("server_traces_what_changes_for_a_client") {
  for (CoherenceMode mode : {CoherenceMode::automatic, CoherenceMode::off}) {
    ServerOptions options;
    options.coherence = mode;
    ServerRig rig(options);
    ScriptedClient client(&rig);
    FrameRequest request = frame_request("seesaw", 0);
    request.seconds = 7;
    auto traced = [&](std::uint16_t row_begin, std::uint16_t row_end) {
      ++request.frame;
      request.row_begin = row_begin, request.row_end = row_end;
      client.request(request);
      client.wait_for_rows(row_end - row_begin);
      std::vector<std::uint8_t> picture = client.picture(), right = rendered_here(request);
      const std::size_t line = right.size() / 48;
      CHECK(std::equal(right.begin() + static_cast<std::ptrdiff_t>(row_begin * line),
                       right.begin() + static_cast<std::ptrdiff_t>(row_end * line),
                       picture.begin() + static_cast<std::ptrdiff_t>(row_begin * line)));
      std::uint32_t count = 0;
      for (const RowChunk& chunk : client.chunks) count += chunk.traced * chunk.row_count * 64u / 255;
      return count;
    };
    const bool coherent = mode != CoherenceMode::off;
    CHECK(traced(16, 48) == 32 * 64);
    CHECK(traced(16, 48) == (coherent ? 0 : 32 * 64));
    CHECK(traced(0, 16) == 16 * 64);                   // of the same time: new rows alone ...
    CHECK(traced(0, 48) == (coherent ? 0 : 48 * 64));  // ... and then all are known
    request.seconds += 1 / 30.0;
    const std::uint32_t next = traced(24, 48);
    CHECK((coherent ? next > 0 && next < 24 * 64 / 4 : next == 24 * 64));
    request.seconds += 1 / 30.0;
    const std::uint32_t more = traced(20, 48);  // rows 20 to 23 were not traced for the last frame
    CHECK((coherent ? more >= 4 * 64 && more < 4 * 64 + 24 * 64 / 4 : more == 28 * 64));
    request.seconds += 1 / 30.0, ++request.frame;
    request.row_begin = 0, request.row_end = 48;
    client.request(request);
    rig.run_until([&] { return client.poll(), client.rows_come >= 16; });
    Message cancel;
    cancel.type = MessageType::cancel;
    cancel.cancel.frame = request.frame;
    client.send(cancel);
    request.seconds += 1 / 30.0;
    const std::uint32_t after = traced(0, 48);
    CHECK((coherent ? after < 48 * 64 : after == 48 * 64));
  }
}
