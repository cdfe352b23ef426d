// A link with a listener, and pairs of connected streams over it: the same for sockets and for the simulation.
#pragma once
#include <doctest/doctest.h>

#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <string>
#include <vector>

#include "platform/link.h"
#include "platform/net/shaped_link.h"
#include "platform/net/tcp.h"
#include "platform/null/net/null_link.h"
#ifdef POCKETRAY_HAVE_TLS
#include "platform/entropy.h"
#include "platform/net/tls/tls_link.h"
#endif

namespace platform {

constexpr std::uint64_t kMs = 1'000'000;

inline std::uint64_t steady_ns() {
  return static_cast<std::uint64_t>(std::chrono::steady_clock::now().time_since_epoch().count());
}

// Shaped links over the other two, fast enough for the tests that run on all links.
inline const LinkBackend kShapedTcp = shaped_link_backend(kTcpLink);
inline const LinkBackend kShapedNull = shaped_link_backend(kNullLink);
#ifdef POCKETRAY_HAVE_TLS
inline const LinkBackend kTlsTcp = tls_link_backend(kTcpLink);
inline const LinkBackend kTlsNull = tls_link_backend(kNullLink);
#endif
inline ShapedLinkSettings fast_radio() {
  ShapedLinkSettings settings;
  settings.line = {50'000'000, 100'000, 100'000};
  return settings;
}

struct LinkRig {
  std::vector<std::max_align_t> memory, upper_memory;
  const LinkBackend* net = nullptr;
  Link *link = nullptr, *inner = nullptr;  // inner: below a shaped or encrypted one
  int listener = -1;
  LinkAddress address;  // of the listener
  Error error;

  explicit LinkRig(const LinkBackend& backend, int stream_count_max = 8,
                   const NullLinkSettings& settings = NullLinkSettings(),
                   const ShapedLinkSettings& radio = fast_radio(), std::uint64_t (*clock)() = steady_ns) {
    bool shaped = &backend == &kShapedTcp || &backend == &kShapedNull;
    bool encrypted = false;
    const LinkBackend& shaped_below = &backend == &kShapedTcp    ? kTcpLink
                                      : &backend == &kShapedNull ? kNullLink
                                                                 : backend;
#ifdef POCKETRAY_HAVE_TLS
    encrypted = &backend == &kTlsTcp || &backend == &kTlsNull;
    const LinkBackend& below = &backend == &kTlsTcp ? kTcpLink : &backend == &kTlsNull ? kNullLink : shaped_below;
#else
    const LinkBackend& below = shaped_below;
#endif
    bool simulated = &below == &kNullLink;
    LinkOptions options;
    options.memory_bytes = simulated ? null_link_need(stream_count_max, settings) : below.need(stream_count_max);
    memory.resize(options.memory_bytes / sizeof(std::max_align_t) + 1);
    options.memory = memory.data();
    options.stream_count_max = stream_count_max;
    options.now_ns = clock;
    net = &backend;
    link = simulated ? null_link_open(options, settings, &error) : below.open(options, &error);
    REQUIRE_MESSAGE(link != nullptr, error.text);
    if (shaped) open_radio(stream_count_max, radio);
    if (encrypted) encrypt(stream_count_max);
    REQUIRE_MESSAGE(link != nullptr, error.text);
    REQUIRE(net->resolve(":0", &address, &error));
    listener = net->listen(link, address, &error);
    REQUIRE_MESSAGE(listener >= 0, error.text);
    REQUIRE(net->resolve(net->stream_name(link, listener), &address, &error));
  }
  void open_radio(int stream_count_max, const ShapedLinkSettings& radio) {
    inner = link;
    link = shaped_link_open(inner, upper_options(stream_count_max, shaped_link_need(stream_count_max, radio)), radio,
                            &error);
  }
  void encrypt(int stream_count_max) {
#ifdef POCKETRAY_HAVE_TLS
    TlsLinkSettings settings;
    settings.key.bytes[0] = 1;
    settings.random = random_bytes;
    inner = link;
    link = tls_link_open(inner, upper_options(stream_count_max, tls_link_need(stream_count_max)), settings, &error);
#else
    (void)stream_count_max;
#endif
  }
  LinkOptions upper_options(int stream_count_max, std::size_t byte_count) {
    LinkOptions options;
    options.memory_bytes = byte_count;
    upper_memory.resize(byte_count / sizeof(std::max_align_t) + 1);
    options.memory = upper_memory.data();
    options.stream_count_max = stream_count_max;
    return options;
  }
  ~LinkRig() {
    net->close_all(link);
    if (inner) inner->backend->close_all(inner);
  }
  LinkRig(const LinkRig&) = delete;
  LinkRig& operator=(const LinkRig&) = delete;

  bool wait(int stream, bool read, bool write, std::uint64_t timeout_ns = 2000 * kMs) {
    LinkWait one;
    one.stream = stream;
    one.want_read = read;
    one.want_write = write;
    return net->poll(link, &one, 1, timeout_ns) == 1;
  }
  // Both ends of a new connection; false: `error` says why.
  bool pair(int* device, int* server) {
    *device = net->connect(link, address, 2000 * kMs, &error);
    if (*device < 0 || !wait(listener, true, false)) return false;
    if (net->accept(link, listener, server, &error) != LinkResult::done) return false;
    return wait(*device, false, true) && net->connected(link, *device, &error) == LinkResult::done;
  }
  // Writes everything, waiting for room; false if the connection fails or stalls.
  bool write_all(int stream, const std::string& bytes) {
    for (std::size_t sent = 0; sent < bytes.size();) {
      std::size_t count = 0;
      LinkResult result = net->write(link, stream, bytes.data() + sent, bytes.size() - sent, &count, &error);
      sent += count;
      if (result == LinkResult::failed || (result == LinkResult::later && !wait(stream, false, true))) return false;
    }
    return true;
  }
  // Reads until `byte_count` bytes, the end, a failure, or silence for `timeout_ns`; `result` tells which.
  std::string read_all(int stream, std::size_t byte_count, LinkResult* result, std::uint64_t timeout_ns = 2000 * kMs) {
    std::string bytes;
    char part[4096];
    *result = LinkResult::done;
    while (bytes.size() < byte_count) {
      std::size_t count = 0, most = byte_count - bytes.size();
      *result = net->read(link, stream, part, most < sizeof part ? most : sizeof part, &count, &error);
      bytes.append(part, count);
      if (*result == LinkResult::ended || *result == LinkResult::failed) break;
      if (*result == LinkResult::later && !wait(stream, true, false, timeout_ns)) break;
    }
    return bytes;
  }
};

// Bytes in which every offset is recognisable.
inline std::string counted_bytes(std::size_t byte_count) {
  std::string bytes(byte_count, 0);
  for (std::size_t i = 0; i < byte_count; ++i) bytes[i] = static_cast<char>((i * 2654435761u) >> 13);
  return bytes;
}

}  // namespace platform
