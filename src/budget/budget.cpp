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

// Factors by which prices may be wrong. Chosen: twice what builtin_front() claims for the ladder's guesses; for prices
// measured on another machine and on this one, so that a trial corrects them.
constexpr double kGuessDoubt = 4, kElsewhereDoubt = 1.5, kMeasuredDoubt = 1.25;
constexpr double kPriceTolerance = 1.2;  // of learnt prices not written back; chosen: within kMeasuredDoubt

// Drops candidates that exceed the allowed error and, if requested, all remaining ones except the fastest.
Status bound_error(const FrontSource& source, Front* front) {
  if (source.flip_max == 0) return success();
  if (!errors_known(*front))
    return failure(
        "--flip-max needs measured errors, which this front lacks: measure them with `pocketray accuracy`, or name a "
        "file "
        "that has them with --front");
  Front kept;
  double least = 1;
  for (std::uint32_t i = 0; i < front->count; ++i) {
    const Candidate& c = front->candidates[i];
    least = std::min(least, static_cast<double>(c.flip));
    if (static_cast<double>(c.flip) <= source.flip_max) kept.candidates[kept.count++] = c;
  }
  if (kept.count == 0)
    return failure("--flip-max is %.3g, but the most accurate settings of the front err by %.3g: allow that much",
                   source.flip_max, least);
  if (source.fastest) {
    sort_by_price(&kept);
    kept.count = 1;
  }
  *front = kept;
  return success();
}

// Loads the scene's front: from the named file, otherwise from the cache, otherwise the ladder.
Status load_front(const Renderer& renderer, const FrontSource& source, const ContentHash* identity, OpenFront* f) {
  bool there;
  if (!source.file.empty()) {
    f->path = source.file;
    f->is_whole = true;
    RETURN_IF_ERROR(read_front(f->path, &f->front, &there));
    if (!there && !source.may_be_new)
      return failure("--front is %.300s: no such file; create one with `pocketray bench SCENE --front FILE`",
                     f->path.c_str());
    std::string folder = f->path.substr(0, f->path.rfind('/') + 1);
    if (!there && !folder.empty() && platform::file_stamp(folder.c_str()) == 0)
      return failure("--front is %.300s: no such folder; create it, or name another", f->path.c_str());
    f->file = there ? f->front : builtin_front(renderer.effects.mask);
  } else if (identity) {
    const CachedFront cached =
        read_cached_front(f->scene, *identity, machine_name(renderer.pace.device, renderer.settings.threads));
    f->front = cached.front, f->measured = cached.prices, f->path = cached.prices_path;
    if (f->path.empty()) f->notes.push_back("prices are not saved: set XDG_CACHE_HOME or HOME to a folder");
    f->notes.insert(f->notes.end(), cached.notes.begin(), cached.notes.end());
  }
  f->is_guess = f->front.count == 0;
  if (f->is_guess) f->front = builtin_front(renderer.effects.mask);
  CHECK_GT(f->front.count, 0u);
  f->effects = renderer.effects.mask;
  if (source.shows_24_bits) show_24_bits(&f->front);
  sort_front(&f->front);
  drop_what_scene_ignores(&f->front, f->effects);
  f->is_priced = adopt_prices(&f->front, f->measured);
  sort_front(&f->front);
  f->best = f->front.candidates[f->front.count - 1];
  return bound_error(source, &f->front);
}

bool is_planned(const Renderer& renderer, const Candidate& candidate) {
  const Settings settings = with_candidate(renderer.settings, candidate);
  const EffectMask mask = plan_effects(renderer.scene, settings).mask;
  PlannedFor need;
  return check_planned(renderer.scene, renderer.memory.plan.planned_for, settings, mask, &need).ok;
}

// Plans for the most memory that a candidate needs for each setting; drops candidates that do not fit.
Status plan_front(Renderer* renderer, const SceneStorage& storage, const OutputNeed& output, const FrontSource& source,
                  const ContentHash* identity, OpenFront* f) {
  renderer->settings.points_per_area_light = 1;
  RETURN_IF_ERROR(plan_renderer(renderer, storage, output));
  RETURN_IF_ERROR(load_front(*renderer, source, identity, f));
  const Settings least = renderer->settings;
  const std::uint32_t all = f->front.count;
  CHECK_GT(all, 0u);
  for (bool fits = false; !fits;) {
    const Candidate* candidates = f->front.candidates;
    const std::vector<Quality> wanted(candidates, candidates + f->front.count);
    renderer->settings = widest_settings(renderer->scene, least, {wanted.data(), f->front.count});
    const Status status = plan_renderer(renderer, storage, output);
    const std::uint32_t most = renderer->settings.points_per_area_light;
    fits = status.ok;
    Front rest;
    for (std::uint32_t i = 0; i < f->front.count; ++i)
      if (fits ? is_planned(*renderer, candidates[i]) : candidates[i].points_per_area_light < most)
        rest.candidates[rest.count++] = candidates[i];
    if (rest.count == 0) return status;
    f->front = rest;
  }
  if (f->front.count < all)
    f->notes.push_back(std::to_string(all - f->front.count) + " of " + std::to_string(all) +
                       " candidates of the front do not fit in memory: raise --memory to use them");
  return success();
}

