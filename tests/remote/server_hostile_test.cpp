// Faulty, hostile or failing clients harm only themselves.
#include <doctest/doctest.h>

#include <cstring>

#include "base/rng.h"
#include "client_count.h"
#include "support/scripted_client.h"

using namespace pocketray;

namespace {

void check_serves(ServerRig* rig) {
  ScriptedClient client(rig);
  FrameRequest request = frame_request("cube", 1, 16, 12);
  client.request(request);
  client.wait_for_rows(12);
  CHECK(client.picture() == rendered_here(request));
}

std::vector<std::uint8_t> hello_bytes() { return bytes_of(hello_message()); }

std::vector<std::uint8_t> request_bytes(const FrameRequest& request) {
  Message message;
  message.type = MessageType::frame_request;
  message.frame_request = request;
  return bytes_of(message);
}

// Sends the bytes and expects the error `malformed` and a closed connection.
void check_malformed(ServerRig* rig, const std::vector<std::uint8_t>& bytes, WireError code = WireError::malformed) {
  ScriptedClient client(rig, false);
  client.send_bytes(bytes);
  rig->run_until([&] { return client.poll(), client.closed; });
  CHECK(client.has_error(code));
  CHECK(client_count(*rig->server) == 0);
}

}  // namespace

// Goal: a client that sends a malformed message is told so and disconnected. Method: noise; noise behind a hello; every
// message with a byte flipped behind a hello; messages that only servers send; a request before the hello; rows out of
// range, made by changing a valid request without its checksum, and with it.
TEST_CASE("server_ends_whoever_sends_what_is_no_message") {
  ServerRig rig;
  Rng rng = make_rng(11);
  for (int round = 0; round < 20; ++round) {
    std::vector<std::uint8_t> bytes = round % 2 ? hello_bytes() : std::vector<std::uint8_t>();
    bytes.push_back(0xee);
    for (int i = 0; i < 300; ++i) bytes.push_back(static_cast<std::uint8_t>(next_u32(&rng)));
    check_malformed(&rig, bytes);
  }
  FrameRequest request = frame_request("cube", 1, 16, 12);
  check_malformed(&rig, request_bytes(request));
  for (std::size_t at = 4; at < request_bytes(request).size(); at += 7) {
    std::vector<std::uint8_t> bytes = hello_bytes(), damaged = request_bytes(request);
    damaged[at] ^= 0x10;
    bytes.insert(bytes.end(), damaged.begin(), damaged.end());
    check_malformed(&rig, bytes);
  }
  for (MessageType type : {MessageType::hello, MessageType::scene_entry, MessageType::scene_piece, MessageType::pong,
                           MessageType::view_entry}) {
    Message message;
    message.type = type;
    std::vector<std::uint8_t> bytes = hello_bytes(), more = bytes_of(message);
    bytes.insert(bytes.end(), more.begin(), more.end());
    check_malformed(&rig, bytes);
  }
  check_serves(&rig);
}

// Goal: another version differs from noise. Method: a hello with a changed version and a new checksum, as message.h
// decodes it.
TEST_CASE("server_tells_another_version_why_it_is_closed") {
  ServerRig rig;
  Message hello = hello_message();
  hello.hello.version = kWireVersion + 1;
  check_malformed(&rig, bytes_of(hello), WireError::wrong_version);
  CHECK(rig.logged("a different protocol version"));
}

// Goal: impossible requests are refused with the reason, and the connection goes on. Method: one request of each kind,
// each followed by a good frame.
TEST_CASE("server_refuses_requests_that_it_cannot_meet") {
  ServerOptions options;
  options.client_memory_bytes = 8u << 20;
  ServerRig rig(options);
  ScriptedClient client(&rig);
  std::uint32_t frame = 0;
  auto check_refused = [&](FrameRequest request, WireError code) {
    CAPTURE(static_cast<int>(code));
    request.frame = ++frame;
    client.send_bytes(request_bytes(request));
    auto error = client.wait_for(MessageType::error);
    CHECK(error->message.error.code == code);
    CHECK(error->message.error.frame == frame);
    FrameRequest good = frame_request("cube", ++frame, 16, 12);
    client.decoder = nullptr;  // the shape changed, so the codec starts over
    client.request(good);
    client.wait_for_rows(12);
    CHECK(client.picture() == rendered_here(good));
  };
  FrameRequest request = frame_request("cube", 0, 8192, 8192);
  check_refused(request, WireError::too_large);
  request = frame_request("cube", 0, 2048, 2048);  // within the limit on sides but not on memory
  check_refused(request, WireError::too_large);
  request = frame_request("cube", 0, 20, 12);
  request.scene.low ^= 1;
  check_refused(request, WireError::unknown_scene);
  request = frame_request("cube", 0, 20, 12);
  request.camera_index = 9;
  check_refused(request, WireError::bad_request);
  request = frame_request("cube", 0, 20, 12);
  request.camera_stated = true;
  request.camera.eye = request.camera.target = {1, 2, 3};
  check_refused(request, WireError::bad_request);
  CHECK(client_count(*rig.server) == 1);
}

