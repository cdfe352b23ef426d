// What every link must do, tested on sockets of this machine, on the simulated link, and on a radio and on TLS over
// either.
#include <doctest/doctest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>

#include "base/seal.h"
#include "link_rig.h"
#include "support/effort.h"

using namespace platform;

namespace {
#ifdef POCKETRAY_HAVE_TLS
const LinkBackend* const kLinks[] = {&kTcpLink, &kNullLink, &kShapedTcp, &kShapedNull, &kTlsTcp, &kTlsNull};
#else
const LinkBackend* const kLinks[] = {&kTcpLink, &kNullLink, &kShapedTcp, &kShapedNull};
#endif
}  // namespace

// Goal: addresses are parsed as written, a missing host means this machine, and invalid ones are reported. Method: each
// form.
TEST_CASE("link_reads_addresses") {
  for (const LinkBackend* net : kLinks) {
    CAPTURE(net->name);
    LinkAddress address;
    Error error;
    for (const char* text : {"127.0.0.1:7474", ":7474", "7474", "localhost:7474", "[::1]:7474"}) {
      CAPTURE(text);
      CHECK(net->resolve(text, &address, &error));
      CHECK(address.loopback);
      CHECK(address.place_count >= 1);
    }
    for (const char* text : {"192.168.1.2:7474", "0.0.0.0:1", "[fe80::1]:65535"}) {
      CAPTURE(text);
      CHECK(net->resolve(text, &address, &error));
      CHECK_FALSE(address.loopback);
    }
    for (const char* text : {"", "host", "host:", "host:65536", "host:123456", "host:99999999999999999999", "host:-1",
                             "host:7x", "::1:80", "[::1]80", "[::1", ":", "host: 80"}) {
      CAPTURE(text);
      error.text[0] = 0;
      CHECK_FALSE(net->resolve(text, &address, &error));
      CHECK(std::strstr(error.text, "PORT") != nullptr);
      CHECK(std::strchr(error.text, '\n') == nullptr);
    }
    CHECK_FALSE(net->resolve((std::string(300, 'h') + ":80").c_str(), &address, &error));
    CHECK(std::strstr(error.text, "too long") != nullptr);
  }
}

// Goal: if nobody listens, the failure comes at once, in one line with the address. Method: a port that was released.
TEST_CASE("link_refused_is_told_at_once") {
  for (const LinkBackend* net : kLinks) {
    CAPTURE(net->name);
    LinkRig rig(*net);
    net->close(rig.link, rig.listener);
    int stream = net->connect(rig.link, rig.address, 2000 * kMs, &rig.error);
    if (stream >= 0) {
      CHECK(rig.wait(stream, false, true));
      CHECK(net->connected(rig.link, stream, &rig.error) == LinkResult::failed);
      std::size_t count;
      char byte = 0;
      CHECK(net->write(rig.link, stream, &byte, 1, &count, &rig.error) == LinkResult::failed);
    }
    CHECK(std::strstr(rig.error.text, rig.address.text) == rig.error.text);
    CHECK(std::strstr(rig.error.text, "nothing is listening there: start") != nullptr);
  }
}

// Goal: an error begins with the stream's name, whole, however long its address is written: callers that know the peer
// by a name of their own leave it out. Method: the longest text, with nobody there; a peer that resets.
TEST_CASE("link_errors_begin_with_the_streams_name") {
  for (const LinkBackend* net : kLinks) {
    CAPTURE(net->name);
    LinkRig rig(*net);
    int device = -1, server = -1;
    REQUIRE_MESSAGE(rig.pair(&device, &server), rig.error.text);
    const std::string name = net->stream_name(rig.link, server);
    net->close(rig.link, device);
    LinkResult result = LinkResult::later;
    for (int i = 0; i < 100 && result != LinkResult::failed; ++i) {
      std::size_t count;
      result = net->write(rig.link, server, "x", 1, &count, &rig.error);
      rig.wait(server, true, false, kMs);
    }
    CHECK(result == LinkResult::failed);
    CHECK(std::string(rig.error.text).compare(0, name.size() + 2, name + ": ") == 0);

    net->close(rig.link, rig.listener);
    LinkAddress address = rig.address;
    std::memset(address.text, 'h', sizeof address.text - 1);
    const int stream = net->connect(rig.link, address, 2000 * kMs, &rig.error);
    std::string called = address.text;
    if (stream >= 0) {
      rig.wait(stream, false, true);
      called = net->stream_name(rig.link, stream);
      CHECK(net->connected(rig.link, stream, &rig.error) == LinkResult::failed);
      CHECK(called == net->stream_name(rig.link, stream));
    }
    CHECK_MESSAGE(std::string(rig.error.text).compare(0, called.size() + 2, called + ": ") == 0, rig.error.text);
  }
}