constexpr std::size_t kBoundsMax = 64;
// "40 ms, ꟻLIP ≤ 0.03"
void format_bounds(const Budget& budget, const char* error_name, char (&text)[kBoundsMax]) {
  int used = 0;
  if (budget.ms > 0) used = std::snprintf(text, sizeof text, "%.7g ms", budget.ms);
  if (budget.flip_max > 0)
    std::snprintf(text + used, sizeof text - static_cast<std::size_t>(used), "%s%s ≤ %.3g", used ? ", " : "",
                  error_name, budget.flip_max);
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
  hooks.loaded = [&](const SceneSource& source, Renderer* renderer) {
    if (!from.file.empty()) return success();
    identified = identify_scene(source, renderer, &identity).ok;
    if (!identified) f->notes.push_back("prices are not saved: too little memory to identify the scene by its content");
    return success();
  };
  hooks.plan = [&](Renderer* renderer, const SceneStorage& storage, const OutputNeed& output) {
    return plan_front(renderer, storage, output, from, identified ? &identity : nullptr, f);
  };
  RETURN_IF_ERROR(open_scene(common, hooks, opened));
  return start_scene(opened, common);
}

void print_notes(const OpenFront& front) {
  for (const std::string& note : front.notes) std::fprintf(stderr, "pocketray: %s\n", note.c_str());
}

