// Encrypted links: who becomes connected, who does not, and what each is told.
#include "platform/net/tls/tls_link.h"

#include <algorithm>
#include <cstring>

#include "platform/net/link_pipe.h"
#include "platform/net/tls/tls_stream.h"
#include "platform/network/link_rig.h"
#include "platform/tls/tls_rig.h"
#include "support/effort.h"

using namespace platform;

namespace {

constexpr std::uint64_t kSecond = 1'000'000'000;

bool says(const Error& error, const char* text) {
  CAPTURE(error.text);
  return std::strstr(error.text, text) != nullptr && std::strchr(error.text, '\n') == nullptr;
}

std::string read_now(Link* link, int stream, LinkResult* result, Error* error) {
  char part[5000];
  std::size_t count = 0;
  *result = link->backend->read(link, stream, part, sizeof part, &count, error);
  return std::string(part, count);
}

// Where the records of these bytes begin.
std::vector<std::size_t> records_of(const std::string& bytes) {
  std::vector<std::size_t> begins;
  for (std::size_t at = 0; at + 5 <= bytes.size();) {
    begins.push_back(at);
    at += 5 + (static_cast<unsigned char>(bytes[at + 3]) << 8 | static_cast<unsigned char>(bytes[at + 4]));
  }
  return begins;
}

}  // namespace

// Goal: with the same key both ends are connected, and bytes arrive; the line carries neither them nor the key. Method:
// through one between who keeps everything.
TEST_CASE("tls_link_connects_with_the_same_key_and_hides_what_passes") {
  TlsRig rig;
  TlsMeeting m = rig.meet();
  REQUIRE_MESSAGE(m.device_connected, m.device_error.text);
  REQUIRE_MESSAGE(m.server_connected, m.server_error.text);
  const std::string secret = "the rows of a picture";
  std::size_t count = 0;
  REQUIRE(rig.server->backend->write(rig.server, m.server, secret.data(), secret.size(), &count, &rig.error) ==
          LinkResult::done);
  REQUIRE(rig.relay(&m, Tampering()));
  LinkResult result;
  CHECK(read_now(rig.device, m.device, &result, &rig.error) == secret);
  CHECK(m.from_server.find("rows") == std::string::npos);
  CHECK(m.from_server.size() - m.from_server.find_last_of('\x17') <= 5 + secret.size() + 16);
  CHECK_EQ(tls_link_record(rig.server).handshakes, 1u);
  rig.end(&m);
}

// Goal: with another key nobody is connected, and both are told that the keys differ. Method: every other value of a
// byte of the key.
TEST_CASE("tls_link_wrong_keys_connect_nobody") {
  constexpr int kStep = pocketray::kEffortDivisor > 1 ? 32 : 1;
  for (int key = 0; key < 256; key += kStep) {
    if (key == 1) continue;
    CAPTURE(key);
    TlsRig rig(1, static_cast<unsigned char>(key));
    TlsMeeting m = rig.meet();
    CHECK_FALSE(m.device_connected);
    CHECK_FALSE(m.server_connected);
    CHECK(says(m.device_error, "its key differs: copy the same key file to both sides"));
    CHECK(says(m.server_error, "its key differs: copy the same key file to both sides"));
    CHECK_EQ(tls_link_record(rig.server).failures, 1u);
  }
}

// Goal: whoever changes or cuts a handshake on the way connects nobody to anything else than its true peer, crashes
// nothing and leaves the server as it was. Method: cut before every byte of either direction, and flip one bit of every
// byte, live between two ends with the right key. Only the version in the head of a record may change unnoticed.
TEST_CASE("tls_link_survives_tampering_at_every_byte_of_a_handshake") {
  TlsRig rig;
  TlsMeeting m = rig.meet();
  REQUIRE(m.device_connected);
  rig.end(&m);
  const std::string sent[2] = {m.from_server, m.from_device};
  int rounds = 0, passed = 0;
  for (int to_server = 0; to_server < 2; ++to_server) {
    const std::vector<std::size_t> records = records_of(sent[to_server]);
    for (std::size_t at = 0; at < sent[to_server].size(); ++at)
      for (int flip : {0, 1 << (at % 8), 0xFF}) {
        if (++rounds % pocketray::kEffortDivisor != 0) continue;
        CAPTURE(to_server);
        CAPTURE(at);
        CAPTURE(flip);
        m = rig.meet({to_server == 1, at, static_cast<unsigned char>(flip)});
        bool in_version = std::any_of(records.begin(), records.end(),
                                      [&](std::size_t begin) { return at == begin + 1 || at == begin + 2; });
        bool both = m.device_connected && m.server_connected;
        passed += both;
        CHECK_FALSE((both && !(flip && in_version)));
        // The device is the last to know, so it is never connected alone; the server's last flight may be lost.
        CHECK_FALSE((m.device_connected && !m.server_connected));
        if (to_server && flip && !in_version) CHECK_FALSE(m.server_connected);
        rig.end(&m);
      }
  }
  CHECK_LE(passed, rounds / 50);
  m = rig.meet();
  CHECK(m.device_connected);
  CHECK(m.server_connected);
  rig.end(&m);
}