// Goal: a port in use cannot be used again, and the error says so. Method: listen on the rig's port.
TEST_CASE("link_listens_once_on_a_port") {
  for (const LinkBackend* net : kLinks) {
    CAPTURE(net->name);
    LinkRig rig(*net);
    CHECK(net->listen(rig.link, rig.address, &rig.error) == -1);
    CHECK(std::strstr(rig.error.text, "another program is listening there") != nullptr);
    net->close(rig.link, rig.listener);
    CHECK(net->listen(rig.link, rig.address, &rig.error) >= 0);
  }
}

// Goal: many bytes arrive complete and in order while both ends send. Method: 8 MB each way in pieces of odd sizes, in
// one loop, since neither end can be ahead by more than its buffers.
TEST_CASE("link_carries_large_transfers_both_ways") {
  for (const LinkBackend* net : kLinks) {
    CAPTURE(net->name);
    LinkRig rig(*net);
    int device = -1, server = -1;
    REQUIRE_MESSAGE(rig.pair(&device, &server), rig.error.text);
    const std::string bytes = counted_bytes(static_cast<std::size_t>(pocketray::effort(8'000'000)));
    struct End {
      int stream;
      std::size_t sent;
      std::string got;
    } ends[2] = {{device, 0, ""}, {server, 0, ""}};
    char part[7919];
    bool moving = true;
    while (moving && (ends[0].got.size() < bytes.size() || ends[1].got.size() < bytes.size())) {
      LinkWait waits[2];
      for (int i = 0; i < 2; ++i) {
        waits[i].stream = ends[i].stream;
        waits[i].want_read = ends[i].got.size() < bytes.size();
        waits[i].want_write = ends[i].sent < bytes.size();
      }
      moving = net->poll(rig.link, waits, 2, 2000 * kMs) > 0;
      for (int i = 0; i < 2; ++i) {
        std::size_t count = 0;
        if (waits[i].can_read) net->read(rig.link, ends[i].stream, part, sizeof part, &count, &rig.error);
        ends[i].got.append(part, count);
        std::size_t most = bytes.size() - ends[i].sent < 70001 ? bytes.size() - ends[i].sent : 70001;
        count = 0;
        if (waits[i].can_write)
          net->write(rig.link, ends[i].stream, bytes.data() + ends[i].sent, most, &count, &rig.error);
        ends[i].sent += count;
      }
    }
    CHECK(moving);
    CHECK(ends[0].got == bytes);
    CHECK(ends[1].got == bytes);
  }
}

// Goal: a stream has no messages: single bytes arrive, too. Method: write one, read one.
TEST_CASE("link_carries_one_byte_at_a_time") {
  for (const LinkBackend* net : kLinks) {
    CAPTURE(net->name);
    LinkRig rig(*net);
    int device = -1, server = -1;
    REQUIRE(rig.pair(&device, &server));
    for (char c : counted_bytes(300)) {
      LinkResult result;
      REQUIRE(rig.write_all(server, std::string(1, c)));
      REQUIRE(rig.read_all(device, 1, &result) == std::string(1, c));
    }
  }
}

// Goal: a silent peer costs no more than the timeout. Method: the link's own clock around poll().
TEST_CASE("link_silence_costs_the_timeout") {
  for (const LinkBackend* net : kLinks) {
    CAPTURE(net->name);
    LinkRig rig(*net);
    int device = -1, server = -1;
    REQUIRE(rig.pair(&device, &server));
    std::uint64_t begin_ns = net->now_ns(rig.link);
    CHECK_FALSE(rig.wait(device, true, false, 20 * kMs));
    std::uint64_t passed_ns = net->now_ns(rig.link) - begin_ns;
    CHECK(passed_ns >= 20 * kMs);
    CHECK(passed_ns < 1000 * kMs);
    char byte;
    std::size_t count;
    CHECK(net->read(rig.link, device, &byte, 1, &count, &rig.error) == LinkResult::later);
    CHECK_FALSE(rig.wait(device, true, false, 0));
  }
}

