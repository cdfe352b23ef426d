#include "app/render_summary.h"

#include <nlohmann/json.hpp>

#include "base/check.h"
#include "session/note.h"

namespace pocketray {

namespace {

constexpr float kEndedWeightTold = 0x1p-8f;  // less is below a display level, even if the light is as bright as white

void print_share(const Servers& servers, std::uint32_t width) {
  ServersTotals t = servers.backend->totals(servers);
  if (t.frames == 0) return;
  double rows = static_cast<double>(t.device_rows + t.server_rows), frames = static_cast<double>(t.frames);
  std::printf("  render servers: the device rendered %.0f %% of the rows, servers sent %.1f kB per frame",
              100 * static_cast<double>(t.device_rows) / rows, static_cast<double>(t.bytes_in) * 1e-3 / frames);
  if (t.effect_frames > 0)
    std::printf("; %.0f frames were shared by effect, %.0f of them with a server's light, of %.1f kB per frame",
                static_cast<double>(t.effect_frames), static_cast<double>(t.lit_frames),
                static_cast<double>(t.light_bytes) * 1e-3 / static_cast<double>(t.effect_frames));
  if (t.device_rows > 0)
    std::printf("; the device traced %.1f %% of its pixels",
                100 * static_cast<double>(t.device_pixels) / (static_cast<double>(t.device_rows) * width));
  if (t.unchanged_frames > 0) std::printf("; %.0f frames were unchanged", static_cast<double>(t.unchanged_frames));
  if (t.local_ns > 0) std::printf("; predicted %.2f times as fast as the device alone", t.local_ns / t.known_ns);
  if (t.checked > 0)
    std::printf(
        "; %.1f of their %s per frame checked, which catches one wrong row per frame with a probability of %.4g %%",
        static_cast<double>(t.checked) / frames, t.checks_rows ? "rows" : "pixels", 100 * t.caught_row);
  std::printf("; last frame:\n");
  HudText lines;
  servers.backend->write_lines(servers, false, &lines);
  for (int i = 0; i < lines.line_count; ++i) std::printf("    %s\n", lines.lines[i]);
}

// Reports rays ended by --depth. A bound beyond white means only that a pixel may be anything that the display shows.
void print_ended_rays(const Renderer& renderer, const Tracer& counts) {
  std::printf("  %s ended at depth %u; the surroundings stand in for what they would see: ",
              counted(counts.rays_ended, "ray").c_str(), renderer.settings.ray_depth);
  const double share = static_cast<double>(counts.ended_weight_max);
  if (share < 1)
    std::printf("up to %.2g %% of a sample, ", 100 * share);
  else
    std::printf("up to a whole sample, ");
  const double whites = static_cast<double>(counts.ended_bound_max * renderer.view.exposure);
  if (whites < 1)
    std::printf("an error of at most %.2g of white\n", whites);
  else
    std::printf("an error that may reach white; a greater --depth lowers it\n");
}

}  // namespace

void print_summary(const RenderSummary& s) {
  CHECK(s.frame_count > 0 && !s.files.empty());
  const Renderer& renderer = *s.renderer;
  double pixels = static_cast<double>(s.box.width) * s.box.height * s.frame_count;
  if (s.options->plan) {
    print_effects(renderer.effects);
    print_memory(renderer.memory.plan);
  }
  if (s.files.size() > 1) std::printf("%s … ", shown(s.files.front()).c_str());
  std::printf("%s: ", s.files.back() == "-" ? "standard output" : shown(s.files.back()).c_str());
  if (s.frame_count > s.files.size())
    std::printf("%s at %g per second, ", counted(s.frame_count, "frame").c_str(),
                frame_rate(*s.options, renderer.scene.info));
  std::printf("%d×%d, %s triangles, %.1f ms%s, %.0f ns per pixel, %u thread%s%s\n", s.box.width, s.box.height,
              grouped(triangle_count(s.servers, renderer)).c_str(), s.trace_ms / s.frame_count,
              s.frame_count > 1 ? " per frame" : "", s.trace_ms * 1e6 / pixels, renderer.settings.threads,
              renderer.settings.threads == 1 ? "" : "s", emulation_text(renderer.pace).c_str());
  if (!s.aov_line.empty()) std::printf("%s\n", s.aov_line.c_str());
  if (s.coherent) print_coherence(*s.coherent);
  Tracer counts = total_counts(renderer);
  if (counts.rays_left_out)
    std::printf("  %s rays skipped, which could change a sample by at most %.2g of a display level in total\n",
                grouped(counts.rays_left_out).c_str(),
                static_cast<double>(counts.left_out_share_max * renderer.settings.cut_off_levels));
  if (counts.ended_weight_max >= kEndedWeightTold) print_ended_rays(renderer, counts);
  if (s.servers) print_share(*s.servers, renderer.settings.width);
  if (s.budget) print_budget(*s.budget, s.frame_count == 1);
}

namespace {

Json share_json(const Servers& servers) {
  const ServersTotals t = servers.backend->totals(servers);
  const EffectTimes& e = t.effect_times;
  auto ms = [](double ns) { return ns > 0 ? Json(ns * 1e-6) : Json(); };
  return {{"frames", t.frames},
          {"device_rows", t.device_rows},
          {"server_rows", t.server_rows},
          {"bytes_in", t.bytes_in},
          {"bytes_out", t.bytes_out},
          {"split",
           {{"effect_frames", t.effect_frames},
            {"lit_frames", t.lit_frames},
            {"light_bytes", t.light_bytes},
            {"rows_ms", ms(t.rows_ns)},
            {"effect_ms", ms(t.effect_ns)},
            {"prepare_ms", ms(e.prepare_ns)},
            {"device_ms", ms(e.device_ns)},
            {"server_ms", ms(e.server_ns)},
            {"transfer_ms", ms(e.transfer_ns)},
            {"add_ms", ms(e.add_ns)}}}};
}

}  // namespace

Json to_json(const RenderSummary& s) {
  const Renderer& renderer = *s.renderer;
  Tracer counts = total_counts(renderer);
  Json rays = Json::object();
  for (int kind = 0; kind < kRayKindCount; ++kind) rays[kRayKindNames[kind]] = counts.rays[kind];
  double pixels = static_cast<double>(s.box.width) * s.box.height * (s.frame_count == 0 ? 1 : s.frame_count);
  return {{"scene", s.options->common.scene},
          {"files", s.files},
          {"frames", s.frame_count},
          {"triangles", triangle_count(s.servers, renderer)},
          {"width", s.box.width},
          {"height", s.box.height},
          {"ns_per_pixel", s.trace_ms * 1e6 / pixels},
          {"emulated", renderer.pace.device ? Json(renderer.pace.device) : Json()},
          {"rays", rays},
          {"rays_left_out", counts.rays_left_out},
          {"left_out_radiance_max", counts.left_out_max},
          {"rays_ended", counts.rays_ended},
          {"ended_weight_max", counts.ended_weight_max},
          {"ended_radiance_max", counts.ended_bound_max},
          {"left_out_levels_max", counts.left_out_share_max * renderer.settings.cut_off_levels},
          {"exposure", renderer.view.exposure},
          {"memory", memory_json(renderer.memory.plan)},
          {"effects", effects_json(renderer.effects)},
          {"servers", s.servers ? share_json(*s.servers) : Json()},
          {"coherence", s.coherent ? coherence_json(*s.coherent) : Json()},
          {"budget", s.budget ? budget_json(*s.budget) : Json()}};
}

}  // namespace pocketray