// Goal: none of ten thousand false handshakes gets in, and the server serves a true peer afterwards. Method: recorded
// handshakes replayed whole, cut, with flipped bits or with bytes put in, and random bytes with and without the head of
// a record, the deepest of which cost the server two exchanges of Diffie and Hellman.
TEST_CASE("tls_link_lets_in_none_of_ten_thousand_false_handshakes") {
  TlsRig rig;
  std::vector<std::string> recorded;
  for (int i = 0; i < 5; ++i) {
    TlsMeeting m = rig.meet();
    REQUIRE(m.server_connected);
    rig.end(&m);
    recorded.push_back(m.from_device);
  }
  std::uint64_t state = 11;
  MESSAGE("seed ", state);
  auto random = [&](std::size_t below) { return static_cast<std::size_t>(random_u64(&state) % below); };
  auto noise = [&](std::size_t count) {
    std::string bytes(count, 0);
    for (char& byte : bytes) byte = static_cast<char>(random(256));
    return bytes;
  };
  int connected = 0, told = 0;
  const int count = pocketray::effort(10'000);
  for (int i = 0; i < count; ++i) {
    std::string bytes = recorded[random(recorded.size())];
    switch (i % 8) {
      case 0:
        break;  // as it was
      case 1:
        bytes.resize(random(bytes.size()));
        break;
      case 2:
      case 3:
        for (std::size_t k = 1 + random(3); k > 0; --k)
          bytes[random(bytes.size())] ^= static_cast<char>(1 << random(8));
        break;
      case 4:
        bytes.insert(random(bytes.size()), noise(1 + random(300)));
        break;
      case 5:
        bytes = bytes.substr(records_of(bytes).back()) + bytes;  // records out of order
        break;
      case 6:
        bytes = noise(random(600));
        break;
      case 7: {
        std::string body = noise(random(600));
        bytes =
            std::string("\x16\x03\x03") + static_cast<char>(body.size() >> 8) + static_cast<char>(body.size()) + body;
        break;
      }
    }
    int accepted = -1, stream = rig.attack(bytes, &accepted);
    Error why;
    connected += rig.serve(accepted, &why);
    told += why.text[0] != 0;
    rig.server->backend->close(rig.server, accepted);
    kNullLink.close(rig.below, stream);
  }
  CHECK_EQ(connected, 0);
  CHECK_GT(told, count / 3);
  TlsLinkRecord record = tls_link_record(rig.server);
  CHECK_EQ(record.handshakes, 5u);
  CHECK_LE(record.heap_bytes_max, kTlsStreamHeapBytes);
  TlsMeeting m = rig.meet();
  CHECK(m.device_connected);
  CHECK(m.server_connected);
  rig.end(&m);
}

// Goal: peers that never finish a handshake lose their streams in time, and a true one gets in meanwhile. Method: as
// many half-open ones as there is room for but one, silent, or after part of a ClientHello; by the virtual clock.
TEST_CASE("tls_link_ends_half_open_handshakes_in_time") {
  TlsRig rig;
  TlsMeeting m = rig.meet();
  const std::string hello = m.from_device.substr(0, 60);
  rig.end(&m);
  std::vector<int> accepted(TlsRig::kStreamCount - 2), streams;
  for (int& stream : accepted) streams.push_back(rig.attack(hello.substr(0, streams.size() * 3), &stream));
  m = rig.meet();
  CHECK(m.device_connected);
  CHECK(m.server_connected);
  const LinkBackend& net = *rig.server->backend;
  std::vector<LinkWait> waits;
  for (int stream : accepted) waits.push_back({stream, true, true});
  std::uint64_t begin = null_link_record(rig.below).elapsed_ns;
  CHECK_EQ(net.poll(rig.server, waits.data(), static_cast<int>(waits.size()), kSecond), 0);
  while (net.poll(rig.server, waits.data(), static_cast<int>(waits.size()), kSecond) == 0) {
  }
  std::uint64_t took = null_link_record(rig.below).elapsed_ns - begin;
  CHECK_LE(took, kTlsHandshakeNs + kSecond / 10);
  for (LinkWait& wait : waits) {
    CHECK_EQ(net.poll(rig.server, &wait, 1, kSecond / 10), 1);
    CHECK(wait.can_read);
    LinkResult result;
    read_now(rig.server, wait.stream, &result, &rig.error);
    CHECK(result == LinkResult::failed);
    CHECK(says(rig.error, "did not complete a TLS handshake"));
    net.close(rig.server, wait.stream);
  }
  std::size_t count = 0;
  CHECK(net.write(rig.server, m.server, "x", 1, &count, &rig.error) == LinkResult::done);
  rig.end(&m);
}

// Goal: a device gives up a server that accepts but does not answer, within the time to connect. Method: a listener
// below that says nothing.
TEST_CASE("tls_link_gives_up_a_silent_server") {
  TlsRig rig;
  const LinkBackend& net = *rig.device->backend;
  int device = net.connect(rig.device, rig.relay_address, kSecond, &rig.error);
  LinkWait wait = {device, false, true};
  std::uint64_t begin = null_link_record(rig.below).elapsed_ns;
  CHECK_EQ(net.poll(rig.device, &wait, 1, 10 * kSecond), 1);
  CHECK_LE(null_link_record(rig.below).elapsed_ns - begin, kSecond + kSecond / 10);
  CHECK(net.connected(rig.device, device, &rig.error) == LinkResult::failed);
  CHECK(says(rig.error, "no answer to the TLS handshake"));
}

// Goal: however many handshakes wait, they take a quarter of the time at most, one step after the other. Method: eight
// peers that have sent their first flight, where random bytes, of which every step takes some, take 5 ms.
TEST_CASE("tls_link_rests_between_steps_of_handshakes") {
  static Link* below;
  static int calls;
  constexpr std::uint64_t kStepNs = 5'000'000;
  TlsRig rig;
  TlsMeeting m = rig.meet();
  const std::string hello = m.from_device.substr(0, records_of(m.from_device)[1]);
  rig.end(&m);
  below = rig.below;
  rig.dawdle([](void* bytes, std::size_t byte_count) {
    ++calls;
    for (std::uint64_t until = kNullLink.now_ns(below) + kStepNs; kNullLink.now_ns(below) < until;) {
    }
    return tls_test_random(bytes, byte_count);
  });
  std::vector<int> accepted(8), streams;
  std::vector<LinkWait> waits;
  for (int& stream : accepted) streams.push_back(rig.attack("", &stream));
  for (int stream : accepted) waits.push_back({stream, true, false});
  std::size_t sent = 0;
  for (int stream : streams) kNullLink.write(rig.below, stream, hello.data(), hello.size(), &sent, &rig.error);
  const std::uint64_t begin = null_link_record(rig.below).elapsed_ns;
  calls = 0;
  std::size_t answered = 0;
  int rounds = 0;
  for (; answered < streams.size() && rounds < 1'000'000; ++rounds) {
    CHECK_EQ(rig.server->backend->poll(rig.server, waits.data(), static_cast<int>(waits.size()), 100'000), 0);
    std::size_t before = answered;
    for (int stream : streams) answered += !rig.read_below(stream).empty();
    REQUIRE_LE(answered, before + 1);
  }
  const double took = static_cast<double>(null_link_record(rig.below).elapsed_ns - begin);
  const double worked = static_cast<double>(calls) * kStepNs;
  CHECK_EQ(answered, streams.size());
  CHECK_GE(calls, 8);
  CHECK_LE(worked, 0.28 * took);  // after the last step there is no rest
  CHECK_GE(worked, 0.2 * took);
}

// Goal: a peer without TLS is told by an alert, and each side of such a pair says so in one line. Method: a plain hello
// to the server; a plain answer to the device.
TEST_CASE("tls_link_tells_plain_peers_apart") {
  TlsRig rig;
  const std::string hello("\x01\x14\0\0PRAY and sixteen more bytes", 28);
  int accepted = -1, stream = rig.attack(hello, &accepted);
  Error why;
  CHECK_FALSE(rig.serve(accepted, &why));
  CHECK(says(why, "it does not use TLS"));
  CHECK(rig.read_below(stream).substr(0, 3) == "\x15\x03\x03");

  int device = rig.device->backend->connect(rig.device, rig.relay_address, kSecond, &rig.error), plain = -1;
  LinkResult result = LinkResult::later;
  for (int i = 0; i < 10 && result == LinkResult::later; ++i) {
    std::size_t count;
    if (plain < 0 && kNullLink.accept(rig.below, rig.relay_listener, &plain, &rig.error) == LinkResult::done)
      kNullLink.write(rig.below, plain, hello.data(), hello.size(), &count, &rig.error);
    LinkWait wait = {device, false, true};
    rig.device->backend->poll(rig.device, &wait, 1, kSecond / 100);
    result = rig.device->backend->connected(rig.device, device, &why);
  }
  CHECK(result == LinkResult::failed);
  CHECK(says(why, "it does not use TLS: give it the key, too"));
}

// Goal: of a stream that is tampered with after the handshake nothing false is read, and its end is no regular one.
// Method: flip, repeat, leave out or cut records of three.
TEST_CASE("tls_link_reads_nothing_false") {
  for (int kind = 0; kind < 5; ++kind) {
    CAPTURE(kind);
    TlsRig rig;
    TlsMeeting m = rig.meet();
    REQUIRE(m.server_connected);
    REQUIRE(m.device_connected);
    std::vector<std::string> records;
    for (const char* text : {"one", "two", "three"}) {
      std::size_t count = 0;
      rig.server->backend->write(rig.server, m.server, text, std::strlen(text), &count, &rig.error);
      records.push_back(rig.read_below(m.relay[1]));
    }
    std::string bytes = records[0] + records[1] + records[2];
    if (kind == 1) bytes[records[0].size() + 7] ^= 4;
    if (kind == 2) bytes = records[0] + records[0] + records[1];
    if (kind == 3) bytes = records[0] + records[2];
    if (kind == 4) bytes = records[0] + records[1].substr(0, 9);
    std::size_t count = 0;
    kNullLink.write(rig.below, m.relay[0], bytes.data(), bytes.size(), &count, &rig.error);
    kNullLink.close(rig.below, m.relay[0]);
    std::string got;
    LinkResult result = LinkResult::done;
    for (int i = 0; i < 20 && (result == LinkResult::done || result == LinkResult::later); ++i) {
      LinkWait wait = {m.device, true, false};
      rig.device->backend->poll(rig.device, &wait, 1, kSecond / 100);
      got += read_now(rig.device, m.device, &result, &rig.error);
    }
    CHECK(got == (kind == 0 ? "onetwothree" : "one"));
    CHECK(result == LinkResult::failed);
    CHECK(says(rig.error, kind == 0 || kind == 4 ? "closed the connection" : "bytes that TLS does not allow"));
  }
}

// Goal: nobody waits for bytes that have been deciphered already, and those of the last record arrive without another
// write. Method: reads of fewer bytes than a record has, with a wait before each; a peer that reads late.
TEST_CASE("tls_link_waits_for_no_bytes_that_it_has") {
  LinkRig rig(kTlsNull);
  int device = -1, server = -1;
  REQUIRE(rig.pair(&device, &server));
  const std::string bytes = counted_bytes(1000);
  REQUIRE(rig.write_all(server, bytes));
  std::string got;
  while (got.size() < bytes.size()) {
    char part[7];
    std::size_t count = 0;
    REQUIRE(rig.wait(device, true, false, kMs));
    REQUIRE(rig.net->read(rig.link, device, part, sizeof part, &count, &rig.error) == LinkResult::done);
    got.append(part, count);
  }
  CHECK(got == bytes);
  CHECK_FALSE(rig.wait(device, true, false, kMs));

  std::size_t sent = 0, count = 0;
  const std::string more = counted_bytes(300'000);
  LinkResult result = LinkResult::done;
  while (result == LinkResult::done) {
    result = rig.net->write(rig.link, server, more.data() + sent, more.size() - sent, &count, &rig.error);
    sent += count;
  }
  CHECK(result == LinkResult::later);
  CHECK_GE(sent, 65536u - 4096u);
  CHECK(rig.read_all(device, sent, &result) == more.substr(0, sent));
  // What is kept when a stream is closed still arrives, and then the end.
  REQUIRE(rig.write_all(device, "x"));
  REQUIRE(rig.read_all(server, 1, &result) == "x");
  sent = 0;
  for (result = LinkResult::done; result == LinkResult::done; sent += count)
    result = rig.net->write(rig.link, server, more.data() + sent, more.size() - sent, &count, &rig.error);
  rig.net->close(rig.link, server);
  CHECK(rig.read_all(device, sent + 1, &result) == more.substr(0, sent));
  CHECK(result == LinkResult::ended);
}

// Goal: without random bytes there is no handshake. Method: a system that has none.
TEST_CASE("tls_link_needs_random_bytes") {
  TlsRig rig;
  std::vector<std::max_align_t> memory(tls_link_need(1) / sizeof(std::max_align_t) + 1);
  LinkOptions options;
  options.memory = memory.data(), options.memory_bytes = memory.size() * sizeof(std::max_align_t);
  options.stream_count_max = 1;
  TlsLinkSettings settings;
  settings.random = [](void*, std::size_t) { return false; };
  Link* link = tls_link_open(rig.below, options, settings, &rig.error);
  REQUIRE(link != nullptr);
  int stream = link->backend->connect(link, rig.relay_address, kSecond, &rig.error);
  LinkWait wait = {stream, false, true};
  CHECK_EQ(link->backend->poll(link, &wait, 1, 2 * kSecond), 1);
  CHECK(link->backend->connected(link, stream, &rig.error) == LinkResult::failed);
  CHECK(says(rig.error, "no random bytes"));
  link->backend->close_all(link);
}

// Goal: the memory planned for a stream suffices with some to spare, and with less the handshake fails in one line,
// wherever it runs out. Method: heaps from nothing to the whole, in steps; an end that has enough is the peer.
TEST_CASE("tls_handshake_memory_is_within_its_plan") {
  TlsRig rig;
  TlsMeeting m = rig.meet();
  REQUIRE(m.device_connected);
  std::size_t most = std::max(tls_link_record(rig.device).heap_bytes_max, tls_link_record(rig.server).heap_bytes_max);
  MESSAGE("a handshake takes ", most, " bytes of ", kTlsStreamHeapBytes);
  CHECK_LE(most, kTlsStreamHeapBytes - 1024);
  CHECK_GE(most, kTlsStreamHeapBytes * 3 / 4);
  rig.end(&m);

  std::vector<HeapGrain> memory(kTlsStreamHeapBytes / sizeof(HeapGrain)), config_memory(8192 / sizeof(HeapGrain));
  TlsConfig config = {};
  SharedKey key;
  key.bytes[0] = 1;
  REQUIRE(tls_config_start(&config, key, tls_test_random, config_memory.data(), &rig.error));
  int failures = 0, successes = 0;
  for (std::size_t bytes = 64; bytes <= kTlsStreamHeapBytes;
       bytes += bytes < 32768 ? 4096 : 16 * pocketray::kEffortDivisor) {
    CAPTURE(bytes);
    int stream = kNullLink.connect(rig.below, rig.address, kSecond, &rig.error), accepted = -1;
    TlsStream tls;
    bool ok = tls_begin(&tls, &config, false, rig.below, stream, memory.data(), bytes);
    LinkResult result = ok ? LinkResult::later : LinkResult::failed;
    for (int i = 0; i < 10 && result == LinkResult::later; ++i) {
      result = tls_handshake(&tls);
      if (accepted < 0) rig.server->backend->accept(rig.server, rig.listener, &accepted, &rig.error);
      LinkWait wait = {accepted, true, false};
      rig.server->backend->poll(rig.server, &wait, 1, 0);
    }
    if (result == LinkResult::failed) {
      Error error;
      tls_tell(tls, "peer", &error);
      CHECK(says(error, "peer: its handshake needs more memory than was planned"));
    }
    (result == LinkResult::done ? successes : failures)++;
    if (ok) tls_end(&tls);
    kNullLink.close(rig.below, stream);
    if (accepted < 0) rig.server->backend->accept(rig.server, rig.listener, &accepted, &rig.error);
    rig.server->backend->close(rig.server, accepted);
  }
  CHECK_GT(failures, 8);
  CHECK_GT(successes, pocketray::kEffortDivisor > 1 ? 2 : 8);
  tls_config_end(&config);
}
