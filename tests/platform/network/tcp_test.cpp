// Properties of sockets only: peers that are processes or speak TCP by hand, names, signals.
#include <arpa/inet.h>
#include <doctest/doctest.h>
#include <netinet/in.h>
#include <signal.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>

#include "link_rig.h"
#include "support/effort.h"

using namespace platform;

namespace {

sockaddr_in place_of(const LinkAddress& address) {
  sockaddr_in at;
  std::memcpy(&at, address.places[0], sizeof at);
  return at;
}

// A raw socket connected to the rig's listener.
int raw_connect(const LinkRig& rig) {
  int file = socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in at = place_of(rig.address);
  REQUIRE(connect(file, reinterpret_cast<sockaddr*>(&at), sizeof at) == 0);
  return file;
}

int accepted(LinkRig* rig) {
  int stream = -1;
  REQUIRE(rig->wait(rig->listener, true, false));
  REQUIRE(rig->net->accept(rig->link, rig->listener, &stream, &rig->error) == LinkResult::done);
  return stream;
}

std::uint64_t clock_ns = 1'000'000'000'000;
std::uint64_t backward_ns() { return clock_ns -= 3'000'000; }

}  // namespace

// Goal: the system's errors about an address become one line that says what to do. Method: a name that needs no
// resolver, a multicast address, another machine's address to listen on.
TEST_CASE("tcp_says_what_is_wrong_with_an_address") {
  LinkRig rig(kTcpLink);
  LinkAddress address;
  CHECK_FALSE(kTcpLink.resolve("no..host:7474", &address, &rig.error));
  CHECK(std::strstr(rig.error.text, "'no..host'") != nullptr);
  CHECK(std::strstr(rig.error.text, "numeric") != nullptr);
  REQUIRE(kTcpLink.resolve("224.0.0.1:7474", &address, &rig.error));
  CHECK(kTcpLink.connect(rig.link, address, kMs, &rig.error) == -1);
  CHECK(std::string(rig.error.text) ==
        "224.0.0.1:7474: no route leads there: is the network up, and the address right?");
  REQUIRE(kTcpLink.resolve("192.0.2.1:7474", &address, &rig.error));
  CHECK(kTcpLink.listen(rig.link, address, &rig.error) == -1);
  CHECK(std::strstr(rig.error.text, "no route leads there") != nullptr);
}

// Goal: a connection without an outcome fails at its deadline. Method: a listener whose queue is full drops new
// connections.
TEST_CASE("tcp_connect_fails_at_its_deadline") {
  LinkRig rig(kTcpLink);
  int file = socket(AF_INET, SOCK_STREAM, 0), waiting[8];
  sockaddr_in at = {};
  socklen_t bytes = sizeof at;
  at.sin_family = AF_INET;
  at.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  REQUIRE(bind(file, reinterpret_cast<sockaddr*>(&at), bytes) == 0);
  REQUIRE(listen(file, 0) == 0);
  REQUIRE(getsockname(file, reinterpret_cast<sockaddr*>(&at), &bytes) == 0);
  LinkAddress address;
  REQUIRE(kTcpLink.resolve(std::to_string(ntohs(at.sin_port)).c_str(), &address, &rig.error));
  int full = 0;
  for (int& stream : waiting) {
    stream = kTcpLink.connect(rig.link, address, 20 * kMs, &rig.error);
    if (stream >= 0 && rig.wait(stream, false, true) &&
        kTcpLink.connected(rig.link, stream, &rig.error) == LinkResult::failed) {
      CHECK(std::strstr(rig.error.text, "no answer: is it on") != nullptr);
      ++full;
      break;
    }
  }
  CHECK(full == 1);
  close(file);
}

// Goal: poll() works with a clock that stands still or is set back. Method: one that only runs backwards.
TEST_CASE("tcp_poll_ends_though_the_clock_runs_backwards") {
  std::vector<std::max_align_t> memory(kTcpLink.need(2) / sizeof(std::max_align_t) + 1);
  LinkOptions options;
  options.memory = memory.data();
  options.memory_bytes = memory.size() * sizeof(std::max_align_t);
  options.stream_count_max = 2;
  options.now_ns = backward_ns;
  Error error;
  Link* link = kTcpLink.open(options, &error);
  REQUIRE(link != nullptr);
  LinkAddress address;
  REQUIRE(kTcpLink.resolve(":0", &address, &error));
  LinkWait wait;
  wait.stream = kTcpLink.listen(link, address, &error);
  wait.want_read = true;
  std::uint64_t begin_ns = steady_ns();
  CHECK(kTcpLink.poll(link, &wait, 1, 20 * kMs) == 0);
  CHECK(steady_ns() - begin_ns >= 20 * kMs);
  CHECK(steady_ns() - begin_ns < 2000 * kMs);
  kTcpLink.close_all(link);
}

