// The render server: renders rows of frames for up to a few clients at once, each in memory of its own, by the protocol
// of wire/PROTOCOL.md. A step function: single-threaded but for the threads that trace, without globals, waiting only
// where the link is polled. It takes every time from the link's clock.
#pragma once
#include <cstdint>

#include "base/status.h"
#include "engine/pace.h"
#include "platform/link.h"
#include "remote/server/scene_store.h"

namespace pocketray {

constexpr int kServerClientsMax = 64;

struct ServerOptions {
  int client_count_max = 8;                           // one more is told `busy`
  int guest_count_max = 16;                           // connections that have not said hello, or are told to go
  std::size_t client_memory_bytes = 64u << 20;        // block of each: buffers, encoder, renderer; without the scene
  std::uint32_t image_side_max = 2048;                // pixels; larger pictures are refused
  std::uint32_t thread_count = 1;                     // that trace, shared by all clients
  Pace pace;                                          // the CPU to emulate: what pixels cost it, and
  std::uint64_t message_ns = 0, byte_ps = 0;          //   a message and a byte of its answer; 0: nothing
  const float* row_costs = nullptr;                   //   rows over each other, see row_costs.h
  std::uint64_t message_timeout_ns = 10'000'000'000;  // for a message to be whole; the hello, from the start
  std::uint64_t idle_timeout_ns = 300'000'000'000;    // without a message, nor anything to send
  std::uint64_t stall_timeout_ns = 10'000'000'000;    // without taking anything of what is sent
  void (*log)(void* context, const char* line) = nullptr;  // one line for each event, no more than a few a second
  void* log_context = nullptr;
};

struct ServerTotals {
  std::uint64_t client_count = 0;                                // that said hello
  std::uint64_t frame_count = 0, row_count = 0, byte_count = 0;  // sent
};

struct Server;

// Streams of its link that a server takes.
int server_stream_count(const ServerOptions& options);
// Takes all memory, listens and starts the threads; nothing is allocated afterwards. The store and the link stay the
// caller's and have to outlive the server; the store may be filled until the first step. On failure *server is null.
Status open_server(const ServerOptions& options, const SceneStore& store, platform::Link* link,
                   const platform::LinkAddress& address, Server** server);
// Where it listens, HOST:PORT in numbers.
const char* server_address(const Server& server);
// One round: waits for news, `timeout_ns` at most and not at all while there is work; takes what clients sent, renders
// a part of one frame, sends what is ready.
void step_server(Server* server, std::uint64_t timeout_ns);
ServerTotals server_totals(const Server& server);
// Tells the clients, for half a second at most, and gives everything back. Null is allowed.
void close_server(Server* server);

}  // namespace pocketray