// Goal: whenever a peer goes away, its data is read, then comes the end, and writing to it fails with one line and no
// signal. Method: close after each number of bytes; SIGPIPE would end this program.
TEST_CASE("link_ends_after_what_was_sent_at_every_byte") {
  for (const LinkBackend* net : kLinks) {
    CAPTURE(net->name);
    LinkRig rig(*net);
    const std::string message = counted_bytes(40);
    for (std::size_t sent = 0; sent <= message.size(); ++sent) {
      CAPTURE(sent);
      int device = -1, server = -1;
      REQUIRE(rig.pair(&device, &server));
      REQUIRE(rig.write_all(server, message.substr(0, sent)));
      net->close(rig.link, server);
      LinkResult result;
      CHECK(rig.read_all(device, 100, &result) == message.substr(0, sent));
      CHECK(result == LinkResult::ended);
      bool failed = false;
      for (int i = 0; i < 1000 && !failed; ++i) {
        failed = !rig.write_all(device, "x");
        rig.wait(device, true, false, kMs);
      }
      CHECK(failed);
      CHECK(std::strstr(rig.error.text, "closed the connection") != nullptr);
      net->close(rig.link, device);
    }
  }
}

// Goal: a connection that is reset fails in both calls and says so. Method: close with bytes unread.
TEST_CASE("link_reset_is_told") {
  for (const LinkBackend* net : kLinks) {
    CAPTURE(net->name);
    LinkRig rig(*net);
    int device = -1, server = -1;
    REQUIRE(rig.pair(&device, &server));
    REQUIRE(rig.write_all(device, "unread"));
    REQUIRE(rig.wait(server, true, false));
    net->close(rig.link, server);
    LinkResult result;
    CHECK(rig.read_all(device, 1, &result) == "");
    CHECK(result == LinkResult::failed);
    CHECK(std::strstr(rig.error.text, "closed the connection") != nullptr);
    std::size_t count;
    CHECK(net->write(rig.link, device, "x", 1, &count, &rig.error) == LinkResult::failed);
    CHECK(rig.wait(device, true, true, 0));  // a failure always counts as ready
    net->close(rig.link, device);
  }
}

// Goal: a peer that never reads stops the writer at some bound but not the other direction, and the writer continues
// when the peer reads. Method: write until there is no room.
TEST_CASE("link_peer_that_never_reads_stops_the_writer") {
  for (const LinkBackend* net : kLinks) {
    CAPTURE(net->name);
    LinkRig rig(*net);
    int device = -1, server = -1;
    REQUIRE(rig.pair(&device, &server));
    const std::string part = counted_bytes(65536);
    std::size_t sent = 0, count = 0;
    while (sent < 64'000'000) {
      LinkResult result = net->write(rig.link, server, part.data(), part.size(), &count, &rig.error);
      REQUIRE(result != LinkResult::failed);
      sent += count;
      if (result == LinkResult::later && !rig.wait(server, false, true, 20 * kMs)) break;
    }
    CHECK(sent < 64'000'000);
    CHECK_FALSE(rig.wait(server, true, true, 5 * kMs));
    CHECK(rig.write_all(device, "still here"));
    LinkResult result;
    CHECK(rig.read_all(server, 10, &result) == "still here");
    CHECK(rig.read_all(device, sent, &result).size() == sent);
    CHECK(rig.wait(server, false, true));
  }
}

// Goal: connections come and go endlessly in the same few slots, and a stale stream affects none of its successors.
// Method: 1000 reconnects in a link of three streams; the old number is tried each time.
TEST_CASE("link_reconnects_a_thousand_times") {
  for (const LinkBackend* net : kLinks) {
    CAPTURE(net->name);
    LinkRig rig(*net, 3);
    int old = -1, failures = 0;
    for (int i = 0; i < pocketray::effort(1000); ++i) {
      int device = -1, server = -1;
      REQUIRE_MESSAGE(rig.pair(&device, &server), rig.error.text);
      std::size_t count;
      Error error;
      if (old >= 0) failures += net->write(rig.link, old, "stale", 5, &count, &error) == LinkResult::failed;
      LinkResult result;
      REQUIRE(rig.write_all(server, "hello"));
      REQUIRE(rig.read_all(device, 5, &result) == "hello");
      net->close(rig.link, i % 2 ? server : device);
      net->close(rig.link, i % 2 ? device : server);
      net->close(rig.link, device);
      old = device;
    }
    CHECK(failures == pocketray::effort(1000) - 1);
  }
}