// Goal: of an address with several places the first that answers is used. Method: "localhost", and a listener on IPv6.
TEST_CASE("tcp_tries_every_place_of_an_address") {
  LinkRig rig(kTcpLink);
  LinkAddress address;
  REQUIRE(kTcpLink.resolve("[::1]:0", &address, &rig.error));
  int listener = kTcpLink.listen(rig.link, address, &rig.error);
  if (listener < 0) {
    MESSAGE("no IPv6 here: skipped");
    return;
  }
  std::string name = kTcpLink.stream_name(rig.link, listener);
  REQUIRE(name.substr(0, 6) == "[::1]:");
  REQUIRE(kTcpLink.resolve(("localhost:" + name.substr(6)).c_str(), &address, &rig.error));
  REQUIRE(address.place_count == 2);
  int stream = kTcpLink.connect(rig.link, address, 2000 * kMs, &rig.error);
  REQUIRE_MESSAGE(stream >= 0, rig.error.text);
  CHECK(rig.wait(stream, false, true));
  CHECK(kTcpLink.connected(rig.link, stream, &rig.error) == LinkResult::done);
  CHECK(kTcpLink.stream_name(rig.link, stream) == name);
  kTcpLink.close(rig.link, listener);
  stream = kTcpLink.connect(rig.link, address, 2000 * kMs, &rig.error);
  if (stream >= 0) {
    CHECK(rig.wait(stream, false, true));
    CHECK(kTcpLink.connected(rig.link, stream, &rig.error) == LinkResult::failed);
  }
  CHECK(std::strstr(rig.error.text, "nothing is listening there") != nullptr);
}

// Goal: a peer that has finished sending still receives. Method: one half of a socket is shut down.
TEST_CASE("tcp_half_closed_peer_still_gets_bytes") {
  LinkRig rig(kTcpLink);
  int file = raw_connect(rig), stream = accepted(&rig);
  REQUIRE(send(file, "bye", 3, 0) == 3);
  REQUIRE(shutdown(file, SHUT_WR) == 0);
  LinkResult result;
  CHECK(rig.read_all(stream, 10, &result) == "bye");
  CHECK(result == LinkResult::ended);
  CHECK(rig.write_all(stream, "answer"));
  char bytes[8];
  CHECK(recv(file, bytes, sizeof bytes, 0) == 6);
  CHECK(rig.wait(stream, true, false, 0));
  close(file);
}

// Goal: a reset in the middle loses the rest and is reported. Method: a socket with zero linger time.
TEST_CASE("tcp_reset_by_hand_is_told") {
  LinkRig rig(kTcpLink);
  int file = raw_connect(rig), stream = accepted(&rig);
  linger none = {1, 0};
  REQUIRE(setsockopt(file, SOL_SOCKET, SO_LINGER, &none, sizeof none) == 0);
  close(file);
  LinkResult result;
  CHECK(rig.read_all(stream, 10, &result) == "");
  CHECK(result == LinkResult::failed);
  CHECK(std::strstr(rig.error.text, "the peer closed the connection") != nullptr);
}

// Goal: a process killed in the middle of sending is a lost peer, and the next one is served. Method: SIGKILL after
// each of several numbers of bytes; the child writes one more only on command.
TEST_CASE("tcp_peer_killed_at_each_step") {
  LinkRig rig(kTcpLink);
  sockaddr_in at = place_of(rig.address);
  for (std::size_t sent : {0u, 1u, 7u, 8u, 9u, 4000u}) {
    CAPTURE(sent);
    const std::string bytes = counted_bytes(sent);
    pid_t child = fork();
    if (child == 0) {
      int file = socket(AF_INET, SOCK_STREAM, 0);
      bool ok = connect(file, reinterpret_cast<sockaddr*>(&at), sizeof at) == 0 &&
                write(file, bytes.data(), sent) == static_cast<ssize_t>(sent);
      while (ok) pause();
      _exit(1);
    }
    int stream = accepted(&rig);
    LinkResult result;
    CHECK(rig.read_all(stream, sent, &result) == bytes);
    CHECK(kill(child, SIGKILL) == 0);
    waitpid(child, nullptr, 0);
    CHECK(rig.read_all(stream, 1, &result) == "");
    CHECK(result == LinkResult::ended);
    kTcpLink.close(rig.link, stream);
  }
}

