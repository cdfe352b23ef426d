// The simulated link alone: its line takes the right time, its faults strike in the right place, and a seed replays.
#include "platform/null/net/null_link.h"

#include <doctest/doctest.h>

#include <algorithm>

#include "link_rig.h"
#include "support/effort.h"
#include "support/link_fault.h"

using namespace platform;
using pocketray::draw_link_faults;
using pocketray::link_fault_name;

namespace {

NullLinkSettings with_fault(const NullFault& fault) {
  NullLinkSettings settings;
  settings.latency_ns = kMs;
  settings.faults = &fault;
  settings.fault_count = 1;
  return settings;
}

std::uint64_t elapsed_ns(const LinkRig& rig) { return null_link_record(rig.link).elapsed_ns; }

}  // namespace

// Goal: bytes take latency and their share of the bandwidth, and connecting takes a round trip. Method: closed form, to
// within the clock's own steps.
TEST_CASE("null_link_takes_the_time_of_its_line") {
  NullLinkSettings settings;
  settings.bytes_per_second = 1'000'000;
  settings.latency_ns = 5 * kMs;
  settings.clock_step_ns = 0;
  LinkRig rig(kNullLink, 6, settings);
  int device[2] = {-1, -1}, server[2] = {-1, -1};
  REQUIRE(rig.pair(&device[0], &server[0]));
  CHECK(elapsed_ns(rig) == 10 * kMs);
  REQUIRE(rig.pair(&device[1], &server[1]));
  LinkResult result;
  std::uint64_t begin_ns = elapsed_ns(rig);
  REQUIRE(rig.write_all(server[0], counted_bytes(20000)));
  REQUIRE(rig.write_all(server[1], counted_bytes(10000)));  // shares the device's radio, so it arrives later
  REQUIRE(rig.write_all(device[0], counted_bytes(1000)));   // the other direction does not
  CHECK(rig.read_all(server[0], 1000, &result).size() == 1000);
  CHECK(elapsed_ns(rig) - begin_ns == 6 * kMs);
  CHECK(rig.read_all(device[0], 20000, &result) == counted_bytes(20000));
  CHECK(elapsed_ns(rig) - begin_ns == 25 * kMs);
  CHECK(rig.read_all(device[1], 10000, &result).size() == 10000);
  CHECK(elapsed_ns(rig) - begin_ns == 35 * kMs);
}

// Goal: a lost piece is repeated when TCP would repeat it, and those after it wait: a round trip after the third of
// them, by time where fewer follow, and later still where nothing else is on its way. Method: closed form. The first
// piece is lost, by a seed found for that, and none, one, two or three follow.
TEST_CASE("null_link_repeats_what_is_lost_as_tcp_does") {
  const std::uint64_t latency = 20 * kMs, expected[] = {5 * latency + 210 * kMs, 5 * latency + 10 * kMs,
                                                        5 * latency + 10 * kMs, 3 * latency};
  for (std::size_t later = 0; later < 4; ++later) {
    CAPTURE(later);
    LinkLine line;
    line.latency_ns = latency, line.lost_per_million = 100'000;
    std::vector<unsigned char> memory(pipe_need(65536) + 16);
    auto* at = reinterpret_cast<unsigned char*>((reinterpret_cast<std::uintptr_t>(memory.data()) + 15) / 16 * 16);
    LinkPipe pipe = {};
    place_pipe(&pipe, 65536, &at);
    // The first piece is lost once, the others are not.
    std::uint64_t seed = 0;
    for (bool found = false; !found; ++seed) {
      std::uint64_t random = seed;
      found = random_u64(&random) % 1'000'000 < line.lost_per_million;
      for (int i = 0; i < 4; ++i) found = found && random_u64(&random) % 1'000'000 >= line.lost_per_million;
    }
    --seed;
    reset_pipe(&pipe);
    const unsigned char byte = 7;
    for (std::size_t i = 0; i <= later; ++i) {
      push_piece(&pipe, &byte, 1, 0, latency);
      lose_piece(line, &pipe, &seed);
    }
    for (std::size_t i = 0; i <= later; ++i) CHECK(pipe.pieces[i].arrival_ns == expected[later]);
    CHECK(pipe.arrival_last_ns == expected[later]);
  }
}

