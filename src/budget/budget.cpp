#include "budget/budget.h"

#include <algorithm>
#include <cinttypes>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "base/check.h"
#include "plan/plan_effects.h"
#include "platform/file.h"
#include "session/measure.h"
#include "session/scene_identity.h"

namespace pocketray {
namespace {

constexpr double kGuessDoubt = 4, kElsewhereDoubt = 1.5, kMeasuredDoubt = 1.25;
constexpr double kPriceTolerance = 1.2;

// What is known of the scene: the file named, else what the cache has of it, else the ladder.
Status load_front(const Renderer& r, const FrontSource& source, const ContentHash* identity, OpenFront* f) {
  bool there;
  if (!source.file.empty()) {
    f->path = source.file;
    f->is_whole = true;
    RETURN_IF_ERROR(read_front(f->path, &f->front, &there));
    if (!there && !source.may_be_new)
      return failure("--front is %.300s: there is no such file; `pocketray bench SCENE --front FILE` makes one",
                     f->path.c_str());
    std::string folder = f->path.substr(0, f->path.rfind('/') + 1);
    if (!there && !folder.empty() && platform::file_stamp(folder.c_str()) == 0)
      return failure("--front is %.300s: there is no such folder; make it, or name another", f->path.c_str());
    f->file = there ? f->front : builtin_front();
  } else if (identity) {
    f->path = front_path(f->scene, *identity, machine_name(r.pace.device, r.settings.threads));
    if (f->path.empty()) f->notes.push_back("neither XDG_CACHE_HOME nor HOME names a folder: prices are not kept");
    Status status = read_front(front_path(f->scene, *identity), &f->front, &there);
    if (!status.ok) f->notes.push_back(std::string(status.message) + "; it is not used");
    status = read_front(f->path, &f->measured, &there);
    if (!status.ok) f->notes.push_back(std::string(status.message) + "; prices are measured anew");
  }
  f->is_guess = f->front.count == 0;
  if (f->is_guess) f->front = builtin_front();
  f->effects = r.effects.mask;
  sort_front(&f->front);
  drop_what_scene_ignores(&f->front, f->effects);
  f->is_priced = adopt_prices(&f->front, f->measured);
  sort_front(&f->front);
  return success();
}

// Plans with the most points per area light that fit; what asks for more is left out.
Status plan_front(Renderer* r, const SceneStorage& storage, std::size_t output_bytes, const FrontSource& source,
                  const ContentHash* identity, OpenFront* f) {
  r->settings.points_per_area_light = 1;
  RETURN_IF_ERROR(plan_renderer(r, storage, output_bytes));
  RETURN_IF_ERROR(load_front(*r, source, identity, f));
  const Front all = f->front;
  std::uint32_t left_out = 0;
  while (true) {
    std::uint32_t most = 0;
    for (std::uint32_t i = 0; i < f->front.count; ++i)
      most = std::max(most, f->front.candidates[i].points_per_area_light);
    r->settings.points_per_area_light = most;
    Status status = plan_renderer(r, storage, output_bytes);
    Front rest;
    for (std::uint32_t i = 0; i < f->front.count && !status.ok; ++i)
      if (f->front.candidates[i].points_per_area_light < most) rest.candidates[rest.count++] = f->front.candidates[i];
    if (status.ok || rest.count == 0) {
      RETURN_IF_ERROR(status);
      break;
    }
    left_out = all.count - rest.count;
    f->front = rest;
  }
  if (left_out > 0)
    f->notes.push_back(std::to_string(left_out) + " of " + std::to_string(all.count) +
                       " candidates of the front do not fit the memory: a larger --memory holds them");
  return success();
}

// Without errors, which the scene's front has: no price is left out for another's sake.
Front prices_alone(Front front) {
  for (std::uint32_t i = 0; i < front.count; ++i) front.candidates[i].flip = kErrorUnknown;
  return front;
}

}  // namespace

Status open_scene_with_front(const CommonOptions& common, const FrontSource& from,
                             const std::function<std::size_t(const Settings&)>& output_bytes, OpenScene* opened,
                             OpenFront* f) {
  *f = OpenFront();
  f->scene = common.scene;
  ContentHash identity;
  bool identified = false;
  OpenHooks hooks;
  hooks.output_bytes = output_bytes;
  hooks.loaded = [&](const SceneSource& source, Renderer* r) {
    if (!from.file.empty()) return success();
    identified = identify_scene(source, r, &identity).ok;
    if (!identified) f->notes.push_back("there is no room to name the scene by its content: its prices are not kept");
    return success();
  };
  hooks.plan = [&](Renderer* r, const SceneStorage& storage, std::size_t bytes) {
    return plan_front(r, storage, bytes, from, identified ? &identity : nullptr, f);
  };
  RETURN_IF_ERROR(open_scene(common, hooks, opened));
  return start_scene(opened, common);
}

void print_notes(const OpenFront& front) {
  for (const std::string& note : front.notes) std::fprintf(stderr, "pocketray: %s\n", note.c_str());
}

Front with_prices(const OpenFront& f, const Front& priced) {
  Front known, kept = f.file;
  for (std::uint32_t i = 0; i < kept.count; ++i) {
    Front alone;
    alone.candidates[alone.count++] = kept.candidates[i];
    drop_what_scene_ignores(&alone, f.effects);
    const Candidate* same = find_candidate(priced, alone.candidates[0]);
    if (!same) continue;
    Candidate& c = known.candidates[known.count++] = kept.candidates[i];
    c.ns_per_pixel = same->ns_per_pixel;
  }
  adopt_prices(&kept, known);
  return kept;
}

Status keep_measured(const OpenFront& f, const Front& measured) {
  if (f.path.empty() || measured.count == 0) return success();
  return f.is_whole ? write_front(f.path, with_prices(f, measured)) : cache_front(f.path, prices_alone(measured));
}

void start_budget(const BudgetOptions& options, const OpenFront& front, const Renderer& r, std::size_t frame_count,
                  Budget* b) {
  *b = Budget();
  b->front = front;
  b->ms = options.ms;
  b->frame_ms.reserve(frame_count);
  start_governor(front.front, options.ms * 1e6, pixel_count(r), front.is_guess ? kGuessDoubt : kElsewhereDoubt,
                 front.is_priced, &b->governor);
  b->previous = b->governor.current;
  for (std::uint32_t i = 0; i < front.front.count; ++i)
    if (find_candidate(front.measured, front.front.candidates[i])) set_doubt(&b->governor, i, kMeasuredDoubt);
}

Status begin_budget_frame(Budget* b, Renderer* r) {
  std::uint32_t before = b->governor.current;
  std::uint32_t chosen = b->pinned ? before : next_candidate(&b->governor);
  if (chosen != before) b->previous = before;
  return change_settings(r, with_candidate(r->settings, b->governor.front.candidates[chosen]));
}

void move_along_front(Budget* b, int steps) {
  Governor* g = &b->governor;
  b->pinned = steps != 0;
  int last = static_cast<int>(g->front.count) - 1;
  int to = std::min(std::max(static_cast<int>(g->current) + steps, 0), last);
  if (steps == 0 || to == static_cast<int>(g->current)) return;
  b->previous = g->current;
  force_candidate(g, static_cast<std::uint32_t>(to));
}

void end_budget_frame(Budget* b, std::uint64_t ns) {
  double ms = static_cast<double>(ns) * 1e-6;
  observe_frame(&b->governor, static_cast<double>(ns));
  ++b->frames;
  b->last = b->governor.current;
  ++b->uses[b->last];
  b->late += ms > 1.1 * b->ms;
  if (b->frame_ms.size() < b->frame_ms.capacity()) b->frame_ms.push_back(ms);
}

Status finish_budget(const Budget& b) {
  const Governor& g = b.governor;
  Front learnt;
  bool wrong = false;
  for (std::uint32_t i = 0; i < g.front.count; ++i) {
    if (b.uses[i] == 0 && !b.front.is_whole) continue;
    Candidate c = g.front.candidates[i];
    double price = learnt_price(g, i), stated = static_cast<double>(c.ns_per_pixel);
    bool is_new = !b.front.is_whole && !find_candidate(b.front.measured, c);
    wrong = wrong || is_new || price > kPriceTolerance * stated || stated > kPriceTolerance * price;
    c.ns_per_pixel = clamped_price(price);
    learnt.candidates[learnt.count++] = c;
  }
  if (!wrong || b.frames == 0 || b.front.path.empty()) return success();
  if (b.front.is_whole) return write_front(b.front.path, with_prices(b.front, learnt));
  for (std::uint32_t i = 0; i < b.front.measured.count && learnt.count < kFrontCandidateMax; ++i) {
    const Candidate& old = b.front.measured.candidates[i];
    if (!find_candidate(learnt, old)) learnt.candidates[learnt.count++] = old;
  }
  sort_by_price(&learnt);
  Status status = cache_front(b.front.path, prices_alone(learnt));
  if (!status.ok) std::fprintf(stderr, "pocketray: %s; prices are not kept\n", status.message);
  return success();
}

std::string error_text(const Candidate& c) {
  if (std::isnan(c.flip)) return "unknown";
  char text[32];
  std::snprintf(text, sizeof text, "%.4f", static_cast<double>(c.flip));
  return text;
}

void write_budget_lines(const Budget& b, HudText* text) {
  const Governor& g = b.governor;
  const Candidate &now = g.front.candidates[g.current], &before = g.front.candidates[b.previous];
  add_hud_line(text, "%s %.7g ms: %" PRIu32 " of %" PRIu32 "%s", b.pinned ? "by hand, not" : "budget", b.ms,
               g.current + 1, g.front.count, budget_too_small(g) ? ", too small" : "");
  char shown[kFrontLineMax];
  format_hud_quality(now, shown, sizeof shown);
  add_hud_line(text, "%s", shown);
  if (g.current == b.previous) return;
  char change[kFrontLineMax], gain[64];
  describe_change(before, now, change, sizeof change);
  add_hud_line(text, "%s", change);
  double ms = (expected_ns(g, g.current) - expected_ns(g, b.previous)) * 1e-6;
  float flip = now.flip - before.flip;
  if (std::isnan(flip))
    std::snprintf(gain, sizeof gain, "%+.1f ms", ms);
  else
    std::snprintf(gain, sizeof gain, "FLIP %+.4f, %+.1f ms", static_cast<double>(flip), ms);
  add_hud_line(text, "  %s", gain);
}

Json budget_json(const Budget& b) {
  Json candidates = Json::array();
  for (std::uint32_t i = 0; i < b.governor.front.count; ++i) {
    const Candidate& c = b.governor.front.candidates[i];
    char quality[kFrontLineMax];
    format_quality(c, quality, sizeof quality);
    candidates.push_back({{"settings", quality},
                          {"flip", c.flip},  // null where it was not measured
                          {"ns_per_pixel", learnt_price(b.governor, i)},
                          {"frames", b.uses[i]}});
  }
  return {{"ms", b.ms},
          {"frames", b.frames},
          {"frames_within_110_percent", b.frames - b.late},
          {"too_small", budget_too_small(b.governor)},
          {"switches", b.governor.switch_count},
          {"front", b.front.path},
          {"candidates", candidates},
          {"frame_ms", b.frame_ms}};
}

void print_budget(const Budget& b, bool last_alone) {
  if (b.frames == 0) return;
  const Governor& g = b.governor;
  std::uint32_t most = b.last;
  for (std::uint32_t i = 0; i < g.front.count && !last_alone; ++i)
    if (b.uses[i] > b.uses[most]) most = i;
  const Candidate &chosen = g.front.candidates[most], &best = g.front.candidates[g.front.count - 1];
  char quality[kFrontLineMax], change[kFrontLineMax];
  format_quality(chosen, quality, sizeof quality);
  describe_change(best, chosen, change, sizeof change);
  std::printf("  %.7g ms: %s: expected ꟻLIP %s; gave up: %s\n", b.ms, quality, error_text(chosen).c_str(), change);
  Range range;
  if (!b.frame_ms.empty()) {
    std::vector<double> sorted = b.frame_ms;
    range = range_of(sorted.data(), static_cast<std::uint32_t>(sorted.size()));
  }
  std::printf("  %.1f %% of %u frame%s within 110 %%, median %.1f ms, longest %.1f ms; %u change%s of settings\n",
              100.0 * (b.frames - b.late) / b.frames, b.frames, b.frames == 1 ? "" : "s", range.median, range.max,
              g.switch_count, g.switch_count == 1 ? "" : "s");
  if (budget_too_small(g)) std::printf("  even the fastest settings of the front take longer than the budget\n");
}

}  // namespace pocketray
