#include "platform/tls/tls_rig.h"

#include "platform/net/link_pipe.h"

namespace platform {
namespace {

std::uint64_t test_state = 1;
bool (*slow_random)(void*, std::size_t) = nullptr;
bool server_random(void* bytes, std::size_t byte_count) {
  return (slow_random ? slow_random : tls_test_random)(bytes, byte_count);
}

Link* encrypt(Link* below, int stream_count, unsigned char key, bool (*random)(void*, std::size_t),
              std::vector<std::max_align_t>* memory) {
  LinkOptions options;
  options.memory_bytes = tls_link_need(stream_count);
  memory->resize(options.memory_bytes / sizeof(std::max_align_t) + 1);
  options.memory = memory->data();
  options.stream_count_max = stream_count;
  TlsLinkSettings settings;
  settings.key.bytes[0] = key;
  settings.random = random;
  Error error;
  Link* link = tls_link_open(below, options, settings, &error);
  REQUIRE_MESSAGE(link != nullptr, error.text);
  return link;
}

}  // namespace

bool tls_test_random(void* bytes, std::size_t byte_count) {
  auto* at = static_cast<unsigned char*>(bytes);
  while (byte_count-- > 0) *at++ = static_cast<unsigned char>(random_u64(&test_state) >> 40);
  return true;
}

TlsRig::TlsRig(unsigned char server_key, unsigned char device_key) {
  NullLinkSettings settings;
  LinkOptions options;
  options.stream_count_max = 4 * kStreamCount;
  options.memory_bytes = null_link_need(options.stream_count_max, settings);
  below_memory.resize(options.memory_bytes / sizeof(std::max_align_t) + 1);
  options.memory = below_memory.data();
  below = null_link_open(options, settings, &error);
  REQUIRE_MESSAGE(below != nullptr, error.text);
  server = encrypt(below, kStreamCount, server_key, server_random, &server_memory);
  device = encrypt(below, kStreamCount, device_key, tls_test_random, &device_memory);
  const LinkBackend& net = *server->backend;
  REQUIRE(net.resolve(":0", &address, &error));
  listener = net.listen(server, address, &error);
  REQUIRE(net.resolve(net.stream_name(server, listener), &address, &error));
  REQUIRE(kNullLink.resolve(":0", &relay_address, &error));
  relay_listener = kNullLink.listen(below, relay_address, &error);
  REQUIRE(kNullLink.resolve(kNullLink.stream_name(below, relay_listener), &relay_address, &error));
}

void TlsRig::dawdle(bool (*random)(void*, std::size_t)) { slow_random = random; }

TlsRig::~TlsRig() {
  slow_random = nullptr;
  device->backend->close_all(device);
  server->backend->close_all(server);
  kNullLink.close_all(below);
}

bool TlsRig::relay(TlsMeeting* m, const Tampering& tampering) {
  bool moved = false;
  for (int to_server = 0; to_server < 2; ++to_server) {
    const int from = m->relay[to_server ? 0 : 1], to = m->relay[to_server ? 1 : 0];
    std::string* seen = to_server ? &m->from_device : &m->from_server;
    char part[4096];
    std::size_t count = 0;
    Error ignored;
    if (from < 0 || to < 0 || kNullLink.read(below, from, part, sizeof part, &count, &ignored) != LinkResult::done)
      continue;
    moved = true;
    std::string bytes(part, count);
    const std::size_t begin = seen->size(), at = tampering.at - begin;
    *seen += bytes;
    bool strikes = tampering.to_server == (to_server == 1) && tampering.at >= begin && at < count;
    if (strikes && tampering.flip) bytes[at] = static_cast<char>(bytes[at] ^ tampering.flip);
    if (strikes && !tampering.flip) bytes.resize(at);
    std::size_t sent = 0;
    if (!bytes.empty()) kNullLink.write(below, to, bytes.data(), bytes.size(), &sent, &ignored);
    CHECK_EQ(sent, bytes.size());
    if (!strikes || tampering.flip) continue;
    for (int& stream : m->relay) {
      kNullLink.close(below, stream);
      stream = -1;
    }
  }
  return moved;
}

TlsMeeting TlsRig::meet(const Tampering& tampering) {
  TlsMeeting m;
  const LinkBackend& net = *server->backend;
  constexpr std::uint64_t kTimeoutNs = 3'000'000'000;
  m.device = net.connect(device, relay_address, kTimeoutNs, &m.device_error);
  m.relay[1] = kNullLink.connect(below, address, kTimeoutNs, &error);
  REQUIRE(m.device >= 0);
  REQUIRE(m.relay[1] >= 0);
  LinkResult here = LinkResult::later, there = LinkResult::later;
  for (int quiet = 0; quiet < 6 && (here == LinkResult::later || there == LinkResult::later); ++quiet) {
    if (here == LinkResult::later) here = net.connected(device, m.device, &m.device_error);
    LinkWait wait = {m.device, true, true};
    net.poll(device, &wait, 1, 0);
    if (m.relay[0] < 0 && m.from_device.empty()) kNullLink.accept(below, relay_listener, &m.relay[0], &error);
    if (m.server < 0) net.accept(server, listener, &m.server, &error);
    wait = {m.server, true, false};
    net.poll(server, &wait, 1, 0);
    if (m.server >= 0 && there == LinkResult::later) there = net.connected(server, m.server, &m.server_error);
    if (relay(&m, tampering)) quiet = 0;
  }
  m.device_connected = here == LinkResult::done, m.server_connected = there == LinkResult::done;
  return m;
}

void TlsRig::end(TlsMeeting* m) {
  device->backend->close(device, m->device);
  server->backend->close(server, m->server);
  for (int stream : m->relay) kNullLink.close(below, stream);
}

int TlsRig::attack(const std::string& bytes, int* accepted) {
  int stream = kNullLink.connect(below, address, 1'000'000'000, &error);
  REQUIRE(stream >= 0);
  *accepted = -1;
  for (int i = 0; i < 10 && *accepted < 0; ++i) {
    LinkWait wait = {listener, true, false};
    server->backend->poll(server, &wait, 1, 1'000'000);
    server->backend->accept(server, listener, accepted, &error);
  }
  REQUIRE(*accepted >= 0);
  std::size_t sent = 0;
  if (!bytes.empty()) kNullLink.write(below, stream, bytes.data(), bytes.size(), &sent, &error);
  return stream;
}

bool TlsRig::serve(int accepted, Error* why) {
  for (int i = 0; i < 4; ++i) {
    LinkWait wait = {accepted, true, false};
    server->backend->poll(server, &wait, 1, 0);
  }
  return server->backend->connected(server, accepted, why) == LinkResult::done;
}

std::string TlsRig::read_below(int stream) {
  std::string all;
  char part[4096];
  std::size_t count = 0;
  while (kNullLink.read(below, stream, part, sizeof part, &count, &error) == LinkResult::done) all.append(part, count);
  return all;
}

}  // namespace platform
