// How long a device waits for servers that start well but deliver nothing, and what it logs.
#include <doctest/doctest.h>

#include <cmath>

#include "hostile_rig.h"
#include "remote/client/parts.h"

using namespace pocketray;

namespace {

constexpr double kSecond = 1e9;

struct Failing {
  const char* what;
  double patience_s;  // of a device without the scene
  // Selects messages to fail on: silently, or with `hangs_up` by closing the connection.
  bool (*fails)(const Message& message);
  bool hangs_up, errs, dies;  // dies: answers nothing more on this connection
};
bool after_hello(const Message& m) { return m.type != MessageType::hello; }
bool after_pings(const Message& m) {
  return after_hello(m) && m.type != MessageType::scene_query && m.type != MessageType::ping;
}

constexpr Failing kFailing[] = {
    {"hangs up after its hello", 5, after_hello, true, false},
    {"falls silent after its hello", 5, after_hello, false, false},
    {"hangs up when it is asked for rows", 5, after_pings, true, false},
    {"refuses rows", 5, after_pings, false, true},
    {"falls silent when it is asked for rows", 5, after_pings, false, false, true},
    {"answers pings alone", 30, after_pings, false, false},
};

// Seconds until the device gives up its frame, or `seconds`.
double wait_for_rows(HostileRig* rig, double seconds) {
  std::uint64_t begin = rig->fake.now(), end = begin + static_cast<std::uint64_t>(seconds * kSecond);
  REQUIRE(begin_frame(&rig->device->renderer, &rig->client, 0).ok);
  while (!is_cut_off(rig->client) && rig->fake.now() < end)
    if (advance_frame(&rig->device->renderer, &rig->client, rig->fake.now() + 100 * kMs)) break;
  return static_cast<double>(rig->fake.now() - begin) / kSecond;
}

}  // namespace

