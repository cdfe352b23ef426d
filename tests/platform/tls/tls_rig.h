// Encrypted links of a device and of a server over one simulated link, and somebody between them who sees and changes
// what passes.
#pragma once
#include <doctest/doctest.h>

#include <cstdint>
#include <string>
#include <vector>

#include "platform/net/tls/tls_link.h"
#include "platform/null/net/null_link.h"

namespace platform {

// Random bytes that are the same every time.
bool tls_test_random(void* bytes, std::size_t byte_count);

// Memory as heaps of the library need it, on 32-bit machines, too.
struct alignas(16) HeapGrain {
  unsigned char bytes[16];
};

constexpr std::size_t kNowhere = ~std::size_t(0);

// What the one between does to the bytes of a direction: from an offset on, once.
struct Tampering {
  bool to_server = true;
  std::size_t at = kNowhere;
  unsigned char flip = 0;  // XORed into the byte; 0: the connection is cut before it
};

struct TlsMeeting {
  bool device_connected = false, server_connected = false;
  Error device_error, server_error;      // why not
  std::string from_device, from_server;  // all bytes that passed, before the tampering
  int device = -1, server = -1;          // their streams, still open
  int relay[2] = {-1, -1};               // of the one between: towards the device and towards the server
};

struct TlsRig {
  static constexpr int kStreamCount = 24;  // of each encrypted link
  std::vector<std::max_align_t> below_memory, server_memory, device_memory;
  Link *below = nullptr, *server = nullptr, *device = nullptr;
  int listener = -1, relay_listener = -1;
  LinkAddress address, relay_address;  // of the server, and of the one between
  Error error;

  explicit TlsRig(unsigned char server_key = 1, unsigned char device_key = 1);
  ~TlsRig();
  TlsRig(const TlsRig&) = delete;
  TlsRig& operator=(const TlsRig&) = delete;

  // The device meets the server through the one between, until both know whether they are connected, or nothing moves
  // any more.
  TlsMeeting meet(const Tampering& tampering = Tampering());
  // Passes on what has come, in both directions.
  bool relay(TlsMeeting* meeting, const Tampering& tampering);
  void end(TlsMeeting* meeting);
  // A connection below to the server, which gets these bytes; returns the stream, and the server's.
  int attack(const std::string& bytes, int* accepted);
  // Lets the server handle what has come, until nothing moves any more. True if it takes the peer for connected.
  bool serve(int accepted, Error* why);
  std::string read_below(int stream);
  // From here on the server's random bytes come from there.
  void dawdle(bool (*random)(void*, std::size_t));
};

}  // namespace platform
