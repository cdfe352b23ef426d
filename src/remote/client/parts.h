// What the client's files share: client.cpp has the frame, client_plan.cpp who renders what of it, client_server.cpp
// the connections, client_ping.cpp what answers tell of them, client_thin.cpp what is different for a device without
// the scene, client_verify.cpp and client_witness.cpp whether servers send the right pixels.
#pragma once
#include "remote/client/client.h"

namespace pocketray {

inline std::uint32_t index_of(const Client& client, const RemoteServer* server) {
  return static_cast<std::uint32_t>(server - client.servers);
}

// ---- client_server.cpp

// Goes on with connecting, the overture and what has come.
void advance_server(Client* client, RemoteServer* server);
// Closes the connection; the reason is told once until the server is in use again, and it is tried again later.
void lose_server(Client* client, RemoteServer* server, const char* reason);
// How long it may be silent where something is awaited of it.
std::uint64_t silence_limit_ns(const Client& client, const RemoteServer& server);
// Sends what waits to be sent, as far as it goes.
void flush_server(Client* client, RemoteServer* server);
// The overture is over and all of it known.
void server_is_ready(Client* client, RemoteServer* server);
// Rows have come from it: where its loss was told, so is that it is back.
void server_is_useful(Client* client, RemoteServer* server);
// The next phase of its overture.
void enter(Client* client, RemoteServer* server, ServerPhase phase);
// Queues a message; a server that reads none is lost.
void send(Client* client, RemoteServer* server, const Message& message);
constexpr const char* kUnasked = "it sends what it was not asked for";

// ---- client_ping.cpp

constexpr double kUnsound = 2;  // RemoteServer::scaled of a link that is to be measured anew

void send_ping(Client* client, RemoteServer* server, std::uint32_t reply_bytes);
void take_pong(Client* client, RemoteServer* server, const Pong& pong);
// Whether a link is being measured, which rows of others on their way would disturb.
bool wants_quiet(const Client& client);
// Asks servers in use for an answer that measures their link, where what is known of it has become doubtful.
void measure_anew(Client* client);
// How long it is worth while to do nothing but wait for an answer, so that its time is measured well.
std::uint64_t wait_wanted_ns(const Client& client);

// ---- client_plan.cpp

// What a pixel costs the device, by this frame or those before; 0: not known.
double device_pixel_ns(const Client& client);
// The split for the frame, of which `elapsed_ns` have passed, and the requests that follow.
void share_rows(Client* client, std::uint64_t elapsed_ns);
// Asks a server for rows; those at the end that are done are left out.
void ask_for_rows(Client* client, RemoteServer* server, std::uint32_t row_begin, std::uint32_t row_end);
// The same, whether or not they are done.
void request_rows(Client* client, RemoteServer* server, std::uint32_t row_begin, std::uint32_t row_end);
// Servers that have become ready within the frame get their share of what is left, once nobody is worth waiting for.
void let_join(Client* client);
// What the frame's rows tell of the link. They come as fast as the slower of servers and link allows: where the servers
// were faster, or the link did better than it was thought to be, that is its speed.
void measure_link(Client* client);

// ---- client_thin.cpp: the device without the scene

// Servers that have nothing to do get rows that nobody is asked for, or that another is late with.
void ask_idle_servers(Client* client);
// How long rows of this frame took each server: by that the next frame is shared.
void learn_row_times(Client* client);

// ---- client_verify.cpp

// A frame begins.
void begin_checks(Client* client);
// A server's rows [row_begin, row_end) of this frame have come and are decoded, some perhaps not for the first time:
// false, and the server is not used any more, where they are not what the device has rendered.
bool agrees_with_device(Client* client, RemoteServer* server, std::uint32_t row_begin, std::uint32_t row_end);
// It has sent wrong pixels: one line says so, its rows of this frame are missing again, and it is never used any more.
void drop_liar(Client* client, RemoteServer* server, const char* proof);

// ---- client_witness.cpp: checks without the scene

// As agrees_with_device(), with the rows of other servers; where they differ, a third is asked later.
void compare_with_others(Client* client, RemoteServer* server, std::uint32_t row_begin, std::uint32_t row_end);
// As is_verified().
bool is_witnessed(Client* client);

// ---- shared_frame.cpp

// Takes the time that the emulated device takes for work on so many pixels; returns how long that was.
std::uint64_t take_time(Client* client, std::uint64_t pixel_count, std::uint64_t begin_ns);

// ---- client.cpp

// Decoded rows have come, of so many bytes on the wire.
void accept_chunk(Client* client, RemoteServer* server, const RowChunk& chunk, std::uint32_t byte_count);
// Waits as a CPU that is at work does: the link goes on receiving, and nobody looks.
void work_until(Client* client, std::uint64_t due_ns);

}  // namespace pocketray
