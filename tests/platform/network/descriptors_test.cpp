// Sockets when the system has no descriptors left.
#include "platform/net/descriptors.h"

#include <doctest/doctest.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <unistd.h>

#include "link_rig.h"

using namespace platform;

namespace {

int highest_open() {
  int highest = 2;
  for (int i = 0; i < 1024; ++i)
    if (fcntl(i, F_GETFD) >= 0) highest = i;
  return highest;
}

// Lowers the limit on open files during its lifetime.
struct Limit {
  rlimit before;
  explicit Limit(int count) {
    REQUIRE(getrlimit(RLIMIT_NOFILE, &before) == 0);
    rlimit now = before;
    now.rlim_cur = static_cast<rlim_t>(count);
    REQUIRE(setrlimit(RLIMIT_NOFILE, &now) == 0);
  }
  ~Limit() { setrlimit(RLIMIT_NOFILE, &before); }
};

// Uses up all descriptors during its lifetime.
struct AllTaken {
  Limit limit;
  std::vector<int> files;
  AllTaken() : limit(highest_open() + 1) {
    for (int file; (file = open("/dev/null", O_RDONLY)) >= 0;) files.push_back(file);
  }
  ~AllTaken() {
    for (int file : files) close(file);
  }
};

int raw_connect(const LinkRig& rig, int file) {
  sockaddr_in at;
  std::memcpy(&at, rig.address.places[0], sizeof at);
  return connect(file, reinterpret_cast<sockaddr*>(&at), sizeof at);
}

// Of kTcpLink.poll(), in turn.
int clock_reads = 0;
std::uint64_t counting_ns() { return ++clock_reads, steady_ns(); }

}  // namespace

// Goal: poll() waits and works with more entries than files may be open. Method: fifty entries, one of them a listener,
// under a limit of a few; nothing arrives, then a peer does.
TEST_CASE("tcp_poll_takes_more_places_than_files_may_be_open") {
  LinkRig rig(kTcpLink, 64, NullLinkSettings(), fast_radio(), counting_ns);
  int file = socket(AF_INET, SOCK_STREAM, 0);
  Limit limit(highest_open() + 2);
  std::vector<LinkWait> waits(50);
  waits[30].stream = rig.listener;
  waits[30].want_read = true;
  clock_reads = 0;
  CHECK(kTcpLink.poll(rig.link, waits.data(), 50, 30 * kMs) == 0);
  CHECK(clock_reads < 20);  // it waited
  CHECK_FALSE(waits[30].can_read);
  REQUIRE(raw_connect(rig, file) == 0);
  CHECK(kTcpLink.poll(rig.link, waits.data(), 50, 2000 * kMs) == 1);
  CHECK(waits[30].can_read);
  close(file);
}

// Goal: poll() does not spin when the system cannot tell what is ready. Method: more open files than the limit now
// allows.
TEST_CASE("tcp_poll_rests_where_the_system_fails") {
  LinkRig rig(kTcpLink, 32, NullLinkSettings(), fast_radio(), counting_ns);
  std::vector<LinkWait> waits;
  for (int i = 0; i < 10; ++i) {
    int device = -1, server = -1;
    REQUIRE(rig.pair(&device, &server));
    waits.push_back({device, true, false});
  }
  Limit limit(4);
  clock_reads = 0;
  std::uint64_t start = steady_ns();
  CHECK(kTcpLink.poll(rig.link, waits.data(), 10, 2000 * kMs) == 10);
  CHECK(steady_ns() - start >= 9 * kMs);
  CHECK(clock_reads < 5);
}

// Goal: a peer without a descriptor is turned away, so that it does not wait in vain, and the listener continues.
// Method: a limit that allows no other file; then one that does.
TEST_CASE("tcp_turns_a_peer_away_where_files_are_short") {
  LinkRig rig(kTcpLink);
  int file = socket(AF_INET, SOCK_STREAM, 0), other = socket(AF_INET, SOCK_STREAM, 0), stream = -1;
  REQUIRE(raw_connect(rig, file) == 0);
  {
    AllTaken taken;
    REQUIRE(rig.wait(rig.listener, true, false));
    CHECK(kTcpLink.accept(rig.link, rig.listener, &stream, &rig.error) == LinkResult::failed);
    CHECK(std::strstr(rig.error.text, "ulimit -n") != nullptr);
    pollfd told = {file, POLLIN, 0};
    CHECK(poll(&told, 1, 10'000) == 1);
    CHECK_FALSE(rig.wait(rig.listener, true, false, 0));
  }
  REQUIRE(raw_connect(rig, other) == 0);
  REQUIRE(rig.wait(rig.listener, true, false));
  CHECK(kTcpLink.accept(rig.link, rig.listener, &stream, &rig.error) == LinkResult::done);
  close(file);
  close(other);
}

// Goal: free descriptors are counted, and the limit is raised if allowed. Method: a limit of seven more.
TEST_CASE("descriptors_left_counts_what_may_be_opened") {
  Limit limit(highest_open() + 8);
  CHECK(descriptors_left(3) == 3);
  CHECK(descriptors_left(40) == 40);  // raised: the hard limit is higher
  int count = 0;
  int files[40];
  for (int& file : files) count += (file = open("/dev/null", O_RDONLY)) >= 0;
  CHECK(count == 40);
  for (int file : files) close(file);
}