// Goal: more peers than there is room for are turned away without affecting the others. Method: a link of three
// streams.
TEST_CASE("link_turns_away_what_it_has_no_room_for") {
  for (const LinkBackend* net : kLinks) {
    CAPTURE(net->name);
    LinkRig rig(*net, 3);
    int device = -1, server = -1;
    REQUIRE(rig.pair(&device, &server));
    CHECK(net->connect(rig.link, rig.address, kMs, &rig.error) == -1);
    CHECK(std::string(rig.error.text) == "all 3 connections are in use: close one, or allow more");
    CHECK(rig.write_all(device, "x"));
    CHECK(rig.wait(server, true, false));
    if (rig.inner) continue;  // opened otherwise
    LinkOptions options;
    options.stream_count_max = kLinkStreamsMax + 1;
    CHECK(net->open(options, &rig.error) == nullptr);
    options.stream_count_max = 4;
    CHECK(net->open(options, &rig.error) == nullptr);
    CHECK(std::strstr(rig.error.text, "bytes") != nullptr);
  }
}

// Goal: poll() distinguishes ready streams from others. Method: three pairs, one of which has bytes.
TEST_CASE("link_poll_names_the_streams_that_are_ready") {
  for (const LinkBackend* net : kLinks) {
    CAPTURE(net->name);
    LinkRig rig(*net);
    int device[3] = {-1, -1, -1}, server[3] = {-1, -1, -1};
    LinkWait waits[4];
    for (int i = 0; i < 3; ++i) {
      REQUIRE(rig.pair(&device[i], &server[i]));
      waits[i].stream = device[i];
      waits[i].want_read = true;
    }
    waits[3].stream = rig.listener;
    waits[3].want_read = true;
    CHECK(net->poll(rig.link, waits, 4, 0) == 0);
    REQUIRE(rig.write_all(server[1], "x"));
    CHECK(net->poll(rig.link, waits, 4, 2000 * kMs) == 1);
    CHECK_FALSE(waits[0].can_read);
    CHECK(waits[1].can_read);
    CHECK_FALSE(waits[1].can_write);
    CHECK_FALSE(waits[3].can_read);
    waits[0].want_read = false;
    waits[0].want_write = true;
    waits[1].want_read = false;
    CHECK(net->poll(rig.link, waits, 4, 0) == 1);
    CHECK(waits[0].can_write);
  }
}

// Goal: nothing allocates between open() and close_all(): connecting, accepting, carrying, failing. Method: the sealed
// heap, which is first shown to abort.
TEST_CASE("link_allocates_nothing_in_steady_state") {
#ifdef POCKETRAY_SEALED_HEAP
  pid_t child = fork();
  if (child == 0) {
    close(STDERR_FILENO);
    pocketray::seal_memory();
    void* volatile block = std::malloc(100);
    std::free(block);
    _exit(0);
  }
  int status = 0;
  REQUIRE(waitpid(child, &status, 0) == child);
  CHECK_FALSE((WIFEXITED(status) && WEXITSTATUS(status) == 0));
#else
  MESSAGE("the heap of this build has no seal");
#endif
  for (const LinkBackend* net : kLinks) {
    CAPTURE(net->name);
    LinkRig rig(*net);
    bool ok = true;
    pocketray::seal_memory();
    for (int i = 0; i < 20 && ok; ++i) {
      int device = -1, server = -1;
      char bytes[64] = {0};
      std::size_t count;
      ok = rig.pair(&device, &server);
      for (int round = 0; round < 20 && ok; ++round) {
        ok = net->write(rig.link, server, bytes, sizeof bytes, &count, &rig.error) == LinkResult::done &&
             rig.wait(device, true, false) &&
             net->read(rig.link, device, bytes, sizeof bytes, &count, &rig.error) == LinkResult::done;
      }
      net->close(rig.link, server);
      ok = ok && rig.wait(device, true, false) &&
           net->read(rig.link, device, bytes, sizeof bytes, &count, &rig.error) == LinkResult::ended;
      net->close(rig.link, device);
      ok = ok && net->read(rig.link, device, bytes, 1, &count, &rig.error) == LinkResult::failed;
    }
    pocketray::unseal_memory();
    CHECK(ok);
  }
}