// Goal: a change without a request, or to rows outside the picture, is refused, and the connection goes on. Method:
// before and after the first request; a valid change gives its picture.
TEST_CASE("server_refuses_changes_of_what_was_not_asked_for") {
  ServerRig rig;
  ScriptedClient client(&rig);
  Message change;
  change.type = MessageType::frame_change;
  change.frame_request = frame_request("cube", 1, 16, 12);
  auto check_refused = [&] {
    client.send(change);
    auto error = client.wait_for(MessageType::error);
    CHECK(error->message.error.code == WireError::bad_request);
    CHECK(error->message.error.frame == change.frame_request.frame);
  };
  check_refused();
  FrameRequest whole = frame_request("cube", 2, 16, 12);
  client.request(whole);
  client.wait_for_rows(12);
  change.frame_request.frame = 3, change.frame_request.row_end = 13;
  check_refused();
  whole.frame = 4, whole.seconds = 0.5;
  client.request(whole, MessageType::frame_change);
  client.wait_for_rows(12);
  CHECK(client.picture() == rendered_here(whole));
}

// Goal: frame numbers increase; an old one is refused without side effects, the same one requests more rows. Method:
// number 3 while the upper half of frame 5 is rendered, then its lower half.
TEST_CASE("server_refuses_old_frame_numbers") {
  ServerOptions options;
  options.pace.ns_per_pixel = 1000;
  ServerRig rig(options);
  ScriptedClient client(&rig);
  FrameRequest whole = frame_request("cube", 5), upper = whole, lower = whole, old = frame_request("cornell", 3);
  upper.row_end = lower.row_begin = 24;
  client.request(upper);
  client.send_bytes(request_bytes(old));
  rig.run_until([&] { return client.poll(), client.rows_come == 24 && client.received.size() == 2; });
  CHECK(client.received[1]->message.error.code == WireError::bad_request);
  CHECK(client.received[1]->message.error.frame == 3);
  client.send_bytes(request_bytes(lower));
  rig.run_until([&] { return client.poll(), client.rows_come == 48; });
  CHECK(client.picture() == rendered_here(whole));
}

