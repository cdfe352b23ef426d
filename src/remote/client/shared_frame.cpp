#include "remote/client/shared_frame.h"

#include <algorithm>

#include "base/limit_list.h"
#include "engine/frame.h"
#include "engine/row_costs.h"
#include "present/pack.h"
#include "remote/client/parts.h"

namespace pocketray {
namespace {

constexpr std::uint64_t kWaitNs = 500'000;  // for rows, when there is nothing else to do, between two looks around
constexpr std::uint32_t kFirstPixels = 8;   // of a row, while nothing is known of what they cost

void pack_device_rows(const Renderer& r, Client* c, std::uint32_t row_begin, std::uint32_t row_end) {
  int width = static_cast<int>(r.settings.width), height = static_cast<int>(r.settings.height);
  bool small = c->options.format == WireFormat::rgb565;
  pack_rows(r.image.data, width, height, static_cast<int>(row_begin), static_cast<int>(row_end), r.exposure,
            small ? kRgb565 : kRgb888, Rotation::none, c->options.dither, c->pixels.data,
            width * static_cast<int>(pixel_bytes(c->options.format)));
}

// Takes the time that the emulated device takes for so many pixels; returns how long that was.
std::uint64_t take_time_at(Client* c, const Pace& pace, std::uint64_t pixel_count, std::uint64_t begin_ns) {
  std::uint64_t elapsed = client_now_ns(*c) - begin_ns;
  if (!is_paced(pace)) return elapsed;
  elapsed = paced_ns(pace, pixel_count, elapsed);
  work_until(c, begin_ns + elapsed);
  return elapsed;
}

// The same for pixels of these rows, which may cost more or less than others.
std::uint64_t take_row_time(Client* c, std::uint32_t row_begin, std::uint32_t row_end, std::uint64_t pixel_count,
                            std::uint64_t begin_ns) {
  return take_time_at(c, pace_of_rows(c->options.pace, c->options.row_costs, row_begin, row_end), pixel_count,
                      begin_ns);
}

// Pixels of a row, about as many for each thread.
void trace_part(Renderer* r, std::uint32_t row, std::uint32_t begin, std::uint32_t end) {
  std::uint32_t parts = std::min(r->settings.threads, end - begin), count = end - begin;
  Span spans[kThreadCountMax];
  for (std::uint32_t i = 0; i < parts; ++i)
    spans[i] = {static_cast<std::uint16_t>(row), static_cast<std::uint16_t>(begin + count * i / parts),
                static_cast<std::uint16_t>(begin + count * (i + 1) / parts)};
  trace_with(r->workers, {spans, parts, Aov::none, r->image.data, r->tracers.data, nullptr});
}

// A row that takes longer than the device may work at once, in parts, with looks at the servers in between: they are
// not to take the device for lost, nor it them. It is left when a server sends it meanwhile.
void render_long_row(Renderer* r, Client* c, std::uint32_t row) {
  const std::uint32_t width = r->settings.width;
  double pixel_ns = device_pixel_ns(*c);
  std::uint32_t begin = 0;
  std::uint64_t row_ns = 0;
  for (;;) {
    double pixels = pixel_ns > 0 ? work_ns_max(*c) / pixel_ns : kFirstPixels;
    std::uint32_t count = pixels < width ? std::max(1u, static_cast<std::uint32_t>(pixels)) : width;
    std::uint32_t end = begin + std::min(count, width - begin);
    std::uint64_t begin_ns = client_now_ns(*c);
    trace_part(r, row, begin, end);
    std::uint64_t part_ns = take_row_time(c, row, row + 1, end - begin, begin_ns);
    row_ns += part_ns;
    pixel_ns = static_cast<double>(part_ns + 1) / (end - begin);
    begin = end;
    if (begin == width) break;
    advance_client(c, 0);
    if (c->merge.rows[row].state != RowState::taken) return;
  }
  pack_device_rows(*r, c, row, row + 1);
  finish_device_rows(c, row, row + 1, row_ns);
}

bool render_rows(Renderer* r, Client* c) {
  std::uint32_t begin, end, row_count_max = kTileRows * r->settings.threads;
  double row_ns = device_pixel_ns(*c) * r->settings.width;
  bool is_long = row_ns == 0 || row_ns > work_ns_max(*c);
  if (!take_device_rows(c, is_long ? 1 : row_count_max, &begin, &end)) return false;
  if (is_long) {
    render_long_row(r, c, begin);
    return true;
  }
  std::uint64_t begin_ns = client_now_ns(*c);
  trace_with(r->workers, {r->spans.data + begin, end - begin, Aov::none, r->image.data, r->tracers.data, nullptr});
  pack_device_rows(*r, c, begin, end);
  std::uint64_t pixel_count = std::uint64_t(end - begin) * r->settings.width;
  finish_device_rows(c, begin, end, take_row_time(c, begin, end, pixel_count, begin_ns));
  return true;
}

}  // namespace

std::uint64_t take_time(Client* c, std::uint64_t pixel_count, std::uint64_t begin_ns) {
  return take_time_at(c, c->options.pace, pixel_count, begin_ns);
}

Status begin_shared_frame(Renderer* r, Client* c, double seconds) {
  RETURN_IF_ERROR(check_limit(Quantity::seconds, seconds));
  std::uint64_t begin_ns = client_now_ns(*c);
  if (c->options.has_scene) {
    RETURN_IF_ERROR(prepare_frame(r, seconds));
    for (Tracer& tracer : r->tracers) tracer = make_tracer(r->frame);
  }
  // What emulates a CPU has taken its time for that already.
  std::uint64_t prepare_ns = is_paced(r->pace) ? client_now_ns(*c) - begin_ns : take_time(c, 0, begin_ns);
  begin_client_frame(c, *r, seconds, prepare_ns);
  return success();
}

bool advance_shared_frame(Renderer* r, Client* c, std::uint64_t deadline_ns, const std::atomic<bool>* stop) {
  while (!c->complete) {
    if (stop && stop->load(std::memory_order_relaxed)) return false;
    bool busy = !has_all_rows(*c) && render_rows(r, c);
    if (has_all_rows(*c) && is_verified(r, c)) {
      end_client_frame(c);
      break;
    }
    advance_client(c, busy ? 0 : kWaitNs);
    if (client_now_ns(*c) >= deadline_ns) return false;
  }
  return true;
}

Status render_shared_frame(Renderer* r, Client* c, double seconds, const std::atomic<bool>* stop, bool* complete) {
  RETURN_IF_ERROR(begin_shared_frame(r, c, seconds));
  bool done = advance_shared_frame(r, c, ~std::uint64_t(0), stop);
  if (complete) *complete = done;
  return success();
}

}  // namespace pocketray