// Goal: signals shorten no wait and lose no byte. Method: an alarm every millisecond whose handler does nothing.
TEST_CASE("tcp_signals_change_nothing") {
  LinkRig rig(kTcpLink);
  int device = -1, server = -1;
  REQUIRE(rig.pair(&device, &server));
  struct sigaction action = {}, before;
  action.sa_handler = [](int) {};
  sigaction(SIGALRM, &action, &before);
  itimerval often = {{0, 1000}, {0, 1000}}, never = {};
  setitimer(ITIMER_REAL, &often, nullptr);
  std::uint64_t begin_ns = steady_ns();
  bool woken = rig.wait(device, true, false, 30 * kMs);
  std::uint64_t passed_ns = steady_ns() - begin_ns;
  const std::string bytes = counted_bytes(50000);
  bool same = true;
  for (int i = 0; i < 20; ++i) {
    LinkResult result;
    same = same && rig.write_all(server, bytes) && rig.read_all(device, bytes.size(), &result) == bytes;
  }
  setitimer(ITIMER_REAL, &never, nullptr);
  sigaction(SIGALRM, &before, nullptr);
  CHECK_FALSE(woken);
  CHECK(passed_ns >= 30 * kMs);
  CHECK(same);
}

// Goal: a peer without room is turned away, and the listener continues. Method: a link of two streams, one in use.
TEST_CASE("tcp_sends_away_whom_it_has_no_room_for") {
  LinkRig rig(kTcpLink, 2);
  int first = raw_connect(rig), stream = accepted(&rig), second = raw_connect(rig), none = -1;
  REQUIRE(rig.wait(rig.listener, true, false));
  CHECK(kTcpLink.accept(rig.link, rig.listener, &none, &rig.error) == LinkResult::failed);
  CHECK(std::strstr(rig.error.text, "all 2 connections are in use") != nullptr);
  CHECK(none == -1);
  char byte;
  timeval soon = {2, 0};
  setsockopt(second, SOL_SOCKET, SO_RCVTIMEO, &soon, sizeof soon);
  CHECK(recv(second, &byte, 1, 0) == 0);
  CHECK_FALSE(rig.wait(rig.listener, true, false, 0));
  kTcpLink.close(rig.link, stream);
  int third = raw_connect(rig);
  CHECK(accepted(&rig) != stream);
  for (int file : {first, second, third}) close(file);
}

// Goal: connecting again and again to a port where nobody listens never ends in a connection to oneself. Method: more
// attempts than ports to be assigned, at one of them.
TEST_CASE("tcp_never_connects_to_itself") {
  LinkRig rig(kTcpLink);
  LinkAddress address;
  int free = -1;  // an even port: Linux assigns those to connecting sockets
  for (int port = 40000 + getpid() % 1000 * 2; free < 0; port += 2) {
    REQUIRE(kTcpLink.resolve(std::to_string(port).c_str(), &address, &rig.error));
    free = kTcpLink.listen(rig.link, address, &rig.error);
  }
  kTcpLink.close(rig.link, free);
  int connected_count = 0, failed_count = 0;
  for (int i = 0; i < pocketray::effort(33000); ++i) {
    int stream = kTcpLink.connect(rig.link, address, 2000 * kMs, &rig.error);
    if (stream < 0) {
      ++failed_count;
      continue;
    }
    rig.wait(stream, false, true);
    LinkResult result = kTcpLink.connected(rig.link, stream, &rig.error);
    connected_count += result == LinkResult::done;
    failed_count += result == LinkResult::failed;
    kTcpLink.close(rig.link, stream);
  }
  CHECK(connected_count == 0);
  CHECK(failed_count == pocketray::effort(33000));
}