// Goal: a client that never reads fills only its own buffer and is closed in time; others are unaffected. Method: it
// requests frames whose rows do not fit its pipe; the frames of another take as long as without it.
TEST_CASE("server_ends_a_client_that_never_reads") {
  ServerOptions options;
  options.stall_timeout_ns = 3000 * kMs;
  options.pace.ns_per_pixel = 10'000;
  ServerRig rig(options);
  ScriptedClient deaf(&rig), other(&rig);
  deaf.wait_for(MessageType::hello);
  other.wait_for(MessageType::hello);
  rig.run_until([&] { return client_count(*rig.server) == 2; });
  deaf.reads = false;
  FrameRequest large = frame_request("cornell", 1, 320, 240);
  large.format = WireFormat::rgb888, large.coding = RowCoding::raw;
  deaf.send_bytes(request_bytes(large));
  FrameRequest request = frame_request("cube", 1);
  std::uint64_t start = rig.now(), last_ns = 0;
  while (client_count(*rig.server) == 2) {
    std::uint64_t before = rig.now();
    other.request(request);
    other.wait_for_rows(48);
    ++request.frame;
    last_ns = rig.now() - before;
    REQUIRE(before - start < 10'000 * kMs);
  }
  CHECK(last_ns < 64ull * 48 * 10'000 * 3 / 2);
  double waited = static_cast<double>(rig.now() - start);
  CHECK(waited > 2.9e9);
  CHECK(waited < 4.5e9);
  CHECK(rig.logged("does not read its answers"));
  check_serves(&rig);
}

// Goal: a partial message times out; mere silence is allowed for longer. Method: half a hello, half a request, a
// request at one byte per second, and nothing at all, with their closing times.
TEST_CASE("server_ends_who_stops_in_a_message_or_is_silent_for_too_long") {
  ServerOptions options;
  options.message_timeout_ns = 2000 * kMs;
  options.idle_timeout_ns = 5000 * kMs;
  ServerRig rig(options);
  std::vector<std::uint8_t> hello = hello_bytes(), request = request_bytes(frame_request("cube", 1));
  ScriptedClient half_hello(&rig, false), half_request(&rig), trickling(&rig), silent(&rig);
  half_hello.send_bytes({hello.begin(), hello.begin() + 10});
  half_request.send_bytes({request.begin(), request.begin() + 50});
  ScriptedClient* clients[] = {&half_hello, &half_request, &trickling, &silent};
  double seconds[4] = {0, 0, 0, 0};
  std::uint64_t start = rig.now();
  std::size_t trickled = 0;
  rig.run_until([&] {
    std::uint64_t now = rig.now();
    if (!trickling.closed && (now - start) / (1000 * kMs) >= trickled) trickling.send_bytes({request[trickled++]});
    for (int i = 0; i < 4; ++i) {
      clients[i]->poll();
      if (clients[i]->closed && seconds[i] == 0) seconds[i] = static_cast<double>(now - start) * 1e-9;
    }
    return silent.closed;
  });
  const double expected[4] = {2, 2, 2, 5};
  for (int i = 0; i < 4; ++i) {
    CAPTURE(i);
    CHECK(seconds[i] == doctest::Approx(expected[i]).epsilon(0.1));
  }
  CHECK(client_count(*rig.server) == 0);
  check_serves(&rig);
}

// Goal: one client too many is told so at once, and admitted when a place is free. Method: eight, a ninth and twenty
// more, then one of the eight leaves.
TEST_CASE("server_tells_one_client_too_many_that_it_is_busy") {
  ServerRig rig;
  std::vector<std::unique_ptr<ScriptedClient>> clients;
  for (int i = 0; i < 8; ++i) clients.push_back(std::make_unique<ScriptedClient>(&rig));
  for (auto& client : clients) client->wait_for(MessageType::hello);
  for (int i = 0; i < 20; ++i) {
    ScriptedClient ninth(&rig);
    ninth.wait_for(MessageType::hello);
    CHECK(ninth.wait_for(MessageType::error)->message.error.code == WireError::busy);
    if (i < 3) rig.run_until([&] { return ninth.poll(), ninth.closed; });
  }
  CHECK(client_count(*rig.server) == 8);
  // Those that do not leave are closed in time, the first ones at once if there are many.
  std::vector<std::unique_ptr<ScriptedClient>> late;
  for (int i = 0; i < 20; ++i) {
    late.push_back(std::make_unique<ScriptedClient>(&rig));
    late.back()->wait_for(MessageType::error);
  }
  auto poll_late = [&] {
    for (auto& client : late) client->poll();
    return late[19]->closed;
  };
  poll_late();
  CHECK(late[3]->closed);
  CHECK_FALSE(late[19]->closed);
  rig.run_until(poll_late, 3000 * kMs);
  clients.pop_back();
  rig.run_until([&] { return client_count(*rig.server) == 7; });
  check_serves(&rig);
}

// Goal: a thousand connections leave nothing behind. Method: each leaves at once, within its hello, during a frame or
// after one, or sends malformed data; then the server still renders, with all places free.
TEST_CASE("server_state_stays_bounded_over_a_thousand_connections") {
  ServerRig rig;
  Rng rng = make_rng(5);
  for (int i = 0; i < 1000; ++i) {
    rig.step();  // admits the latest
    rig.run_until([&] { return client_count(*rig.server) < 4; });
    ScriptedClient client(&rig, false);
    std::vector<std::uint8_t> hello = hello_bytes();
    FrameRequest request = frame_request("cube", 1, 16, 12);
    switch (next_u32(&rng) % 5) {
      case 0:
        break;
      case 1:
        client.send_bytes({hello.begin(), hello.begin() + 9});
        break;
      case 2:
        client.send_bytes(hello);
        client.request(request);
        rig.step();
        break;
      case 3:
        client.send_bytes(hello);
        client.request(request);
        client.wait_for_rows(12);
        break;
      case 4:
        client.send_bytes({0xff, 0xff});
        break;
    }
    CHECK(client_count(*rig.server) <= 8);
  }
  rig.run_until([&] { return client_count(*rig.server) == 0; });
  std::uint64_t later = rig.now() + 2000 * kMs;
  rig.run_until([&] { return rig.now() >= later; });
  check_serves(&rig);
  double seconds = static_cast<double>(platform::null_link_record(rig.link).elapsed_ns) * 1e-9;
  CHECK(static_cast<double>(rig.log.size()) < 45 + seconds);  // a flood does not fill the disk
  CHECK(rig.logged("omitted"));
}

// Goal: answers to a client that never reads are bounded. Method: valid pings of 64 KiB, for as long as they are
// accepted.
TEST_CASE("server_reads_no_more_than_it_can_answer") {
  ServerOptions options;
  options.stall_timeout_ns = 1000 * kMs;
  ServerRig rig(options);
  ScriptedClient client(&rig);
  client.reads = false;
  Message ping;
  ping.type = MessageType::ping;
  ping.ping = {1, kPingBytesMax};
  std::vector<std::uint8_t> many, one = bytes_of(ping);
  for (int i = 0; i < 5000; ++i) many.insert(many.end(), one.begin(), one.end());
  client.send_bytes(many);
  rig.run_until([&] { return client_count(*rig.server) == 0; });
  CHECK(rig.logged("does not read its answers"));
  check_serves(&rig);
}

// Goal: a slow reader still gets everything, complete and in order. Method: 150 pings of 60 000 bytes, more than eight
// times what the server queues, over a line whose other end is read a little at a time.
TEST_CASE("server_answers_in_order_however_slowly_it_is_read") {
  ServerRig rig;
  ScriptedClient client(&rig);
  Message ping;
  ping.type = MessageType::ping;
  std::vector<std::uint8_t> many;
  constexpr std::uint32_t kCount = 150;
  for (std::uint32_t i = 1; i <= kCount; ++i) {
    ping.ping = {i, 60'000};
    std::vector<std::uint8_t> one = bytes_of(ping);
    many.insert(many.end(), one.begin(), one.end());
  }
  client.send_bytes(many);
  for (int i = 0; i < 100; ++i) rig.step();
  rig.run_until([&] { return client.poll(), client.received.size() > kCount; });
  for (std::uint32_t i = 1; i <= kCount; ++i) {
    CHECK(client.received[i]->message.pong.id == i);
    CHECK(client.received[i]->message.pong.bytes.count == 60'000);
  }
}

// Goal: many messages at once are all answered without delay, though no client occupies the server for more than a few
// of them. Method: 200 pings in one write; the server may sleep for a second in every step.
TEST_CASE("server_answers_many_messages_without_delay") {
  ServerRig rig;
  ScriptedClient client(&rig);
  client.wait_for(MessageType::hello);
  Message ping;
  ping.type = MessageType::ping;
  std::vector<std::uint8_t> many, one = bytes_of(ping);
  for (int i = 0; i < 200; ++i) many.insert(many.end(), one.begin(), one.end());
  std::uint64_t start = rig.now();
  client.send_bytes(many);
  while (client.received.size() < 200 && rig.now() - start < 5000 * kMs) {
    rig.step(1000 * kMs);
    client.poll();
  }
  CHECK(rig.now() - start < 100 * kMs);
}

// Goal: clients are told when the server shuts down. Method: close it while one waits for a frame.
TEST_CASE("server_says_that_it_ends") {
  ServerOptions options;
  options.pace.ns_per_pixel = 1000;
  ServerRig rig(options);
  ScriptedClient client(&rig);
  client.request(frame_request("cornell", 1));
  rig.run_until([&] { return client.poll(), client.rows_come >= 8; });
  rig.close();
  for (int i = 0; i < 100 && !client.closed; ++i) {
    client.poll();
    rig.net->poll(rig.link, nullptr, 0, kMs);
  }
  CHECK(client.closed);
  CHECK(client.has_error(WireError::closing));
}

// Goal: a line of the log has the client's address once. Method: a reset in each direction, while rows are on their
// way.
TEST_CASE("server_logs_a_lost_client_by_one_name") {
  for (bool to_device : {false, true}) {
    CAPTURE(to_device);
    const std::size_t greeting = hello_bytes().size(), asking = request_bytes(frame_request("cube", 1)).size();
    const platform::NullFault fault = {platform::LinkFault::reset, 0, to_device, greeting + asking / 2};
    platform::NullLinkSettings settings;
    settings.faults = &fault, settings.fault_count = 1;
    ServerRig rig(ServerOptions(), settings);
    ScriptedClient client(&rig);
    rig.run_until([&] { return client_count(*rig.server) == 1; });
    client.request(frame_request("cube", 1));
    rig.run_until([&] { return client.poll(), rig.logged("disconnected after"); });
    REQUIRE_FALSE(rig.log.empty());
    const std::string& line = rig.log.back();
    const std::string name = line.substr(0, line.find(' '));
    CHECK_MESSAGE(line.find(": the peer closed the connection") != std::string::npos, line);
    CHECK_MESSAGE(line.find(name, name.size()) == std::string::npos, line);
  }
}
