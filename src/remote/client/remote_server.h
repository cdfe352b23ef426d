// A render server as its client knows it, by duty: the overture of its connection, its link, requested rows and light,
// and the checks of its pixels.
#pragma once
#include "remote/client/verify.h"
#include "remote/stream.h"
#include "split/smooth.h"
#include "wire/codec.h"
#include "wire/message.h"
#include "wire/row_sequence.h"

namespace pocketray {

enum class ServerPhase : std::uint8_t {
  waiting,  // for the next attempt to connect
  connecting,
  greeting,   // hello
  asking,     // for the scene
  measuring,  // the link: pings
  probing,    // the server: its first rows
  ready,
};

const char* phase_text(ServerPhase phase);
// Describes a server's error and how to mend it.
const char* wire_error_text(WireError code);

// A server's rows in a frame.
struct ServerFrame {
  std::uint32_t row_begin = 0, row_end = 0;  // requested
  std::uint32_t rows_come = 0;               // received, including rows the device had already done
  std::uint64_t asked_ns = 0, bytes = 0;
  std::uint64_t row_bytes = 0;  // bytes of received rows without message overhead
  double render_ns = 0;         // the server's work on received rows, at its price
  double prepare_ns = 0;        // its work before them
  bool open = false;            // more rows are expected
  std::uint64_t heard_ns = 0;   // when the latest rows came, as seen: at most unseen_ns earlier
  std::uint64_t unseen_ns = 0;
  std::uint64_t first_ns = 0;      // when the first rows came
  std::uint64_t bytes_behind = 0;  // bytes of the chunks after the first
  double render_behind_ns = 0;     // the server's time for their rows
  bool answers = false;            // has answered since the request, even if only a ping
};

// From the first attempt to connect until the server is in use.
struct Overture {
  ServerPhase phase = ServerPhase::waiting;
  std::uint64_t phase_ns = 0;   // when it began
  platform::LinkTimer timer;    // of the phase: next attempt, or when the server counts as lost
  std::uint64_t retry_ns = 0;   // until the next attempt
  bool told = false;            // the reason it is not in use has been logged
  bool lied = false;            // has sent wrong pixels and is never used again
  std::uint64_t useful_ns = 0;  // when this connection first brought rows; 0: not yet
  double probe_ns_per_pixel = 0;
};

// The link, measured by pings and by the arrival of rows.
struct ServerLink {
  std::uint32_t ping_id = 0, ping_bytes = 0;           // the ping awaiting an answer, and its payload; id 0: none
  std::uint32_t pings_answered = 0, pings_missed = 0;  // missed: the device did not poll when the answer came
  std::uint64_t ping_ns = 0, ping_due_ns = 0;
  bool ping_alone = false;         // no rows of any server were in flight when it was sent
  std::uint64_t late_at_ping = 0;  // ServerRows::late_rows when it was sent
  double round_trip_ns = 0, ns_per_byte = 0;
  double scaled = 1;                 // factor on ns_per_byte from rows' times since its own measurement
  std::uint64_t quiet_until_ns = 0;  // until then the link is measured and others send no rows
  std::uint64_t anew_ns = 0;         // earliest time of its next measurement
};

// Rows requested and received.
struct ServerRows {
  FrameRequest asked;                // last request; frame 0: none on this connection
  RowSequence due;                   // rows of it that are still expected,
  std::uint32_t due_rows = 0;        // and their number
  std::uint64_t late_rows = 0;       // rows of earlier requests that may be in flight
  std::uint32_t coarse_due = 0;      // coarse pictures that may still come
  Smoothed row_ns;                   // for a device without the scene: time from request to arrival of a row
  bool more = false;                 // unread input remains: one poll handles at most a frame's worth
  bool unanswered = false;           // no answer since rows were requested; new requests do not extend the time
  std::uint32_t chunk_count = 0;     // received on this connection
  std::uint16_t price = kPriceUnit;  // as last stated
  ServerFrame frame;
};

// Light maps requested.
struct ServerLight {
  std::uint32_t due = 0;       // maps that may still come
  std::uint64_t asked_ns = 0;  // when the current request's light was requested; 0: none is due
  std::uint32_t missed = 0;    // connections since the last map that ended before one came
};

// A server asked for another one's row.
struct Witness {
  bool is_asked = false;
  ServerFrame frame_before;  // its own rows of the frame meanwhile
};

struct RemoteServer {
  platform::LinkAddress address;
  MessageStream messages;
  RowDecoder* decoder = nullptr;
  Overture overture;
  ServerLink link;
  ServerRows rows;
  ServerLight light;
  Witness witness;
  ServerChecks checks;
};

}  // namespace pocketray
