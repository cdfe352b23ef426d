// Render servers over encrypted links: the same frames, the same failures, and who is not let in.
#include <doctest/doctest.h>

#include <algorithm>

#include "remote/server/state.h"
#include "remote/tls/encrypted_rig.h"
#include "support/effort.h"

using namespace pocketray;

namespace {

// Adds up what has passed on the line, in both directions.
std::uint64_t line_bytes(const EncryptedRig& rig) {
  platform::NullLinkRecord record = platform::null_link_record(rig.below);
  return record.bytes_to_device + record.bytes_from_device;
}

}  // namespace

// Goal: frames shared over an encrypted link are the device's own, byte for byte, and encryption adds little to what
// passes. Method: an animation, with the line's own count of bytes beside the messages'.
TEST_CASE("encrypted_frames_are_the_same") {
  EncryptedRig rig(1, 1);
  rig.frames_until_in_use();
  std::uint64_t rows = 0, messages = 0, before = line_bytes(rig);
  for (int i = 0; i < 20; ++i) {
    const FrameShare& share = rig.frame(5 + 0.1 * i);
    rows += share.server_rows[0];
    messages += share.bytes_in + share.bytes_out;
  }
  CHECK_GT(rows, 100u);
  double factor = static_cast<double>(line_bytes(rig) - before) / static_cast<double>(messages);
  MESSAGE("encryption takes ", 100 * (factor - 1), " % more bytes");
  CHECK_GT(factor, 1.0);
  CHECK_LT(factor, 1.15);
  CHECK(rig.log.empty());
}

// Goal: a server that is lost and returns is used again, in one handshake, and no pixel is lost. Method: stop it, and
// start it again, three times.
TEST_CASE("encrypted_server_returns") {
  EncryptedRig rig(1, 1);
  for (int i = 0; i < 3; ++i) {
    rig.frames_until_in_use();
    rig.stop_server();
    rig.frame(1);
    rig.frame(1.1);
    CHECK_FALSE(rig.in_use());
    rig.start_server();
    for (int k = 0; k < 400 && !rig.in_use(); ++k) rig.frame(1 + 0.01 * k);
    CHECK(rig.in_use());
  }
  CHECK(EncryptedRig::has(rig.log, "continuing without it and retrying"));
  CHECK(EncryptedRig::has(rig.log, "is in use again"));
  platform::TlsLinkRecord record = platform::tls_link_record(rig.server_link);
  CHECK_GE(record.handshakes, 4u);
  CHECK_EQ(record.failures, 0u);
}

// Goal: where the keys differ, or only one side has one, both say so in one line, and the device renders alone, as fast
// as without a server. Method: each such pair.
TEST_CASE("encrypted_pairs_that_do_not_fit_say_so") {
  struct Pair {
    int server_key, device_key;
    const char *device_says, *server_says;
  };
  const int plain = EncryptedRig::kPlain;
  const Pair pairs[] = {{1, 2, "its key differs: copy the same key file", "its key differs"},
                        {1, plain, "it requires a key: use the server's key (--key)", "it does not use TLS"},
                        {plain, 1, "it does not use TLS: give it the key, too", "it did not begin with a hello"}};
  for (const Pair& pair : pairs) {
    CAPTURE(pair.server_key);
    CAPTURE(pair.device_key);
    EncryptedRig rig(pair.server_key, pair.device_key);
    double ns = 0, alone = 64 * 48 * 2000.0;
    for (int i = 0; i < 12; ++i) {
      const FrameShare& share = rig.frame(0.1 * i);
      CHECK_EQ(share.server_rows[0], 0u);
      ns += share.measured_ns;
    }
    CHECK_LE(ns, 12 * 1.05 * alone);
    CHECK_EQ(rig.log.size(), 1u);
    CHECK(EncryptedRig::has(rig.log, pair.device_says));
    CHECK(EncryptedRig::has(rig.server_log, pair.server_says));
    CHECK_FALSE(EncryptedRig::has(rig.server_log, "connected after"));
    CHECK_EQ(server_totals(*rig.server).client_count, 0u);
  }
}

// Goal: a flood of handshakes that are never completed takes half of the guests' places at most, keeps nobody from
// being served, and leaves nothing behind. Method: thousands of them from one address, some of which send garbage or
// the beginning of a handshake, while a device renders.
TEST_CASE("encrypted_server_serves_in_a_flood_of_handshakes") {
  EncryptedRig rig(1, 1);
  rig.frames_until_in_use();
  const int count = effort(3000), half = rig.server_options.guest_count_max / 2;
  const char begin[] = "\x16\x03\x01\x00\x80\x01\x00\x00\x7c\x03\x03";
  std::vector<int> open;
  int frames = 0, most = 0;
  for (int i = 0; i < count; ++i) {
    platform::Error error;
    int stream = platform::null_link_connect_from(rig.below, "10.0.0.7", rig.address, 1'000'000'000, &error);
    REQUIRE_MESSAGE(stream >= 0, error.text);
    std::size_t sent = 0;
    platform::kNullLink.write(rig.below, stream, begin, static_cast<std::size_t>(i) % sizeof begin, &sent, &error);
    open.push_back(stream);
    step_server(rig.server, 0);
    step_server(rig.server, 0);
    int guests = 0;
    for (const Guest& guest : rig.server->guests) guests += is_open(guest);
    most = std::max(most, guests);
    if (open.size() < 20) continue;
    CHECK_GT(rig.frame(0.01 * i).server_rows[0], 0u);
    ++frames;
    for (int stale : open) platform::kNullLink.close(rig.below, stale);
    open.clear();
  }
  CHECK_LE(most, half);
  CHECK_GE(most, half / 2);
  CHECK_GE(frames, count / 20);
  CHECK(rig.log.empty());
  CHECK_EQ(server_totals(*rig.server).client_count, 1u);
  CHECK_LE(rig.server_log.size(), static_cast<std::size_t>(count));
}
