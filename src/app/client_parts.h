// What the client's files share: client.cpp has the frame, client_server.cpp the connections.
#pragma once
#include "app/client.h"

namespace pocketray {

// ---- client_server.cpp

// Goes on with connecting, the overture and what has come.
void advance_server(Client* client, RemoteServer* server);
// Closes the connection; the reason is told once until the server is in use again, and it is tried again later.
void lose_server(Client* client, RemoteServer* server, const char* reason);
// Sends what waits to be sent, as far as it goes.
void flush_server(Client* client, RemoteServer* server);
// The overture is over and all of it known.
void server_is_ready(Client* client, RemoteServer* server);
// How long it is worth while to do nothing but wait for an answer, so that its time is measured well.
std::uint64_t wait_wanted_ns(const Client& client);

// ---- client.cpp

// Decoded rows have come, of so many bytes on the wire.
void accept_chunk(Client* client, RemoteServer* server, const RowChunk& chunk, std::uint32_t byte_count);
// Waits as a CPU that is at work does: the link goes on receiving, and nobody looks.
void work_until(Client* client, std::uint64_t due_ns);

}  // namespace pocketray
