// One TLS 1.2 connection with a pre-shared key [RFC 4279], over a stream of another link, by mbedTLS. For tls_link.cpp,
// which decides when to call what.
//
// The only cipher suite is TLS-ECDHE-PSK-WITH-CHACHA20-POLY1305-SHA256 [RFC 7905] over Curve25519: it needs no AES in
// hardware, and a key that leaks later does not decrypt earlier recordings. AES-GCM is left out on purpose: in Debian's
// mbedTLS 2.28 it is slower than ChaCha20 even with the CPU's AES instructions (105 against 166 MB/s), and it comes
// without forward secrecy or with a Diffie-Hellman of 2048 bits. No certificates, resumption or renegotiation.
#pragma once
#include <mbedtls/ssl.h>

#include "platform/link.h"
#include "platform/net/key_file.h"
#include "platform/net/tls/tls_heap.h"

namespace platform {

// Identity of the key, for `openssl s_client -psk_identity`.
constexpr char kTlsIdentity[] = "pocketray";
// Payload of a record: 21 bytes more on the wire. Chosen: a receiver can use nothing of a record before all of it has
// come, and 4 KiB take 3 ms at 10 Mbit/s, for 0.5 % more bytes.
constexpr std::size_t kTlsRecordBytes = 4096;

// Measured by tls_handshake_memory_is_within_its_plan: the library's buffers of 16 KiB each way take 33.5 KiB, the rest
// is for the handshake, and freed after it.
constexpr std::size_t kTlsStreamHeapBytes = 40 << 10;
constexpr std::size_t kTlsConfigHeapBytes = 4 << 10;

struct TlsConfig {
  mbedtls_ssl_config client, server;
  TlsHeap heap;
  bool (*random)(void* bytes, std::size_t byte_count);  // as in platform/entropy.h
};

// `memory`: kTlsConfigHeapBytes, aligned to 16; the config must not be moved. Returns false with the reason in `error`.
bool tls_config_start(TlsConfig* config, const SharedKey& key, bool (*random)(void*, std::size_t), void* memory,
                      Error* error);
void tls_config_end(TlsConfig* config);

enum class TlsFault : std::uint8_t {
  none,
  link,       // the connection below failed or ended; `error` of the stream says so
  plain,      // the peer does not use TLS
  wrong_key,  // its key differs
  refused,    // it refused the handshake: no common cipher or version
  memory,     // the handshake needs more than was planned
  random,     // the system has no random bytes
  broken,     // bytes that TLS does not allow
};

struct TlsStream {
  mbedtls_ssl_context ssl;
  TlsHeap heap;
  Link* below;
  int stream;  // of the link below; the caller opens and closes it
  TlsConfig* config;
  TlsFault fault;
  int code;       // the library's, of the fault
  bool has_read;  // the first byte has come
  bool said_farewell;
  bool wants_write;  // the last `later` was for room below, not for bytes
  Error error;       // of the link below
};

// Begins a handshake; `memory` is aligned to 16, `byte_count` a multiple of it, kTlsStreamHeapBytes except in tests.
// Returns false if it is too small; the stream must then not be ended.
bool tls_begin(TlsStream* tls, TlsConfig* config, bool as_server, Link* below, int stream, void* memory,
               std::size_t byte_count);
// Advances the handshake. One call costs at most one Diffie-Hellman exchange. After `failed`, as with the calls below,
// `fault` says why and the peer has been told as far as there was room.
LinkResult tls_handshake(TlsStream* tls);
// Like the link's functions. A written record without room below is kept; `later` until it has gone.
LinkResult tls_read(TlsStream* tls, void* bytes, std::size_t byte_count_max, std::size_t* byte_count);
LinkResult tls_write(TlsStream* tls, const void* bytes, std::size_t byte_count_max, std::size_t* byte_count);
// Sends what is kept of the last record. done: nothing is left.
LinkResult tls_flush(TlsStream* tls);
inline bool tls_keeps_output(const TlsStream& tls) { return tls.ssl.out_left != 0; }
// Returns whether tls_read() has bytes without asking the link below.
bool tls_has_input(const TlsStream& tls);
// Tells the peer that nothing more comes. later: call again when there is room.
LinkResult tls_farewell(TlsStream* tls);
// Frees its memory and wipes its secrets; not the stream below.
void tls_end(TlsStream* tls);

// Describes the peer's failure and how to mend it, beginning with its name.
void tls_tell(const TlsStream& tls, const char* peer, Error* error);

}  // namespace platform
