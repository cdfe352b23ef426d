#include "viewer/hud.h"

#include <cstdio>
#include <cstring>

#include "base/check.h"
#include "effect/effect_list.h"

namespace pocketray {
namespace {

// Names of the effects that are on, wrapped.
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

}  // namespace

void write_hud(const Renderer& renderer, const Progressive& progressive, CameraMode mode, HudText* text) {
  text->line_count = 0;
  CHECK_GE(renderer.settings.threads, 1u);
  Tracer counts = total_counts(renderer);
  std::uint64_t rays = 0;
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
  add_hud_line(text, "%.1f of %.0f MiB  %s camera%s", static_cast<double>(renderer.memory.total_bytes) / (1 << 20),
               static_cast<double>(renderer.memory.limit_bytes) / (1 << 20),
               mode == CameraMode::orbit ? "orbit" : "fly", progressive.step > 0 ? "  refining" : "");
  add_effects(renderer.effects, text);
}

void write_waiting(const char* what, double seconds, HudText* text) {
  CHECK(what != nullptr);
  text->line_count = 0;
  add_hud_line(text, "%s, %.1f s", what, seconds);
}

}  // namespace pocketray
