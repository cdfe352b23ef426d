// Cost model: the measured cost of rows on the device and on each server in the last frames, and the resulting split
// problem ([Aranha07] sec. 3.3, per row instead of a mean, with extensions that the paper's sec. 5 leaves open: several
// servers, money, energy). Pure: the caller measures. Invalid numbers change nothing.
//
// Per frame: find_split() or next_split() of make_problem(); render; report with observe_*(); end_frame().
#pragma once
#include <cstdint>

#include "base/arena.h"
#include "split/closed_form.h"
#include "split/smooth.h"
#include "split/split.h"

namespace pocketray {

// Bytes and their transfer time during a frame.
struct ByteTimes {
  double bytes = 0, ns = 0;
};

struct ServerModel {
  bool connected = false;  // false: gets no rows
  Smoothed speed;          // server time per row over the device's
  float price = 1;         // slowdown by other clients that the split
                           // assumes; follows the stated price
  float price_stated = 1;
  Smoothed ns_per_byte;           // time to send from it
  Smoothed start_ns;              // from the request to the first chunk, excluding that chunk's rendering and sending
  double cost_per_megabyte = 0;   // price of 10⁶ bytes from it, in the caller's unit
  std::uint32_t chunk_rows = 16;  // rows sent at once; chosen: a fifteenth of 240
  ByteTimes transfer_seen;        // in the current frame
};

constexpr std::uint8_t kNoHolder = 0xFF;

// Cost model of frames whose indirect light a server maps (engine/light_map.h), for rows rendered without it.
struct LightModel {
  Smoothed own_part;    // device time per row with own light, including adding the map's, relative to a whole row
  Smoothed server_ns;   // time for a map, at the server's price
  Smoothed bytes;       // size of a map
  Smoothed arrival_ns;  // from the request to the map's arrival
};

struct RowModel {
  Smoothed device_ns;  // wall time of the device for the whole row, whether it rendered it or not
  Smoothed bytes;      // as sent
  // Part of a row's pixels to trace: on the device in the coming frame; and in the last frame on the server that then
  // rendered the row. Other servers trace the whole row.
  float device_part = 1, holder_part = 1;
  std::uint8_t holder = kNoHolder;
  bool guessed = false;  // device_ns is derived from other rows; the device has never rendered this one
  // In the current frame; 0: not observed.
  float device_ns_seen = 0, server_ns_seen = 0, part_seen = 1;
  std::uint8_t server_seen = kNoHolder;
};

struct CostModel {
  std::uint32_t width = 0;  // pixels per row
  Array<RowModel> rows;
  std::uint32_t server_count = 0;
  ServerModel servers[kServerCountMax];
  LightModel light;
  Smoothed device_start_ns;     // before the first row: pose, refit
  Smoothed unpack_ns_per_byte;  // device time to decode received bytes
  Smoothed link_ns_per_byte;    // for the link that all servers share; unknown: only each server's own bound applies
  ByteTimes unpack_seen, link_seen;  // in the current frame
  double cost_per_device_pixel = 0;  // energy, in the caller's unit
  double cost_per_byte = 0;          // energy of receiving
  Array<std::uint64_t> tables;       // memory for the problem's tables
};

enum class SplitGoal {
  time,            // shortest time; among equals the fewest bytes
  time_and_cost,   // smallest time + ns_per_cost × cost
  time_under_cap,  // shortest time whose cost is at most the cap
};
struct SplitWish {
  SplitGoal goal = SplitGoal::time;
  double ns_per_cost = 0;  // λ: the time worth one unit of cost
  double cap = 0;          // units of cost per frame
};

std::size_t cost_model_need(std::uint32_t row_count, std::uint32_t server_count);
// Makes a model without measurements: the split gives all rows to the device.
CostModel make_cost_model(std::uint32_t width, std::uint32_t row_count, std::uint32_t server_count, Arena* arena);

// Sets a connection's first estimate: means over a frame, before any of its rows is measured. Bytes per pixel are after
// compression. Discards what was known about this server except its price, which applies at once.
void observe_overture(CostModel* model, std::uint32_t server, const PixelTimes& times, double bytes_per_pixel,
                      double start_ns);

// Reports the wall time of a row on the device, which traced `part` of its pixels; with k threads at work, 1/k of the
// time of one. Small parts say nothing about the row's price.
void observe_device_row(CostModel* model, std::uint32_t row, double ns, double part = 1);
// Reports rows received from a server: its stated work on them, their bytes on the wire, and the part of their pixels
// that it traced.
void observe_server_rows(CostModel* model, std::uint32_t server, std::uint32_t row_begin, std::uint32_t row_end,
                         double work_ns, double bytes, double part = 1);
// Device time for the row in the coming frame.
inline double device_row_ns(const RowModel& row) {
  return static_cast<double>(row.device_ns.value) * static_cast<double>(row.device_part);
}
// Reports bytes received from the server and the time from the first to the last, while it had them ready.
void observe_transfer(CostModel* model, std::uint32_t server, double bytes, double ns);
// Reports the speed of a server without rows, known from a ping: work per pixel, as a mean over the frame.
void observe_server_speed(CostModel* model, std::uint32_t server, double ns_per_pixel);
// Reports a server's stated price: its slowdown by other clients. Anything
// below 1 or NaN counts as 1, more than kPriceMax as kPriceMax. The split's
// price moves by kPricePart of the way per frame.
void observe_price(CostModel* model, std::uint32_t server, double price);
// All clients of a server see one price. If each responded fully, a price too low would cause as much excess demand as
// there was too little before, and so on forever. With half of the response or less, the error shrinks each time; a
// quarter, chosen, leaves room for prices that are several frames old.
constexpr float kPricePart = 0.25f;
constexpr float kPriceMax = 256;
// Server time per row over the device's, at its price; 0: unknown.
inline double server_slowness(const ServerModel& server) {
  return static_cast<double>(server.speed.value) * static_cast<double>(server.price);
}
inline void observe_start(CostModel* model, std::uint32_t server, double ns) {
  smooth(&model->servers[server].start_ns, ns);
}
inline void observe_device_start(CostModel* model, double ns) { smooth(&model->device_start_ns, ns); }
// Reports the device time for decoding these bytes.
void observe_unpack(CostModel* model, double bytes, double ns);
// Reports bytes from all servers and the time they took, while some server had more ready.
void observe_link(CostModel* model, double bytes, double ns);

// Reports the time per byte from one server while it was alone on the shared link, which is at least that fast.
void observe_own_link(CostModel* model, double ns_per_byte);

// Reports a map of the frame's light: the server's work on it at its price, its bytes, and the time since the request.
void observe_map(CostModel* model, double work_ns, double bytes, double arrival_ns);

// Applies the frame's measurements. If all rows of the device changed their price, the servers' rows are assumed to
// have changed alike, since a new scene and a throttled device look the same. The remaining difference common to a
// server's rows is its speed; differences between them belong to the rows. Prices follow those stated.
// by_effect: the device's rows had its own light and the map's.
void end_frame(CostModel* model, bool by_effect = false);

// How the device renders its rows of a frame.
struct RowsOfDevice {
  double part = -1;            // fraction of each row's time; negative: its device_part
  std::uint32_t mapper = ~0u;  // index of the server that maps the frame's light for them; ~0: none
};

// Makes the problem for the next frame. Its tables lie in the model and are valid until the next call. For any numbers,
// its splits lie in [0, row_count] and its times are finite; servers with an unknown or invalid number get no rows.
SplitProblem make_problem(CostModel* model, const SplitWish& wish, const RowsOfDevice& rows = RowsOfDevice());

}  // namespace pocketray
