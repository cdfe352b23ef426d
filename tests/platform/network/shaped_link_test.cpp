// The radio of an emulated device: its line takes the right time, over the simulated link and by its clock alone.
#include "platform/net/shaped_link.h"

#include <doctest/doctest.h>

#include <cmath>

#include "link_rig.h"
#include "platform/devices/device_list.h"

using namespace platform;

namespace {

ShapedLinkSettings radio(std::uint64_t bytes_per_second, std::uint64_t latency_ns, std::uint64_t jitter_ns = 0) {
  ShapedLinkSettings settings;
  settings.line = {bytes_per_second, latency_ns, jitter_ns};
  return settings;
}

// The inner link: a line without limits, and a clock that only runs while waiting.
NullLinkSettings ideal() {
  NullLinkSettings settings;
  settings.clock_step_ns = 0;
  return settings;
}

std::uint64_t elapsed_ns(const LinkRig& rig) { return null_link_record(rig.inner).elapsed_ns; }

// Carries `byte_count` bytes from one end to the other in one loop; returns what arrived, and when the last byte did.
std::string carry(LinkRig* rig, int from, int to, std::size_t byte_count, std::uint64_t* passed_ns) {
  const std::string bytes = counted_bytes(byte_count);
  std::string got;
  char part[5000];
  std::uint64_t begin_ns = rig->net->now_ns(rig->link);
  for (std::size_t sent = 0; got.size() < byte_count;) {
    LinkWait waits[2];
    waits[0].stream = to;
    waits[0].want_read = true;
    waits[1].stream = from;
    waits[1].want_write = sent < byte_count;
    if (rig->net->poll(rig->link, waits, 2, 20'000 * kMs) == 0) break;
    std::size_t count = 0;
    if (waits[1].can_write)
      rig->net->write(rig->link, from, bytes.data() + sent, byte_count - sent, &count, &rig->error);
    sent += count;
    count = 0;
    if (waits[0].can_read) rig->net->read(rig->link, to, part, sizeof part, &count, &rig->error);
    got.append(part, count);
  }
  *passed_ns = rig->net->now_ns(rig->link) - begin_ns;
  CHECK(got == bytes);
  return got;
}

}  // namespace

// Goal: bytes take latency and their share of the bandwidth, to and from the device, in one piece or many, and
// connecting takes a round trip. Method: closed form, to the nanosecond apart from the rounding of each piece.
TEST_CASE("shaped_link_takes_the_time_of_its_line") {
  LinkRig rig(kShapedNull, 6, ideal(), radio(1'000'000, 5 * kMs));
  int device = -1, server = -1;
  REQUIRE(rig.pair(&device, &server));
  CHECK(elapsed_ns(rig) == 10 * kMs);
  for (std::size_t byte_count : {1u, 1000u, 1460u, 20'000u, 3'000'000u})
    for (bool to_device : {true, false}) {
      CAPTURE(byte_count);
      CAPTURE(to_device);
      std::uint64_t passed_ns;
      carry(&rig, to_device ? server : device, to_device ? device : server, byte_count, &passed_ns);
      CHECK(passed_ns == byte_count * 1000 + 5 * kMs);
    }
}

// Goal: all connections of the device share its radio, its two directions do not. Method: as above, with two of them.
TEST_CASE("shaped_link_connections_share_one_radio") {
  LinkRig rig(kShapedNull, 6, ideal(), radio(1'000'000, 5 * kMs));
  int device[2] = {-1, -1}, server[2] = {-1, -1};
  for (int i = 0; i < 2; ++i) REQUIRE(rig.pair(&device[i], &server[i]));
  LinkResult result;
  std::uint64_t begin_ns = elapsed_ns(rig);
  REQUIRE(rig.write_all(server[0], counted_bytes(20000)));
  REQUIRE(rig.write_all(server[1], counted_bytes(10000)));
  REQUIRE(rig.write_all(device[0], counted_bytes(1000)));
  CHECK(rig.read_all(server[0], 1000, &result).size() == 1000);
  CHECK(elapsed_ns(rig) - begin_ns == 6 * kMs);
  CHECK(rig.read_all(device[0], 20000, &result).size() == 20000);
  CHECK(rig.read_all(device[1], 10000, &result).size() == 10000);
  CHECK(elapsed_ns(rig) - begin_ns == 35 * kMs);
}

// Goal: jitter stays within its bound, the order is kept, and a seed replays. Method: single bytes, each timed; twice
// with the same seed, once with another.
TEST_CASE("shaped_link_jitter_keeps_the_order_and_replays") {
  std::vector<std::uint64_t> courses[3];
  for (int run = 0; run < 3; ++run) {
    ShapedLinkSettings settings = radio(0, 2 * kMs, 3 * kMs);
    settings.seed = run < 2 ? 11 : 12;
    LinkRig rig(kShapedNull, 4, ideal(), settings);
    int device = -1, server = -1;
    REQUIRE(rig.pair(&device, &server));
    std::uint64_t least_ns = ~std::uint64_t{0}, most_ns = 0;
    for (char c : counted_bytes(100)) {
      LinkResult result;
      std::uint64_t begin_ns = elapsed_ns(rig);
      REQUIRE(rig.write_all(server, std::string(1, c)));
      REQUIRE(rig.read_all(device, 1, &result) == std::string(1, c));
      courses[run].push_back(elapsed_ns(rig) - begin_ns);
      least_ns = std::min(least_ns, courses[run].back());
      most_ns = std::max(most_ns, courses[run].back());
    }
    CHECK(least_ns >= 2 * kMs);
    CHECK(most_ns <= 5 * kMs);
    CHECK(most_ns - least_ns > kMs);
    const std::string bytes = counted_bytes(20000);
    LinkResult result;
    REQUIRE(rig.write_all(server, bytes));
    CHECK(rig.read_all(device, bytes.size(), &result) == bytes);
  }
  CHECK(courses[0] == courses[1]);
  CHECK(courses[0] != courses[2]);
}

// Goal: data in transit stays within the pipe, at either end, and the rest waits at its source. Method: neither end
// reads; the inner link holds 64 KiB of its own.
TEST_CASE("shaped_link_holds_no_more_than_its_pipe") {
  CHECK(shaped_pipe_bytes({1'000'000, 5 * kMs, 0}) == 65536);
  CHECK(shaped_pipe_bytes({4'000'000, 20 * kMs, 5 * kMs}) == 200'000);
  CHECK(shaped_pipe_bytes({0, 0, 0}) == kPiecesMax * kPieceBytesMax);
  CHECK(shaped_pipe_bytes({~std::uint64_t{0}, 3'600'000 * kMs, 0}) == kPiecesMax * kPieceBytesMax);
  LinkRig rig(kShapedNull, 6, ideal(), radio(1'000'000, 5 * kMs));
  int device = -1, server = -1;
  REQUIRE(rig.pair(&device, &server));
  for (bool to_device : {true, false}) {
    int from = to_device ? server : device, to = to_device ? device : server;
    const std::string part = counted_bytes(65536);
    std::size_t sent = 0, count = 1;
    for (int i = 0; i < 100 && count > 0; ++i) {
      LinkWait waits[2];
      waits[0].stream = from;
      waits[0].want_write = true;
      rig.net->poll(rig.link, waits, 1, 200 * kMs);
      rig.net->write(rig.link, from, part.data(), part.size(), &count, &rig.error);
      sent += count;
    }
    CHECK(sent <= 2 * 65536);
    CHECK(sent > 65536);
    LinkResult result;
    CHECK(rig.read_all(to, sent, &result).size() == sent);
    CHECK(rig.wait(from, false, true));
  }
}

// Goal: data written before close() still crosses, in its time, and then the peer sees the end; so it is with several
// streams that close in a full link. Method: write, close, read at the other end.
TEST_CASE("shaped_link_close_lets_travel_what_was_written") {
  for (int stream_count : {3, 6}) {
    LinkRig rig(kShapedNull, stream_count, ideal(), radio(1'000'000, 5 * kMs));
    for (int i = 0; i < 3; ++i) {
      int device = -1, server = -1;
      REQUIRE_MESSAGE(rig.pair(&device, &server), rig.error.text);
      std::uint64_t begin_ns = elapsed_ns(rig);
      REQUIRE(rig.write_all(device, counted_bytes(10'000)));
      rig.net->close(rig.link, device);
      std::size_t count;
      CHECK(rig.net->write(rig.link, device, "x", 1, &count, &rig.error) == LinkResult::failed);
      LinkResult result;
      CHECK(rig.read_all(server, 20'000, &result) == counted_bytes(10'000));
      CHECK(result == LinkResult::ended);
      CHECK(elapsed_ns(rig) - begin_ns == 15 * kMs);
      rig.net->close(rig.link, server);
    }
  }
}

// Goal: a closing stream gives its slot to a new one and loses nothing. Method: a link of three slots, over sockets,
// whose line would take ten seconds.
TEST_CASE("shaped_link_closing_gives_way_to_a_new_connection") {
  LinkRig rig(kShapedTcp, 3, NullLinkSettings(), radio(1000, kMs));
  int device = -1, server = -1;
  REQUIRE_MESSAGE(rig.pair(&device, &server), rig.error.text);
  REQUIRE(rig.write_all(device, counted_bytes(10'000)));
  rig.net->close(rig.link, device);
  device = rig.net->connect(rig.link, rig.address, 2000 * kMs, &rig.error);
  CHECK_MESSAGE(device >= 0, rig.error.text);
  LinkResult result;
  CHECK(rig.read_all(server, 20'000, &result) == counted_bytes(10'000));
  CHECK(result == LinkResult::ended);
}

// Goal: a radio too slow for the timeout of a connection reports that; a refusal takes a round trip. Method: a latency
// of 50 ms.
TEST_CASE("shaped_link_connecting_takes_a_round_trip_at_least") {
  LinkRig rig(kShapedNull, 4, ideal(), radio(1'000'000, 50 * kMs));
  int device = rig.net->connect(rig.link, rig.address, 70 * kMs, &rig.error);
  REQUIRE(rig.wait(device, false, true));
  CHECK(elapsed_ns(rig) == 70 * kMs);
  CHECK(rig.net->connected(rig.link, device, &rig.error) == LinkResult::failed);
  CHECK(std::strstr(rig.error.text, "no answer") != nullptr);
  rig.net->close(rig.link, device);
  rig.net->close(rig.link, rig.listener);
  device = rig.net->connect(rig.link, rig.address, 2000 * kMs, &rig.error);
  REQUIRE(rig.wait(device, false, true));
  CHECK(elapsed_ns(rig) == 170 * kMs);
  CHECK(rig.net->connected(rig.link, device, &rig.error) == LinkResult::failed);
  CHECK(std::strstr(rig.error.text, "nothing is listening") != nullptr);
}

// Goal: a clock set back costs no more than sending the data in transit again. Method: the fault of the inner link.
TEST_CASE("shaped_link_survives_a_clock_set_back") {
  NullFault fault;
  fault.fault = LinkFault::clock_back;
  fault.at_byte = 5000;
  NullLinkSettings below = ideal();
  below.faults = &fault;
  below.fault_count = 1;
  LinkRig rig(kShapedNull, 4, below, radio(1'000'000, 5 * kMs));
  int device = -1, server = -1;
  REQUIRE(rig.pair(&device, &server));
  std::uint64_t begin_ns = elapsed_ns(rig), passed_ns;
  carry(&rig, server, device, 20'000, &passed_ns);
  CHECK(null_link_record(rig.inner).faults_struck == 1);
  CHECK(elapsed_ns(rig) - begin_ns <= 45 * kMs);
}

// Goal: a radio takes exactly the memory it asks for, and says why it does not open. Method: one byte less, no memory,
// too many streams, and open() without an inner link.
TEST_CASE("shaped_link_refuses_what_it_has_no_memory_for") {
  LinkRig rig(kNullLink, 4);
  ShapedLinkSettings settings = fast_radio();
  std::vector<std::max_align_t> memory(shaped_link_need(4, settings) / sizeof(std::max_align_t) + 1);
  LinkOptions options;
  options.memory = memory.data();
  options.memory_bytes = shaped_link_need(4, settings);
  options.stream_count_max = 4;
  CHECK(shaped_link_open(rig.link, options, settings, &rig.error) != nullptr);
  --options.memory_bytes;
  CHECK(shaped_link_open(rig.link, options, settings, &rig.error) == nullptr);
  CHECK(std::strstr(rig.error.text, "by radio need") != nullptr);
  options.stream_count_max = kLinkStreamsMax + 1;
  CHECK(shaped_link_open(rig.link, options, settings, &rig.error) == nullptr);
  options = LinkOptions();
  options.stream_count_max = 4;
  CHECK(shaped_link_open(rig.link, options, settings, &rig.error) == nullptr);
  CHECK(kShapedTcp.open(options, &rig.error) == nullptr);
  CHECK(std::strstr(rig.error.text, "shaped_link_open") != nullptr);
}

// Goal: data in transit arrives even if the clock stands still, because waited time counts. Method: sockets with such a
// clock.
TEST_CASE("shaped_link_delivers_by_a_clock_that_stands_still") {
  LinkRig rig(kShapedTcp, 4, NullLinkSettings(), radio(1'000'000, 5 * kMs), [] { return std::uint64_t{1}; });
  int device = -1, server = -1;
  REQUIRE(rig.pair(&device, &server));
  REQUIRE(rig.write_all(server, counted_bytes(5000)));
  LinkResult result;
  CHECK(rig.read_all(device, 5000, &result) == counted_bytes(5000));
}

// Goal: the line takes its time over sockets, too. Method: the wall clock; how much more a busy machine takes is not
// the link's, so only a link that hangs exceeds the upper bound. The simulated clock tests the time exactly.
TEST_CASE("shaped_link_takes_its_time_over_sockets") {
  LinkRig rig(kShapedTcp, 4, NullLinkSettings(), radio(4'000'000, 5 * kMs, 2 * kMs));
  int device = -1, server = -1;
  std::uint64_t begin_ns = steady_ns();
  REQUIRE(rig.pair(&device, &server));
  CHECK(steady_ns() - begin_ns >= 10 * kMs);
  for (bool to_device : {true, false}) {
    std::uint64_t passed_ns;
    carry(&rig, to_device ? server : device, to_device ? device : server, 800'000, &passed_ns);
    MESSAGE("800 kB at 4 MB/s took " << static_cast<double>(passed_ns) * 1e-6 << " ms");
    CHECK(passed_ns >= 205 * kMs);
    CHECK(passed_ns < 10'000 * kMs);
  }
}

// Goal: every device that can be emulated has a working link. Method: the profiles, by the simulated clock: a large
// transfer takes the time given by bandwidth and latency, within two percent.
TEST_CASE("shaped_link_carries_for_every_device") {
  for (const Device& device : kDevices) {
    CAPTURE(std::string(device.name));
    LinkRig rig(kShapedNull, 4, ideal(), shaped_link_settings(device));
    int ends[2] = {-1, -1};
    REQUIRE(rig.pair(&ends[0], &ends[1]));
    constexpr std::size_t kBytes = 4'000'000;
    std::uint64_t passed_ns;
    carry(&rig, ends[1], ends[0], kBytes, &passed_ns);
    double wanted_ns =
        kBytes * 1e9 / static_cast<double>(device.link_bytes_per_second) + static_cast<double>(device.link_latency_ns);
    CHECK(std::fabs(static_cast<double>(passed_ns) / wanted_ns - 1) < 0.02);
  }
}
