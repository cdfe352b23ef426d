#include "viewer/hud.h"

#include <cstdio>
#include <cstring>

#include "base/check.h"
#include "effect/effect_list.h"

namespace pocketray {
namespace {

// Adds the names of the effects that are on, wrapped.
void add_effects(const EffectPlan& plan, HudText* text) {
  char line[kHudColumnMax + 1] = "";
  for (const EffectRow& row : kEffectList) {
    if (!plan.decisions[static_cast<int>(row.effect)].on) continue;
    if (std::strlen(line) + std::strlen(row.name) + 1 > static_cast<std::size_t>(kHudColumnMax)) {
      add_hud_line(text, "%s", line);
      line[0] = 0;
    }
    if (line[0]) std::strcat(line, " ");
    std::strcat(line, row.name);
  }
  if (line[0]) add_hud_line(text, "%s", line);
}

// Adds how much of the last frame was traced.
void add_coherence(const Renderer& renderer, HudText* text) {
  const CoherenceState& state = renderer.history.state;
  if (!state.planned) return;
  if (state.whole_because) {
    char line[200];
    std::snprintf(line, sizeof line, "coherence: whole frame: %s", state.whole_because);
    add_hud_text(text, line);
    return;
  }
  CHECK_GE(renderer.image.count, 1u);
  add_hud_line(text, "coherence: %.1f %% traced, %.0fk search rays",
               100 * static_cast<double>(state.pixels_traced) / static_cast<double>(renderer.image.count),
               static_cast<double>(state.search.moving_rays + state.search.static_rays) * 1e-3);
}

}  // namespace

void write_hud(const Renderer& renderer, const Progressive& progressive, CameraMode mode, HudText* text) {
  text->line_count = 0;
  CHECK_GE(renderer.settings.threads, 1u);
  Tracer counts = total_counts(renderer);
  const ChangeCounts& search = renderer.history.state.search;
  std::uint64_t rays = search.moving_rays + search.static_rays;
  for (std::uint64_t n : counts.rays) rays += n;
  double ns_per_pixel = progressive.pixels_traced
                            ? static_cast<double>(progressive.trace_ns) / static_cast<double>(progressive.pixels_traced)
                            : 0;
  double frame_ms = ns_per_pixel * static_cast<double>(renderer.settings.width) * renderer.settings.height * 1e-6;
  const char* plural = renderer.settings.threads == 1 ? "" : "s";
  if (renderer.pace.device)
    add_hud_line(text, "%s  %.0f ms/frame  %.0f ns/pixel  %u thread%s", renderer.pace.device, frame_ms, ns_per_pixel,
                 renderer.settings.threads, plural);
  else
    add_hud_line(text, "%.1f ms/frame  %.0f ns/pixel  %u thread%s", frame_ms, ns_per_pixel, renderer.settings.threads,
                 plural);
  add_hud_line(text, "%.0fk rays  %.2f M/s  %.0fk skipped", static_cast<double>(rays) * 1e-3,
               progressive.trace_ns ? static_cast<double>(rays) * 1e3 / static_cast<double>(progressive.trace_ns) : 0.0,
               static_cast<double>(counts.rays_left_out) * 1e-3);
  add_hud_line(text, "%.1f of %.0f MiB  %s camera%s", static_cast<double>(renderer.memory.plan.total_bytes) / (1 << 20),
               static_cast<double>(renderer.memory.plan.limit_bytes) / (1 << 20),
               mode == CameraMode::orbit ? "orbit" : "fly", progressive.step > 0 ? "  refining" : "");
  add_coherence(renderer, text);
  add_effects(renderer.effects, text);
}

void write_latency(const Motion& motion, HudText* text) {
  if (motion.total_ns == 0) return;
  add_hud_line(text, "motion to photon %.0f ms, 99 %% within %.0f", latency_ns(motion, 0.5) * 1e-6,
               latency_ns(motion, 0.99) * 1e-6);
}

void write_waiting(const char* what, double seconds, HudText* text) {
  CHECK(what != nullptr);
  text->line_count = 0;
  add_hud_line(text, "%s, %.1f s", what, seconds);
}

}  // namespace pocketray
