#include "app/shared_frame.h"

#include "app/client_parts.h"
#include "app/frame.h"
#include "present/pack.h"

namespace pocketray {
namespace {

constexpr std::uint64_t kWaitNs = 500'000;  // for rows, when there is nothing else to do, between two looks around

void pack_device_rows(const Renderer& r, Client* c, std::uint32_t row_begin, std::uint32_t row_end) {
  int width = static_cast<int>(r.settings.width), height = static_cast<int>(r.settings.height);
  bool small = c->options.format == WireFormat::rgb565;
  pack_rows(r.image.data, width, height, static_cast<int>(row_begin), static_cast<int>(row_end), r.exposure,
            small ? kRgb565 : kRgb888, Rotation::none, c->options.dither, c->pixels.data,
            width * static_cast<int>(pixel_bytes(c->options.format)));
}

// Takes the time that the emulated device takes for it; returns how long that was.
std::uint64_t take_time(Client* c, std::uint64_t pixel_count, std::uint64_t begin_ns) {
  std::uint64_t elapsed = client_now_ns(*c) - begin_ns;
  if (!is_paced(c->options.pace)) return elapsed;
  elapsed = paced_ns(c->options.pace, pixel_count, elapsed);
  work_until(c, begin_ns + elapsed);
  return elapsed;
}

bool render_rows(Renderer* r, Client* c) {
  std::uint32_t begin, end;
  if (!take_device_rows(c, kTileRows * r->settings.threads, &begin, &end)) return false;
  std::uint64_t begin_ns = client_now_ns(*c);
  trace_with(r->workers, {r->spans.data + begin, end - begin, Aov::none, r->image.data, r->tracers.data, nullptr});
  pack_device_rows(*r, c, begin, end);
  std::uint64_t pixel_count = std::uint64_t(end - begin) * r->settings.width;
  finish_device_rows(c, begin, end, take_time(c, pixel_count, begin_ns));
  return true;
}

}  // namespace

Status begin_shared_frame(Renderer* r, Client* c, double seconds) {
  std::uint64_t begin_ns = client_now_ns(*c);
  if (c->options.has_scene) {
    RETURN_IF_ERROR(prepare_frame(r, seconds));
    for (Tracer& tracer : r->tracers) tracer = make_tracer(r->frame);
  }
  begin_client_frame(c, *r, seconds, take_time(c, 0, begin_ns));
  return success();
}

bool advance_shared_frame(Renderer* r, Client* c, std::uint64_t deadline_ns, const std::atomic<bool>* stop) {
  while (!has_all_rows(*c)) {
    if (stop && stop->load(std::memory_order_relaxed)) return false;
    bool rendered = render_rows(r, c);
    if (has_all_rows(*c)) break;
    advance_client(c, rendered ? 0 : kWaitNs);
    if (client_now_ns(*c) >= deadline_ns) return false;
  }
  if (!c->complete) end_client_frame(c);
  return true;
}

Status render_shared_frame(Renderer* r, Client* c, double seconds, const std::atomic<bool>* stop, bool* complete) {
  RETURN_IF_ERROR(begin_shared_frame(r, c, seconds));
  bool done = advance_shared_frame(r, c, ~std::uint64_t(0), stop);
  if (complete) *complete = done;
  return success();
}

}  // namespace pocketray