Front with_prices(const OpenFront& f, const Front& priced) {
  CHECK_LE(f.file.count, kFrontCandidateMax);
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

void start_budget(const BudgetOptions& options, const OpenFront& front, const Renderer& renderer,
                  std::size_t frame_count, Budget* budget) {
  CHECK(chooses_settings(options));
  CHECK(budget != nullptr);
  *budget = Budget();
  budget->front = front;
  budget->ms = options.ms, budget->flip_max = options.flip_max;
  budget->frame_ms.reserve(frame_count);
  start_governor(front.front, (options.ms > 0 ? options.ms : kBudgetMsMax) * 1e6, pixel_count(renderer),
                 front.is_guess ? kGuessDoubt : kElsewhereDoubt, front.is_priced, &budget->governor);
  budget->previous = budget->governor.current;
  for (std::uint32_t i = 0; i < front.front.count; ++i)
    if (find_candidate(front.measured, front.front.candidates[i])) set_doubt(&budget->governor, i, kMeasuredDoubt);
}

Status begin_budget_frame(Budget* budget, Renderer* renderer) {
  std::uint32_t before = budget->governor.current;
  std::uint32_t chosen = budget->pinned ? before : next_candidate(&budget->governor);
  CHECK_LT(chosen, budget->governor.front.count);
  if (chosen != before) budget->previous = before;
  return change_settings(renderer, with_candidate(renderer->settings, budget->governor.front.candidates[chosen]));
}

void move_along_front(Budget* budget, int steps) {
  Governor* g = &budget->governor;
  budget->pinned = steps != 0;
  int last = static_cast<int>(g->front.count) - 1;
  int to = std::min(std::max(static_cast<int>(g->current) + steps, 0), last);
  if (steps == 0 || to == static_cast<int>(g->current)) return;
  budget->previous = g->current;
  force_candidate(g, static_cast<std::uint32_t>(to));
}

void end_budget_frame(Budget* budget, std::uint64_t ns) {
  double ms = static_cast<double>(ns) * 1e-6;
  observe_frame(&budget->governor, static_cast<double>(ns));
  ++budget->frames;
  budget->last = budget->governor.current;
  CHECK_LT(budget->last, budget->governor.front.count);
  ++budget->uses[budget->last];
  budget->late += budget->ms > 0 && ms > 1.1 * budget->ms;  // kLate of governor.cpp
  if (budget->frame_ms.size() < budget->frame_ms.capacity()) budget->frame_ms.push_back(ms);
}

void finish_budget(const Budget& budget) {
  const Governor& g = budget.governor;
  Front learnt;
  bool wrong = false;
  for (std::uint32_t i = 0; i < g.front.count; ++i) {
    if (budget.uses[i] == 0 && !budget.front.is_whole) continue;
    Candidate c = g.front.candidates[i];
    double price = learnt_price(g, i), stated = static_cast<double>(c.ns_per_pixel);
    bool is_new = !budget.front.is_whole && !find_candidate(budget.front.measured, c);
    wrong = wrong || is_new || price > kPriceTolerance * stated || stated > kPriceTolerance * price;
    c.ns_per_pixel = clamped_price(price);
    learnt.candidates[learnt.count++] = c;
  }
  CHECK_LE(learnt.count, g.front.count);
  if (!wrong || budget.frames == 0 || budget.front.path.empty()) return;
  if (!budget.front.is_whole) {
    for (std::uint32_t i = 0; i < budget.front.measured.count && learnt.count < kFrontCandidateMax; ++i) {
      const Candidate& old = budget.front.measured.candidates[i];
      if (!find_candidate(learnt, old)) learnt.candidates[learnt.count++] = old;
    }
    sort_by_price(&learnt);
  }
  Status status = keep_measured(budget.front, learnt);
  if (!status.ok) std::fprintf(stderr, "pocketray: %s; prices are not saved\n", status.message);
}

std::string error_text(const Candidate& c) {
  if (std::isnan(c.flip)) return "unknown";
  char text[32];
  std::snprintf(text, sizeof text, "%.4f", static_cast<double>(c.flip));
  return text;
}

void write_budget_lines(const Budget& budget, HudText* text) {
  const Governor& g = budget.governor;
  CHECK(g.current < g.front.count && budget.previous < g.front.count);
  const Candidate &now = g.front.candidates[g.current], &before = g.front.candidates[budget.previous];
  char bounds[kBoundsMax];
  format_bounds(budget, "FLIP", bounds);
  add_hud_line(text, "%s %s: %" PRIu32 " of %" PRIu32 "%s", budget.pinned ? "by hand, not" : "budget", bounds,
               g.current + 1, g.front.count, budget_too_small(g) ? ", too small" : "");
  char shown[kFrontLineMax];
  format_hud_quality(now, shown, sizeof shown);
  add_hud_line(text, "%s", shown);
  if (g.current == budget.previous) return;
  char change[kFrontLineMax], gain[64];
  describe_change(before, now, change, sizeof change);
  add_hud_line(text, "%s", change);
  double ms = (expected_ns(g, g.current) - expected_ns(g, budget.previous)) * 1e-6;
  float flip = now.flip - before.flip;
  if (std::isnan(flip))
    std::snprintf(gain, sizeof gain, "%+.1f ms", ms);
  else
    std::snprintf(gain, sizeof gain, "FLIP %+.4f, %+.1f ms", static_cast<double>(flip), ms);
  add_hud_line(text, "  %s", gain);
}

Json budget_json(const Budget& budget) {
  Json candidates = Json::array();
  for (std::uint32_t i = 0; i < budget.governor.front.count; ++i) {
    const Candidate& c = budget.governor.front.candidates[i];
    char quality[kFrontLineMax];
    format_quality(c, quality, sizeof quality);
    candidates.push_back({{"settings", quality},
                          {"flip", c.flip},  // null if not measured
                          {"ns_per_pixel", learnt_price(budget.governor, i)},
                          {"frames", budget.uses[i]}});
  }
  return {{"ms", budget.ms > 0 ? Json(budget.ms) : Json()},
          {"flip_max", budget.flip_max > 0 ? Json(budget.flip_max) : Json()},
          {"frames", budget.frames},
          {"frames_within_110_percent", budget.frames - budget.late},
          {"too_small", budget_too_small(budget.governor)},
          {"switches", budget.governor.switch_count},
          {"front", budget.front.path},
          {"candidates", candidates},
          {"frame_ms", budget.frame_ms}};
}

void print_budget(const Budget& budget, bool last_alone) {
  if (budget.frames == 0) return;
  const Governor& g = budget.governor;
  CHECK_LT(budget.last, g.front.count);
  CHECK_LE(budget.late, budget.frames);
  std::uint32_t most = budget.last;
  for (std::uint32_t i = 0; i < g.front.count && !last_alone; ++i)
    if (budget.uses[i] > budget.uses[most]) most = i;
  const Candidate &chosen = g.front.candidates[most], &best = budget.front.best;
  char quality[kFrontLineMax], change[kFrontLineMax];
  format_quality(chosen, quality, sizeof quality);
  describe_change(best, chosen, change, sizeof change);
  char bounds[kBoundsMax];
  format_bounds(budget, "ꟻLIP", bounds);
  std::printf("  %s: %s: expected ꟻLIP %s; traded away: %s\n", bounds, quality, error_text(chosen).c_str(), change);
  MeasuredRange range;
  if (!budget.frame_ms.empty()) {
    std::vector<double> sorted = budget.frame_ms;
    range = range_of(sorted.data(), static_cast<std::uint32_t>(sorted.size()));
  }
  if (budget.ms == 0) return;
  std::printf("  %.1f %% of %u frame%s within 110 %%, median %.1f ms, longest %.1f ms; %u change%s of settings\n",
              100.0 * (budget.frames - budget.late) / budget.frames, budget.frames, budget.frames == 1 ? "" : "s",
              range.median, range.max, g.switch_count, g.switch_count == 1 ? "" : "s");
  if (budget_too_small(g)) std::printf("  even the front's fastest settings exceed the budget\n");
}

}  // namespace pocketray