// Goal: a line loses as many pieces as it should, delivers every byte in order, and repeats by its seed. Method: a long
// transfer of single bytes, each awaited before the next, so that each loss shows.
TEST_CASE("null_link_loses_its_share") {
  std::vector<std::uint64_t> runs[2];
  for (std::vector<std::uint64_t>& times : runs) {
    NullLinkSettings settings;
    settings.latency_ns = kMs, settings.lost_per_million = 50'000, settings.clock_step_ns = 0;
    LinkRig rig(kNullLink, 4, settings);
    int device = -1, server = -1;
    REQUIRE(rig.pair(&device, &server));
    LinkResult result;
    for (int i = 0; i < 2000; ++i) {
      const std::uint64_t begin_ns = elapsed_ns(rig);
      const std::string byte(1, static_cast<char>(i));
      REQUIRE(rig.write_all(server, byte));
      REQUIRE(rig.read_all(device, 1, &result) == byte);
      times.push_back(elapsed_ns(rig) - begin_ns);
    }
    const auto lost = std::count_if(times.begin(), times.end(), [](std::uint64_t ns) { return ns > kMs; });
    CHECK(lost > 70);
    CHECK(lost < 130);
  }
  CHECK(runs[0] == runs[1]);
}

// Goal: jitter stays within its bound, and nothing overtakes. Method: single bytes, each timed.
TEST_CASE("null_link_jitter_keeps_the_order") {
  NullLinkSettings settings;
  settings.latency_ns = 2 * kMs;
  settings.jitter_ns = 3 * kMs;
  settings.clock_step_ns = 0;
  LinkRig rig(kNullLink, 4, settings);
  int device = -1, server = -1;
  REQUIRE(rig.pair(&device, &server));
  const std::string bytes = counted_bytes(100);
  std::uint64_t least_ns = ~std::uint64_t{0}, most_ns = 0;
  for (char c : bytes) {
    LinkResult result;
    std::uint64_t begin_ns = elapsed_ns(rig);
    REQUIRE(rig.write_all(server, std::string(1, c)));
    REQUIRE(rig.read_all(device, 1, &result) == std::string(1, c));
    std::uint64_t passed_ns = elapsed_ns(rig) - begin_ns;
    least_ns = passed_ns < least_ns ? passed_ns : least_ns;
    most_ns = passed_ns > most_ns ? passed_ns : most_ns;
  }
  CHECK(least_ns >= 2 * kMs);
  CHECK(most_ns <= 5 * kMs);
  CHECK(most_ns - least_ns > kMs);
  // Neither does the end: whenever poll() reports it, there is something to read.
  for (char c : bytes) REQUIRE(rig.write_all(server, std::string(1, c)));
  rig.net->close(rig.link, server);
  LinkResult result = LinkResult::done;
  std::string got;
  while (result == LinkResult::done && rig.wait(device, true, false)) {
    char byte;
    std::size_t count;
    result = rig.net->read(rig.link, device, &byte, 1, &count, &rig.error);
    got.append(&byte, count);
  }
  CHECK(result == LinkResult::ended);
  CHECK(got == bytes);
}

