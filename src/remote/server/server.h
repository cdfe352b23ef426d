// The render server: renders rows of frames for a few clients at once, each in its own memory, over the protocol of
// wire/PROTOCOL.md. Driven by a step function: single-threaded except for tracing, no globals, blocks only while
// polling the link. All times are from the link's clock, except clients' shares of the CPU: they must not pay for other
// programs.
#pragma once
#include <cstdint>

#include "base/status.h"
#include "engine/pace.h"
#include "platform/link.h"
#include "remote/server/scene_store.h"
#include "wire/code_cost.h"

namespace pocketray {

constexpr int kServerClientsMax = 64;  // chosen: with the default memory, they take 4 GiB

struct HelperRanks;  // session.h

// Defaults, chosen: eight clients take half a GiB, and the radiance of the largest picture takes 48 of a client's 64
// MiB. A client itself gives up after 3 s (client.h), so 10 s end only lost connections. A viewer at rest sends
// nothing; it keeps its place for minutes unless another needs it (kMakeWayNs).
struct ServerOptions {
  int client_count_max = 8;                                // further ones are told `busy`
  int guest_count_max = 16;                                // connections before their hello or about to close
  std::size_t client_memory_bytes = 64u << 20;             // per client: buffers, encoder, renderer; without the scene
  std::uint32_t image_side_max = 2048;                     // pixels; larger pictures are refused
  std::uint32_t thread_count = 1;                          // for tracing, shared by all clients
  CoherenceMode coherence = CoherenceMode::automatic;      // as far as a client's memory allows
  const HelperRanks* helpers = nullptr;                    // ranks that render with this program; null: none
  Pace pace;                                               // the CPU to emulate: cost of pixels,
  std::uint64_t message_ns = 0, byte_ps = 0;               // of a message and a byte of its answer (0: none),
  const float* row_costs = nullptr;                        // and relative cost of rows; see row_costs.h
  CodeCost encode;                                         // and of coding rows; 0: none
  std::uint64_t message_timeout_ns = 10'000'000'000;       // for a complete message; for the hello, since connecting
  std::uint64_t idle_timeout_ns = 300'000'000'000;         // without a message and with nothing to send
  std::uint64_t stall_timeout_ns = 10'000'000'000;         // without the client reading anything
  std::uint64_t (*cpu_ns)() = nullptr;                     // measures clients' shares; null: the link's clock
  void (*log)(void* context, const char* line) = nullptr;  // writes one line per event, rate-limited
  void* log_context = nullptr;
};

struct ServerTotals {
  std::uint64_t client_count = 0;                                // that said hello
  std::uint64_t frame_count = 0, row_count = 0, byte_count = 0;  // sent
};

struct Server;

// Number of link streams that a server uses.
int server_stream_count(const ServerOptions& options);
// Allocates all memory, listens and starts the threads; allocates nothing afterwards. The caller keeps the store and
// the link, which must outlive the server; the store may be filled until the first step. On failure *server is null.
Status open_server(const ServerOptions& options, const SceneStore& store, platform::Link* link,
                   const platform::LinkAddress& address, Server** server);
// Returns its numeric listening address, HOST:PORT.
const char* server_address(const Server& server);
// Runs one round: reads messages, renders a part of one frame, sends finished rows. Blocks for at most `timeout_ns`,
// and not while there is work.
void step_server(Server* server, std::uint64_t timeout_ns);
ServerTotals server_totals(const Server& server);
// Notifies the clients, for at most half a second, and frees everything. Accepts null.
void close_server(Server* server);

}  // namespace pocketray