// Goal: without the scene, a device gives up on a server that sends no rows after five seconds, or thirty if it is
// alive; it logs the reason once and retries at growing intervals. Method: a server greets and then fails in every way;
// time until the device gives up, connections and log lines in 45 s.
TEST_CASE("thin_client_gives_up_on_a_server_that_gives_no_rows") {
  for (const Failing& failing : kFailing) {
    CAPTURE(failing.what);
    HostileRig rig(false);
    bool dead = false;
    rig.act = [&](HostileRig* r, const Message& message) -> std::vector<Message> {
      dead = dead && message.type != MessageType::hello;
      if (!dead && !failing.fails(message)) return r->answer(message);
      dead = failing.dies;
      if (failing.hangs_up) r->fake.hang_up();
      if (!failing.errs) return {};
      Message error;
      error.type = MessageType::error;
      error.error.code = WireError::too_large;
      return {error};
    };
    double took = wait_for_rows(&rig, 45);
    CHECK(took >= failing.patience_s);
    CHECK(took < failing.patience_s + 0.5);
    while (rig.fake.now() < static_cast<std::uint64_t>(46 * kSecond) + 1'000'000'000)
      advance_client(&rig.client, 100 * kMs);
    CHECK(rig.fake.connection_count <= 9);
    CHECK(rig.log.size() <= 1);
    // It finally sends rows and is used.
    rig.act = nullptr;
    CHECK(wait_for_rows(&rig, 60) < 45);
    CHECK(has_all_rows(rig.client));
    CHECK(rig.log.size() % 2 == 0);
  }
}

// Goal: a slow server does not count as dead. Method: a chunk every four seconds, pings in between, so that a frame
// takes longer than any time-out.
TEST_CASE("thin_client_is_patient_with_a_slow_server") {
  HostileRig rig(false);
  std::vector<Message> kept;
  std::uint64_t next_ns = 0;
  std::size_t sent = 0;
  rig.act = [&](HostileRig* r, const Message& message) -> std::vector<Message> {
    if (!r->note_request(message)) return r->answer(message);
    kept = r->rows.rows(r->request);
    sent = 0, next_ns = r->fake.now() + 4000 * kMs;
    return {};
  };
  rig.fake.flood = [&]() -> std::vector<std::uint8_t> {
    if (sent == kept.size() || rig.fake.now() < next_ns) return {};
    next_ns = rig.fake.now() + 4000 * kMs;
    return bytes_of(kept[sent++]);
  };
  CHECK(wait_for_rows(&rig, 60) > 25);
  CHECK(has_all_rows(rig.client));
  CHECK(rig.log.empty());
}

// Goal: a server that comes and goes is logged at growing intervals. Method: one that repeatedly sends the rows of a
// frame or two and hangs up, with and without the scene on the device.
TEST_CASE("client_backs_off_from_a_server_that_comes_and_goes") {
  for (bool has_scene : {true, false}) {
    CAPTURE(has_scene);
    HostileRig rig(has_scene);
    int frames = 0;
    rig.act = [&](HostileRig* r, const Message& message) -> std::vector<Message> {
      if (message.type != MessageType::frame_request && message.type != MessageType::frame_change)
        return r->answer(message);
      if (++frames % 3 == 0) return r->fake.hang_up(), std::vector<Message>();
      return r->answer(message);
    };
    std::uint64_t end = rig.fake.now() + 45'000 * kMs;
    while (rig.fake.now() < end) {
      REQUIRE(begin_frame(&rig.device->renderer, &rig.client, 0).ok);
      while (!advance_frame(&rig.device->renderer, &rig.client, rig.fake.now() + 100 * kMs) && rig.fake.now() < end) {
      }
    }
    CHECK(rig.fake.connection_count >= 3);
    CHECK(rig.fake.connection_count <= 9);
    CHECK(rig.log.size() <= 18);
  }
}

// Goal: a device that is done with its own rows goes on with those that its server would send last, so that the two
// meet and no row is rendered twice. Method: a server that holds its rows back; the rows that the device takes one
// after the other, against the request's order backwards.
TEST_CASE("client_goes_on_with_the_rows_a_server_sends_last") {
  HostileRig rig;
  rig.frames_until_ready();
  Client* client = &rig.client;
  client->options.device_share = 0.25;
  // The lower rows are dear to send, so that the order is not simply from the bottom upward.
  for (std::uint32_t row = 0; row < kHeight; ++row) {
    client->plan.model.rows[row].bytes = Smoothed();
    smooth(&client->plan.model.rows[row].bytes, row < 32 ? 4000.0 : 10.0);
  }
  std::vector<Message> none;
  rig.act = [&](HostileRig* r, const Message& message) { return r->note_request(message) ? none : r->answer(message); };
  REQUIRE(begin_frame(&rig.device->renderer, client, 0).ok);
  std::vector<std::uint32_t> expected, taken;
  const FrameRequest asked = client->servers[0].rows.asked;
  REQUIRE(asked.run_count > 1);
  REQUIRE(asked.row_begin == kHeight / 4);
  CHECK(first_rows(asked).row_end != asked.row_end);
  for (std::uint32_t row = 0; row < asked.row_begin; ++row) expected.push_back(row);
  for (std::uint32_t place = asked.run_count; place-- > 0;)
    for (std::uint32_t row = run_at(asked, place).begin; row < run_at(asked, place).end; ++row) expected.push_back(row);
  std::uint32_t begin, end;
  while (take_device_rows(client, 8, &begin, &end)) {
    for (std::uint32_t row = begin; row < end; ++row) taken.push_back(row);
    finish_device_rows(client, begin, end, 1000, (end - begin) * kWidth);
  }
  CHECK(taken == expected);
  CHECK(has_all_rows(*client));
  end_client_frame(client);
}

// Goal: a device waits for answers a part of the time that its own rows take, of which a guess for rows that it never
// rendered says nothing. Method: the time left to wait in a frame under way, with guesses a hundred times as high.
TEST_CASE("client_waits_no_longer_for_rows_it_never_measured") {
  HostileRig rig;
  rig.frames_until_ready();
  Client* client = &rig.client;
  client->options.device_share = 0.25;
  REQUIRE(begin_frame(&rig.device->renderer, client, 0).ok);
  std::uint32_t begin, end, guesses = 0;
  REQUIRE(take_device_rows(client, 2, &begin, &end));
  finish_device_rows(client, begin, end, 1000, (end - begin) * kWidth);
  const double left_ns = time_to_spare(*client, 0);
  for (RowModel& row : client->plan.model.rows)
    if (row.guessed) ++guesses, row.device_ns.value *= 100;
  CHECK_GT(guesses, kHeight / 2);
  CHECK(std::fabs(time_to_spare(*client, 0) - left_ns) < 1000);  // the clock goes on
  while (take_device_rows(client, 8, &begin, &end))
    finish_device_rows(client, begin, end, 1000, (end - begin) * kWidth);
  end_client_frame(client);
}
