// Shared by the client's files: client.cpp has the frame, plan.cpp the split, peer.cpp the connections, ping.cpp the
// measurement of links, thin.cpp the differences on a device without the scene, verify.cpp and witness.cpp the checks
// of servers' pixels, outlook.cpp how long a frame will take.
#pragma once
#include "remote/client/client.h"

namespace pocketray {

inline std::uint32_t index_of(const Client& client, const RemoteServer* server) {
  return static_cast<std::uint32_t>(server - client.servers);
}

// True if the frame's rows are divided among device and servers; otherwise the device has all of them.
inline bool divides_rows(const Client& client) { return !client.light.by_effect || client.light.shares_rows; }

// A message's price as the cost model uses it.
constexpr double price_ratio(std::uint16_t price) { return static_cast<double>(price) / kPriceUnit; }

// ---- peer.cpp

// Advances connecting, the overture and reading.
void advance_server(Client* client, RemoteServer* server);
// Closes the connection and tries again later. Logs the reason once until the server is in use again.
void lose_server(Client* client, RemoteServer* server, const char* reason);
// Longest silence of the server while an answer is due.
std::uint64_t silence_limit_ns(const Client& client, const RemoteServer& server);
// Sends queued messages as far as possible.
void flush_server(Client* client, RemoteServer* server);
// Call when the overture is complete.
void server_is_ready(Client* client, RemoteServer* server);
// Call when its rows have come; logs its return if its loss was logged.
void server_is_useful(Client* client, RemoteServer* server);
// Enters the next phase of its overture.
void enter(Client* client, RemoteServer* server, ServerPhase phase);
// Queues a message; drops a server that stopped reading.
void send(Client* client, RemoteServer* server, const Message& message);
constexpr const char* kUnasked = "it sent an unrequested message";

// ---- ping.cpp

// Derived: above kScaledMax and kScaledAloneMax of ping.cpp, so that the link counts as doubtful.
constexpr double kUnsound = 2;  // RemoteServer::scaled at which a link is measured again

void send_ping(Client* client, RemoteServer* server, std::uint32_t reply_bytes);
void take_pong(Client* client, RemoteServer* server, const Pong& pong);
// True while a link is being measured, which others' rows would disturb.
bool wants_quiet(const Client& client);
// Pings servers in use to measure their link again if its figures have become doubtful.
void measure_anew(Client* client);
// How long to idle for an answer in order to time it precisely.
std::uint64_t wait_wanted_ns(const Client& client);

// ---- plan.cpp

// The device's time per pixel, from this frame or earlier ones; 0: unknown.
double device_pixel_ns(const Client& client);
// Plans the split and sends the requests.
void share_rows(Client* client);
// Requests rows from a server, without finished rows at the ends: in the fastest order according to the problem, or
// from the bottom upward.
void ask_for_rows(Client* client, RemoteServer* server, std::uint32_t row_begin, std::uint32_t row_end,
                  const SplitProblem* problem = nullptr);
// Requests rows likewise, including finished ones.
void request_rows(Client* client, RemoteServer* server, std::uint32_t row_begin, std::uint32_t row_end,
                  const SplitProblem* problem = nullptr);
// Sends a request as it is, if possible as a change of the last one. From then on its rows and light are due.
void send_request(Client* client, RemoteServer* server, Message* message);
// Gives servers that became ready during the frame a share of the rest, once no server is worth waiting for.
void let_join(Client* client);
// Measures the link by the frame's rows. Rows come as fast as the slower of servers and link allows: if the servers
// were faster, or the link did better than estimated, their rate is its speed.
void measure_link(Client* client);
// Assumes that the link of several servers is faster, or reverts that, depending on the frame.
void try_link(Client* client);

// ---- thin.cpp: the device without the scene

// Requests from idle servers the rows that no server was asked for, or that another server is late with.
void ask_idle_servers(Client* client);
// Records how long this frame's rows took each server, for the next split.
void learn_row_times(Client* client);

// ---- verify.cpp

// Call when a frame begins.
void begin_checks(Client* client);
// Compares a server's decoded rows [row_begin, row_end), possibly repeated ones, with those the device has rendered. On
// a mismatch, drops the server for good and returns false.
bool agrees_with_device(Client* client, RemoteServer* server, std::uint32_t row_begin, std::uint32_t row_end);
// Drops a server with wrong pixels for good: logs one line and marks its rows of this frame as missing.
void drop_liar(Client* client, RemoteServer* server, const char* proof);

// ---- witness.cpp: checks without the scene

// Compares against other servers' rows; on a mismatch, a third server decides.
void compare_with_others(Client* client, RemoteServer* server, std::uint32_t row_begin, std::uint32_t row_end);
// is_verified() without the scene.
bool is_witnessed(Client* client);

// ---- frame.cpp

// Prepares the device for the current frame.
void prepare_device(Renderer* renderer, Client* client);
// Packs rows of the device's picture into the merged one.
void pack_device_rows(const Renderer& renderer, Client* client, std::uint32_t row_begin, std::uint32_t row_end);
// Waits until the emulated device would have traced `pixel_count` pixels; returns that time.
std::uint64_t take_time(Client* client, std::uint64_t pixel_count, std::uint64_t begin_ns);

// ---- outlook.cpp

// Time the device would need for the missing rows, estimated from this frame and from earlier ones; the longer of
// both.
double rows_left_ns(const Client& client);
// Time left to prepare the frame.
double preparing_left_ns(const Client& client);
// Time left to decode the missing rows.
double decoding_left_ns(const Client& client);

// Derived: a network may cost 5 % of a frame, of which spot checks take 1 and the first estimate of a link the
// rest.
constexpr double kWaitShare = 0.03;  // of a frame's time that the device may wait in vain
// How much longer the device may idle in this frame and still finish within 1 + kWaitShare times its time alone, even
// if nothing more arrives. The estimate is conservative: rows count with their time in this frame or, scaled down by as
// much as this frame's rows are cheaper, in earlier frames. Rows that the device never rendered count kCertainPart of
// the mean; arrived rows count `come_share` of the time they saved.
double time_to_spare(const Client& client, double come_share);
// True if the servers' rows are due before the device could render one and decode the others, or late by less than it
// takes to render one, and the device would still finish about as early as alone if none arrived.
bool is_worth_waiting(const Client& client);

// ---- coarse.cpp

// Makes the next request ask for a coarse picture if a frame of that time needs one and none is requested; 0: unknown.
void want_coarse(Client* client, double frame_ns);
// True while it may come any moment: at most for a tenth of the frame, since frequent polling slows the device.
bool awaits_coarse(const Client& client);
// Shows the coarse picture where rows are missing.
void show_coarse(Client* client, const CoarsePicture& coarse);

// ---- light.cpp

// Call when a frame begins, after choose_split(), and when it ends.
void begin_light_frame(Client* client);
void end_light_frame(Client* client);
// Device time per row in by-effect mode, as a fraction of a full row.
double own_light_part(const Client& client);
// Index of the server whose next request asks for the current frame's light; kNone: none.
std::uint32_t mapper_of_frame(Client* client);
// Adds the light to a request if it goes to that server. Returns true if so.
bool want_light_with(Client* client, RemoteServer* server, FrameRequest* request);
// Requests the light from that server, if it has no rows to send.
void ask_for_light(Client* client);
// True if the light of its last request is still due. It comes before the rows.
inline bool awaits_light(const RemoteServer& server) {
  return server.light.due > 0 && server.rows.asked.light_pitch > 0;
}
void take_light(Client* client, RemoteServer* server, LightMapMessage message);
// Call when the server will not send the requested light, or too late.
void forget_light_of(Client* client, std::uint32_t server);
// Adds light to the next rows that the device has traced, once it has no more to trace or the frame has all its rows.
// Returns false if there are none, or their light is still due.
bool light_rows(Renderer* renderer, Client* client);
// True if a complete frame has all the light it gets; false: some is due, or still to be added.
bool is_lit(const Client& client);

// ---- client.cpp

// Call when rows of client->pixels have changed.
void mark_dirty(Client* client, std::uint32_t row_begin, std::uint32_t row_end);
// Call when rows are decoded; `byte_count` is their size on the wire.
void accept_chunk(Client* client, RemoteServer* server, const RowChunk& chunk, std::uint32_t byte_count);
// Waits like a busy CPU: the link keeps receiving but is not polled.
void work_until(Client* client, std::uint64_t due_ns);

}  // namespace pocketray
