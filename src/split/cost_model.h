// Cost model: what rows cost on the device and on each server, as measured in the last frames, and the split problem
// that follows from it ([Aranha07] sec. 3.3, per row instead of a mean, and with what the paper leaves open in sec. 5:
// several servers, money, energy). Pure: times are handed in. Numbers that are no measurements change nothing.
//
// A frame: find_split() or next_split() of make_problem(); render; report with observe_*(); end_frame().
#pragma once
#include <cstdint>

#include "base/arena.h"
#include "split/closed_form.h"
#include "split/smooth.h"
#include "split/split.h"

namespace pocketray {

// Bytes and the time they took, over a frame.
struct ByteTimes {
  double bytes = 0, ns = 0;
};

struct ServerModel {
  bool connected = false;         // false: gets no rows
  Smoothed speed;                 // its time for a row over the device's time for it
  Smoothed ns_per_byte;           // to send from it
  Smoothed start_ns;              // request to the first chunk, beyond that chunk's rendering and sending
  double cost_per_megabyte = 0;   // price of 10⁶ bytes from it, in the caller's unit
  std::uint32_t chunk_rows = 16;  // rows it sends at once
  ByteTimes transfer_seen;        // in the current frame
};

struct RowModel {
  Smoothed device_ns;    // wall time of the device for the row, whether or not it rendered it
  Smoothed bytes;        // as it is sent
  bool guessed = false;  // device_ns follows from other rows: the device has never rendered this one
  // Of the current frame; 0: not observed.
  float device_ns_seen = 0, server_ns_seen = 0;
  std::uint8_t server_seen = 0;
};

struct CostModel {
  std::uint32_t width = 0;  // pixels of a row
  Array<RowModel> rows;
  std::uint32_t server_count = 0;
  ServerModel servers[kServerCountMax];
  Smoothed device_start_ns;          // before the first row: pose, refit
  Smoothed unpack_ns_per_byte;       // device time to decode what is received
  Smoothed link_ns_per_byte;         // of the link that all servers share; not known: no bound but each server's own
  ByteTimes unpack_seen, link_seen;  // in the current frame
  double cost_per_device_pixel = 0;  // energy, in the caller's unit
  double cost_per_byte = 0;          // energy of receiving
  Array<std::uint64_t> tables;       // behind the problem
};

enum class SplitGoal {
  time,            // soonest; among equals the fewest bytes
  time_and_cost,   // least time + ns_per_cost × cost
  time_under_cap,  // soonest that costs at most the cap
};
struct SplitWish {
  SplitGoal goal = SplitGoal::time;
  double ns_per_cost = 0;  // λ: what a unit of cost is worth
  double cap = 0;          // units of cost per frame
};

std::size_t cost_model_need(std::uint32_t row_count, std::uint32_t server_count);
// Nothing is known yet: the split is all on the device.
CostModel make_cost_model(std::uint32_t width, std::uint32_t row_count, std::uint32_t server_count, Arena* arena);

// The overture of a connection: means over a frame, before any of its rows has been measured. Bytes per pixel as they
// compress. Forgets what was known of this server.
void observe_overture(CostModel* model, std::uint32_t server, const PixelTimes& times, double bytes_per_pixel,
                      double start_ns);

// Wall time that a row took on the device: on one of k threads at work, a k-th of its time there.
void observe_device_row(CostModel* model, std::uint32_t row, double ns);
// Rows that came from a server: what it says it spent on rendering them, and their bytes on the wire.
void observe_server_rows(CostModel* model, std::uint32_t server, std::uint32_t row_begin, std::uint32_t row_end,
                         double render_ns, double bytes);
// Bytes that came from the server and the time from the first to the last of them, while it had them ready.
void observe_transfer(CostModel* model, std::uint32_t server, double bytes, double ns);
// The server as a ping or another client's load shows it, where it has no rows to show it by: what it would spend on a
// pixel, with the pixels it says so of (a mean over the frame).
void observe_server_price(CostModel* model, std::uint32_t server, double ns_per_pixel);
inline void observe_start(CostModel* model, std::uint32_t server, double ns) {
  smooth(&model->servers[server].start_ns, ns);
}
inline void observe_device_start(CostModel* model, double ns) { smooth(&model->device_start_ns, ns); }
// Device time that decoding these bytes took.
void observe_unpack(CostModel* model, double bytes, double ns);
// Bytes of all servers together and the time they took, while some server had more of them ready.
void observe_link(CostModel* model, double bytes, double ns);

// What a byte took from one server while it was alone on the link that all share: that is no slower.
void observe_own_link(CostModel* model, double ns_per_byte);

// Takes over what the frame's rows told. Where all rows of the device changed their price, the rows of the servers are
// taken to have done the same: a new scene and a throttled device look alike there. What a server's rows then differ by
// is its speed; what they differ by among each other is the rows' own.
void end_frame(CostModel* model);

// The problem for the next frame. Its tables lie in the model and hold until the next call. Whatever the numbers are,
// its splits lie in [0, row_count] and its times are finite; a server of which anything is unknown or no number gets no
// rows.
SplitProblem make_problem(CostModel* model, const SplitWish& wish);

}  // namespace pocketray
