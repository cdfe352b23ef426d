#include "budget/front_prices.h"

#include <algorithm>

#include "base/check.h"
#include "engine/frame.h"
#include "present/pack.h"
#include "session/interrupt.h"

namespace pocketray {
namespace {

// Chosen: a candidate that takes longer suits no budget.
constexpr double kFrameNsMax = 2e9;
// Samples several times of an animation. Chosen: a sixth of a second at 30 frames per second; adjacent frames would
// look alike.
constexpr std::uint32_t kFramesBetweenRounds = 5;

// Times a frame as render and view do.
Status time_frame(Renderer* renderer, double seconds, void* page, double* ns) {
  CHECK(page != nullptr && ns != nullptr);
  std::uint64_t start = clock_ns();
  RETURN_IF_ERROR(render_frame(renderer, seconds, Aov::none, &interrupted));
  int width = static_cast<int>(renderer->settings.width), height = static_cast<int>(renderer->settings.height);
  pack_rows(renderer->image.data, width, height, 0, height, display_of(*renderer), kRgb565, Rotation::none, false, page,
            2 * width);
  *ns = static_cast<double>(clock_ns() - start);
  return success();
}

Status measure_round(Renderer* renderer, const Front& front, std::uint32_t round, void* page, FrontPrices* p) {
  double seconds = round * kFramesBetweenRounds / static_cast<double>(renderer->scene.info.frames_per_second);
  double ns = 0, price = 0;  // of the previous candidate
  for (std::uint32_t i = 0; i < front.count; ++i) {
    const Candidate& c = front.candidates[i];
    bool known_long = round > 0 && p->ns_per_pixel[i].empty();
    if (known_long || (price > 0 && ns * static_cast<double>(c.ns_per_pixel) / price > kFrameNsMax)) break;
    RETURN_IF_ERROR(change_settings(renderer, with_candidate(renderer->settings, c)));
    RETURN_IF_ERROR(time_frame(renderer, seconds, page, &ns));
    if (interrupted) return success();
    price = static_cast<double>(c.ns_per_pixel);
    p->ns_per_pixel[i].push_back(ns / pixel_count(*renderer));
  }
  ++p->round_count;
  return success();
}

}  // namespace

FrontPrices make_front_prices(const Front& front, std::uint32_t round_count) {
  CHECK_LE(front.count, kFrontCandidateMax);
  FrontPrices p;
  for (std::uint32_t i = 0; i < front.count; ++i) p.ns_per_pixel[i].reserve(round_count);
  return p;
}

std::size_t front_prices_bytes(const Settings& settings) {
  return arena_need(std::size_t(settings.width) * settings.height * 2);
}

Status measure_front(Renderer* renderer, const Front& front, FrontPrices* p) {
  CHECK_GT(front.count, 0u);
  const Settings before = renderer->settings;
  const Pace pace = renderer->pace;
  renderer->pace = Pace();
  std::size_t mark = arena_mark(renderer->memory.frame);
  auto page = arena_array<std::uint8_t>(&renderer->memory.frame, std::size_t(before.width) * before.height * 2);
  double warm_up;
  Status status = change_settings(renderer, with_candidate(before, front.candidates[0]));
  if (status.ok) status = time_frame(renderer, 0, page.data, &warm_up);
  std::uint32_t rounds = static_cast<std::uint32_t>(p->ns_per_pixel[0].capacity());
  for (std::uint32_t round = 0; status.ok && round < rounds && !interrupted; ++round)
    status = measure_round(renderer, front, round, page.data, p);
  arena_release(&renderer->memory.frame, mark);
  renderer->pace = pace;
  if (!status.ok) return status;
  for (std::uint32_t i = 0; i < front.count; ++i)
    for (double& ns : p->ns_per_pixel[i])
      ns = static_cast<double>(
               paced_ns(pace, before.width * before.height, static_cast<std::uint64_t>(ns * pixel_count(*renderer)))) /
           pixel_count(*renderer);
  return change_settings(renderer, before);
}

Front measured_front(const Front& front, FrontPrices* p) {
  Front measured;
  for (std::uint32_t i = 0; i < front.count; ++i) {
    if (p->ns_per_pixel[i].empty()) continue;
    Candidate c = front.candidates[i];
    double median = range_of(p->ns_per_pixel[i].data(), static_cast<std::uint32_t>(p->ns_per_pixel[i].size())).median;
    c.ns_per_pixel = clamped_price(median);
    measured.candidates[measured.count++] = c;
  }
  CHECK_LE(measured.count, front.count);
  sort_by_price(&measured);  // keeps dominated candidates: their prices are known, too
  return measured;
}

}  // namespace pocketray
