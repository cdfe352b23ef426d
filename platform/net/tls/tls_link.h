// Encrypted links: a link on top of another whose streams are TLS connections with a shared key (tls_stream.h). Peers
// with a different key, or without one, never become connected. The interface is as without encryption.
//
// - A connection counts as connected when its handshake is complete, all within the time to connect.
// - A peer that was accepted has kTlsHandshakeNs for its handshake, during which nothing is read from it; then reading
//   fails. Handshakes of accepted peers advance in poll() alone, one step of one stream at a time; after each they rest
//   for kTlsRestFactor times as long as it took. So a flood of them leaves three quarters of the CPU to the others.
// - close() tells the peer that nothing more comes, unless bytes from it are left unread.
// - A stream that ends without such a message has failed, so nobody in between can cut the
//   connection unnoticed.
#pragma once
#include "platform/link.h"
#include "platform/net/key_file.h"

namespace platform {

// Chosen: 3 s for a client to answer (remote/client/client.h), and a second round after a lost packet.
constexpr std::uint64_t kTlsHandshakeNs = 5'000'000'000;
// Chosen: with two steps of 3 ms, a peer that comes alone notices only one rest.
constexpr std::uint64_t kTlsRestFactor = 3;

struct TlsLinkSettings {
  SharedKey key;
  bool (*random)(void* bytes, std::size_t byte_count) = nullptr;  // as in platform/entropy.h
};

// Bytes of memory for that many streams.
std::size_t tls_link_need(int stream_count_max);
// `inner` must have room for as many streams; the caller keeps it, it must outlive this link, and others may share it.
// The clock is the inner one. `options.now_ns` is ignored. The key is wiped from the memory by close_all().
Link* tls_link_open(Link* inner, const LinkOptions& options, const TlsLinkSettings& settings, Error* error);

// Functions of such a link over links of that kind, except need() and open(), which are above.
LinkBackend tls_link_backend(const LinkBackend& inner);

struct TlsLinkRecord {
  std::uint64_t handshakes = 0, failures = 0;  // completed; started but failed
  std::size_t heap_bytes_max = 0;              // most that a stream has used of its kTlsStreamHeapBytes
};
TlsLinkRecord tls_link_record(const Link* link);

}  // namespace platform
