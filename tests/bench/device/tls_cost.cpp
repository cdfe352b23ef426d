// tls_cost HANDSHAKES KIBIBYTES: encrypted connections over the simulated link, both ends in one thread, and bytes sent
// over the last one. tls_cost.py counts the instructions.
#include <cstdio>
#include <cstdlib>
#include <vector>

#include "platform/net/link_pipe.h"
#include "platform/net/tls/tls_link.h"
#include "platform/null/net/null_link.h"

using namespace platform;

namespace {

constexpr std::uint64_t kSecond = 1'000'000'000;
constexpr std::size_t kPart = 4096;

bool some_random(void* bytes, std::size_t byte_count) {
  static std::uint64_t state = 1;
  for (auto* at = static_cast<unsigned char*>(bytes); byte_count > 0; --byte_count)
    *at++ = static_cast<unsigned char>(random_u64(&state) >> 32);
  return true;
}

[[noreturn]] void fail(const Error& error) {
  std::fprintf(stderr, "tls_cost: %s\n", error.text);
  std::exit(1);
}

}  // namespace

int main(int argument_count, char** arguments) {
  if (argument_count != 3) return 2;
  const int handshakes = std::atoi(arguments[1]), kibibytes = std::atoi(arguments[2]);
  Error error;
  NullLinkSettings line;
  LinkOptions options;
  options.stream_count_max = 4;
  options.memory_bytes = null_link_need(4, line);
  std::vector<std::max_align_t> below_memory(options.memory_bytes / sizeof(std::max_align_t) + 1);
  options.memory = below_memory.data();
  Link* below = null_link_open(options, line, &error);
  if (!below) fail(error);
  options.memory_bytes = tls_link_need(4);
  std::vector<std::max_align_t> memory(options.memory_bytes / sizeof(std::max_align_t) + 1);
  options.memory = memory.data();
  TlsLinkSettings settings;
  settings.random = some_random;
  Link* link = tls_link_open(below, options, settings, &error);
  if (!link) fail(error);
  const LinkBackend& net = *link->backend;
  LinkAddress address;
  if (!net.resolve(":0", &address, &error)) fail(error);
  int listener = net.listen(link, address, &error), device = -1, server = -1;
  if (listener < 0 || !net.resolve(net.stream_name(link, listener), &address, &error)) fail(error);
  for (int i = 0; i < handshakes; ++i) {
    net.close(link, device);
    net.close(link, server);
    device = net.connect(link, address, kSecond, &error);
    LinkWait wait = {listener, true, false};
    net.poll(link, &wait, 1, kSecond);
    if (net.accept(link, listener, &server, &error) != LinkResult::done) fail(error);
    wait = {device, false, true};
    net.poll(link, &wait, 1, kSecond);
    if (net.connected(link, device, &error) != LinkResult::done) fail(error);
  }
  std::vector<unsigned char> part(kPart);
  for (int i = 0; i < kibibytes / 4; ++i) {
    std::size_t count = 0;
    for (std::size_t sent = 0; sent < kPart; sent += count)
      if (net.write(link, server, part.data(), kPart - sent, &count, &error) != LinkResult::done) fail(error);
    for (std::size_t received = 0; received < kPart; received += count) {
      LinkWait wait = {device, true, false};
      net.poll(link, &wait, 1, kSecond);
      if (net.read(link, device, part.data(), kPart, &count, &error) == LinkResult::failed) fail(error);
    }
  }
  net.close_all(link);
  below->backend->close_all(below);
  return 0;
}