// Goal: every fault acts as documented, at its byte. Method: send 100 bytes with a fault at each of several in turn.
TEST_CASE("null_link_faults_strike_where_they_should") {
  const std::string bytes = counted_bytes(100);
  for (int kind = 0; kind < kLinkFaultCount; ++kind)
    for (std::uint64_t at_byte : {0u, 1u, 42u, 99u}) {
      NullFault fault;
      fault.fault = static_cast<LinkFault>(kind);
      fault.at_byte = at_byte;
      CAPTURE(std::string(link_fault_name(fault.fault)));
      CAPTURE(at_byte);
      LinkRig rig(kNullLink, 4, with_fault(fault));
      int device = -1, server = -1;
      if (fault.fault == LinkFault::refuse || fault.fault == LinkFault::no_answer) {
        bool refused = fault.fault == LinkFault::refuse;
        device = rig.net->connect(rig.link, rig.address, 70 * kMs, &rig.error);
        CHECK(rig.wait(device, false, true));
        CHECK(elapsed_ns(rig) == (refused ? 2 * kMs : 70 * kMs));
        CHECK(rig.net->connected(rig.link, device, &rig.error) == LinkResult::failed);
        CHECK(std::strstr(rig.error.text, refused ? "nothing is listening" : "no answer") != nullptr);
        CHECK(null_link_record(rig.link).faults_struck == 1);
        continue;
      }
      REQUIRE(rig.pair(&device, &server));
      std::uint64_t before_ns = rig.net->now_ns(rig.link), begin_ns = elapsed_ns(rig);
      std::size_t count = 0;
      LinkResult result = rig.net->write(rig.link, server, bytes.data(), bytes.size(), &count, &rig.error);
      CHECK((result == LinkResult::done || (at_byte == 0 && result == LinkResult::failed)));
      CHECK((rig.net->now_ns(rig.link) < before_ns) == (fault.fault == LinkFault::clock_back));
      std::string got = rig.read_all(device, 200, &result, 200'000 * kMs), wanted = bytes;
      std::size_t at = static_cast<std::size_t>(at_byte);
      switch (fault.fault) {
        case LinkFault::reset:
          CHECK(result == LinkResult::failed);
          wanted = bytes.substr(0, at);
          break;
        case LinkFault::truncate:
          CHECK(result == LinkResult::ended);
          wanted = bytes.substr(0, at);
          break;
        case LinkFault::flip: {
          REQUIRE(got.size() == 100);
          unsigned change = static_cast<unsigned char>(got[at] ^ bytes[at]);
          CHECK((change != 0 && (change & (change - 1)) == 0));
          wanted[at] = got[at];
          break;
        }
        case LinkFault::duplicate:
          wanted = bytes + bytes.substr(at);
          break;
        case LinkFault::silence:
          CHECK(result == LinkResult::later);
          wanted = bytes.substr(0, at);
          break;
        case LinkFault::trickle:
          CHECK(elapsed_ns(rig) - begin_ns >= (100 - at_byte) * 1000 * kMs);
          break;
        default:
          break;
      }
      CHECK(got == wanted);
      CHECK(null_link_record(rig.link).faults_struck == 1);
    }
}

// Goal: a fault strikes only its own connection and direction. Method: the second of three.
TEST_CASE("null_link_fault_strikes_one_connection") {
  NullFault fault;
  fault.fault = LinkFault::truncate;
  fault.connection = 1;
  fault.to_device = false;
  LinkRig rig(kNullLink, 4, with_fault(fault));
  for (int i = 0; i < 3; ++i) {
    CAPTURE(i);
    int device = -1, server = -1;
    LinkResult result;
    REQUIRE(rig.pair(&device, &server));
    REQUIRE(rig.write_all(server, "to the device"));
    CHECK(rig.read_all(device, 13, &result) == "to the device");
    CHECK(rig.write_all(device, "x") == (i != 1));
    CHECK(rig.read_all(server, 1, &result) == (i != 1 ? "x" : ""));
    rig.net->close(rig.link, device);
    rig.net->close(rig.link, server);
  }
}

namespace {

// A session in which both ends write and read at random under four faults; returns a hash of all events.
std::uint64_t session(std::uint64_t seed, NullLinkRecord* record) {
  NullFault faults[4];
  draw_link_faults(seed, 2, 4000, faults, 4);
  NullLinkSettings settings;
  settings.bytes_per_second = 500'000;
  settings.latency_ns = settings.jitter_ns = 2 * kMs;
  settings.pipe_bytes = 2048;
  settings.seed = seed;
  settings.faults = faults;
  settings.fault_count = 4;
  LinkRig rig(kNullLink, 3, settings);
  std::uint64_t course = seed;
  char part[512];
  for (int connection = 0; connection < 3; ++connection) {
    int ends[2] = {-1, -1};
    bool up = rig.pair(&ends[0], &ends[1]);
    for (int round = 0; round < 20 && up; ++round) {
      LinkWait waits[2];
      for (int i = 0; i < 2; ++i) {
        waits[i].stream = ends[i];
        waits[i].want_read = true;
        std::size_t count = 0;
        std::memset(part, round, sizeof part);
        up = rig.net->write(rig.link, ends[i], part, 64 + (seed + static_cast<unsigned>(round)) % 448, &count,
                            &rig.error) != LinkResult::failed;
        course = course * 31 + count;
      }
      rig.net->poll(rig.link, waits, 2, 50 * kMs);
      for (int end : ends) {
        std::size_t count = 0;
        LinkResult result = rig.net->read(rig.link, end, part, sizeof part, &count, &rig.error);
        for (std::size_t i = 0; i < count; ++i) course = course * 31 + static_cast<unsigned char>(part[i]);
        course = course * 31 + static_cast<std::uint64_t>(result);
      }
      course = course * 31 + rig.net->now_ns(rig.link);
    }
    for (int end : ends) rig.net->close(rig.link, end);
    // A peer never accepted occupies a slot until the listener accepts it.
    int late = -1;
    if (ends[1] < 0 && rig.wait(rig.listener, true, false, 10 * kMs) &&
        rig.net->accept(rig.link, rig.listener, &late, &rig.error) == LinkResult::done)
      rig.net->close(rig.link, late);
  }
  *record = null_link_record(rig.link);
  CHECK(record->connection_count == 3);  // whatever happened, the next connection had its slot
  return course;
}

}  // namespace

// Goal: the same seed gives the same course of events, other seeds others, and every session ends. Method: sessions by
// seed, each twice; simulated time bounds real time.
TEST_CASE("null_link_sessions_replay_by_seed") {
  std::uint64_t last = 0;
  int struck = 0;
  for (int seed = 1; seed <= pocketray::effort(2000); ++seed) {
    CAPTURE(seed);
    NullLinkRecord first, second;
    std::uint64_t course = session(static_cast<std::uint64_t>(seed), &first);
    REQUIRE(course == session(static_cast<std::uint64_t>(seed), &second));
    REQUIRE(first.elapsed_ns == second.elapsed_ns);
    CHECK(course != last);
    CHECK(first.elapsed_ns < 20'000 * kMs);
    struck += first.faults_struck;
    last = course;
  }
  MESSAGE(pocketray::effort(2000) << " sessions, " << struck << " faults struck");
  CHECK(struck > pocketray::effort(2000));
}

// Goal: other clients of the server share neither the device's radio nor its faults, and have their own addresses.
// Method: a slow line; data sent to the other client takes none of its time.
TEST_CASE("null_link_connects_from_elsewhere") {
  NullFault fault;
  fault.fault = LinkFault::reset, fault.at_byte = 10;
  NullLinkSettings settings = with_fault(fault);
  settings.bytes_per_second = 1'000'000;
  settings.clock_step_ns = 0;
  LinkRig rig(kNullLink, 6, settings);
  int other = null_link_connect_from(rig.link, "10.0.0.7", rig.address, kMs * 100, &rig.error);
  REQUIRE(other >= 0);
  LinkWait wait = {};
  wait.stream = rig.listener, wait.want_read = true;
  REQUIRE(rig.net->poll(rig.link, &wait, 1, 100 * kMs) == 1);
  int server = -1;
  REQUIRE(rig.net->accept(rig.link, rig.listener, &server, &rig.error) == LinkResult::done);
  CHECK(std::string(rig.net->stream_name(rig.link, server)).substr(0, 9) == "10.0.0.7:");
  rig.net->poll(rig.link, nullptr, 0, kMs);
  std::uint64_t begin_ns = elapsed_ns(rig);
  LinkResult result;
  REQUIRE(rig.write_all(server, counted_bytes(20000)));
  CHECK(rig.read_all(other, 20000, &result) == counted_bytes(20000));
  CHECK(elapsed_ns(rig) - begin_ns == kMs);
  CHECK(null_link_record(rig.link).faults_struck == 0);
  CHECK(null_link_record(rig.link).connection_count == 0);
}

// Goal: waiting for a closed stream returns at once, whatever it waits for.
TEST_CASE("null_link_poll_tells_of_stale_streams") {
  LinkRig rig(kNullLink, 6);
  int device = -1, server = -1;
  REQUIRE(rig.pair(&device, &server));
  rig.net->close(rig.link, device);
  LinkWait wait = {};
  wait.stream = device, wait.want_write = true;
  CHECK(rig.net->poll(rig.link, &wait, 1, kMs) == 1);
  CHECK(wait.can_write);
}
