// pocketray bench: measures the cost per pixel, scanline, ray and effect.
#include <cmath>
#include <nlohmann/json.hpp>

#include "app/commands.h"
#include "app/options.h"
#include "base/seal.h"
#include "budget/front_prices.h"
#include "effect/effect_list.h"
#include "session/cache.h"
#include "session/front_file.h"
#include "session/interrupt.h"
#include "session/measure.h"
#include "session/note.h"
#include "session/output.h"
#include "session/report.h"

namespace pocketray {
namespace {

// Null: coherence is off.
Json coherence_json(const CommonOptions& options, const Renderer& renderer, const Measurement& m) {
  if (renderer.settings.coherence == CoherenceMode::off) return Json();
  const char* because = m.coherent ? m.whole_because : renderer.history.state.unplanned_because;
  return {{"asked", options.coherence},
          {"whole_frames", m.coherent ? m.whole_frames : m.frame_count},
          {"whole_because", because ? Json(because) : Json()}};
}

// Prints how many frames were traced whole although coherence was requested.
void print_whole_frames(const Renderer& renderer, const Measurement& m) {
  if (renderer.settings.coherence == CoherenceMode::off) return;
  if (!m.coherent)
    std::printf("  %-22s %10s     (%s)\n", "traced whole", "all", renderer.history.state.unplanned_because);
  else if (m.whole_frames > 0)
    std::printf("  %-22s %10u     (the last: %s)\n", "traced whole", m.whole_frames, m.whole_because);
}

Json to_json(const CommonOptions& options, const Renderer& renderer, Measurement* m) {
  MeasuredRange pixel = range_of(m->ns_per_pixel.data(), m->frame_count);
  Json rows = Json::array();
  for (std::uint32_t row = 0; row < renderer.settings.height; ++row)
    rows.push_back(range_of(&m->row_ns[static_cast<std::size_t>(row) * m->frame_count_max], m->frame_count).median /
                   renderer.settings.width);
  Json rays = Json::object();
  for (int kind = 0; kind < kRayKindCount; ++kind) rays[kRayKindNames[kind]] = m->counts.rays[kind];
  Json effects = effects_json(renderer.effects);
  for (int i = 0; i < kEffectCount; ++i)
    if (std::isfinite(m->effect_price[i]))
      effects[static_cast<std::size_t>(i)]["price_ns_per_pixel"] = m->effect_price[i];
  return {{"scene", options.scene},
          {"triangles", renderer.scene.triangles.count},
          {"width", renderer.settings.width},
          {"height", renderer.settings.height},
          {"threads", renderer.settings.threads},
          {"isa", isa_name(active_isa())},
          {"emulated", renderer.pace.device ? Json(renderer.pace.device) : Json()},
          {"frames", m->frame_count},
          {"ns_per_pixel", {{"min", pixel.min}, {"median", pixel.median}, {"max", pixel.max}}},
          {"scanline_ns_per_pixel", m->coherent ? Json() : rows},
          {"pixels_traced", static_cast<double>(m->pixels_traced) / m->frame_count},
          {"coherence", coherence_json(options, renderer, *m)},
          {"rays", rays},
          {"rays_left_out", m->counts.rays_left_out},
          {"left_out_radiance_max", m->counts.left_out_max},
          {"rays_per_second", rays_per_second(*m)},
          {"nodes_visited", m->counts.stats.nodes},
          {"triangles_tested", m->counts.stats.triangles},
          {"memory", memory_json(renderer.memory.plan)},
          {"effects", effects},
          {"build_ms", renderer.timings.build_ms},
          {"pose_ms", range_of(m->pose_ms.data(), m->frame_count).median},
          {"refit_ms", range_of(m->refit_ms.data(), m->frame_count).median}};
}

void print_table(const CommonOptions& options, const Renderer& renderer, Measurement* m) {
  MeasuredRange pixel = range_of(m->ns_per_pixel.data(), m->frame_count);
  std::printf("%s: %s triangles, %u×%u, %u thread%s, %s, %u frame%s%s\n", shown(options.scene).c_str(),
              grouped(renderer.scene.triangles.count).c_str(), renderer.settings.width, renderer.settings.height,
              renderer.settings.threads, renderer.settings.threads == 1 ? "" : "s", isa_name(active_isa()),
              m->frame_count, m->frame_count == 1 ? "" : "s", emulation_text(renderer.pace).c_str());
  std::printf("  %-22s %10.0f ns   (%.0f … %.0f)\n", "per pixel", pixel.median, pixel.min, pixel.max);
  std::printf("  %-22s %10.1f ms   (%.1f frames per second)\n", "per frame",
              pixel.median * pixel_count(renderer) * 1e-6, 1e9 / (pixel.median * pixel_count(renderer)));
  if (m->coherent)
    std::printf("  %-22s %10.1f %%   (those that may have changed since the last frame)\n", "pixels traced",
                100 * static_cast<double>(m->pixels_traced) / (pixel_count(renderer) * m->frame_count));
  print_whole_frames(renderer, *m);
  std::printf("  %-22s %10.2f million\n", "rays per second", rays_per_second(*m) * 1e-6);
  for (int kind = 0; kind < kRayKindCount; ++kind)
    if (m->counts.rays[kind])
      std::printf("  %-22s %10s per frame\n", (std::string(kRayKindNames[kind]) + " rays").c_str(),
                  grouped(m->counts.rays[kind]).c_str());
  std::printf("  %-22s %10s per frame, at most %.2g of radiance per sample\n", "rays skipped",
              grouped(m->counts.rays_left_out).c_str(), static_cast<double>(m->counts.left_out_max));
  std::printf("  %-22s %10.1f ms\n", "build", renderer.timings.build_ms);
  if (has(renderer.effects.mask, Effect::animation))
    std::printf("  %-22s %10.2f ms and %.2f ms\n", "pose and refit", range_of(m->pose_ms.data(), m->frame_count).median,
                range_of(m->refit_ms.data(), m->frame_count).median);
  std::printf("price of each effect, ns per pixel (by switching it off)\n");
  for (const EffectRow& row : kEffectList) {
    double price = m->effect_price[static_cast<int>(row.effect)];
    if (std::isfinite(price)) std::printf("  %-22s %10.0f\n", row.name, price);
  }
  print_memory(renderer.memory.plan);
}

Json sparse_json(const SparseCost* costs) {
  auto range = [](const MeasuredRange& ns) { return Json{{"min", ns.min}, {"median", ns.median}, {"max", ns.max}}; };
  Json list = Json::array();
  for (int i = 0; i < kSparseFractionCount; ++i)
    list.push_back({{"fraction", costs[i].fraction},
                    {"scattered_ns_per_pixel", range(costs[i].scattered_ns_per_pixel)},
                    {"patch_ns_per_pixel", range(costs[i].patch_ns_per_pixel)}});
  return list;
}

void print_sparse(const SparseCost* costs) {
  std::printf("cost per traced pixel when only some are traced, ns\n  %-22s %10s %10s\n", "", "scattered", "patches");
  for (int i = 0; i < kSparseFractionCount; ++i)
    std::printf("  %3.0f %% of pixels %18.0f %10.0f\n", 100 * costs[i].fraction, costs[i].scattered_ns_per_pixel.median,
                costs[i].patch_ns_per_pixel.median);
}

int run(const CommonOptions& options, std::uint32_t frame_count, bool prices, bool sparse) {
  OpenScene opened;
  Status status = check_outputs({{"SCENE", options.scene}}, {{"--json", options.json}});
  if (status.ok) status = open_scene(options, {[](const Settings&) -> std::size_t { return 0; }}, &opened);
  if (status.ok) status = start_scene(&opened, options);
  if (!status.ok) return report(status);
  print_notes(opened);
  Renderer* renderer = &opened.renderer;
  if (frame_count == 0 || frame_count > kFrameCountMax)
    return report(failure("--frames is %u: it must lie in 1 … %u", frame_count, kFrameCountMax));
  Measurement m = make_measurement(*renderer, frame_count);
  seal_memory();
  status = measure_frames(renderer, &m);
  if (status.ok && prices) status = measure_prices(renderer, &m);
  unseal_memory();
  SparseCost costs[kSparseFractionCount];
  if (status.ok && sparse) status = measure_sparse(renderer, static_cast<int>(frame_count), costs);
  if (!status.ok) return report(status);
  if (m.frame_count == 0) return kExitInterrupted;
  sparse = sparse && costs[0].fraction > 0;  // not interrupted
  if (options.json != "-") print_table(options, *renderer, &m);
  if (options.json != "-" && sparse) print_sparse(costs);
  if (!options.json.empty()) {
    Json json = to_json(options, *renderer, &m);
    if (sparse) json["sparse"] = sparse_json(costs);
    status = write_json(options.json, json);
  }
  return status.ok && interrupted ? kExitInterrupted : report(status);
}

Json front_json(const CommonOptions& options, const Renderer& renderer, const OpenFront& front, const Front& measured,
                std::uint32_t rounds) {
  Json candidates = Json::array();
  for (std::uint32_t i = 0; i < measured.count; ++i) {
    const Candidate& c = measured.candidates[i];
    char quality[kFrontLineMax];
    format_quality(c, quality, sizeof quality);
    candidates.push_back({{"settings", quality}, {"flip", c.flip}, {"ns_per_pixel", c.ns_per_pixel}});
  }
  return {{"scene", options.scene},
          {"width", renderer.settings.width},
          {"height", renderer.settings.height},
          {"threads", renderer.settings.threads},
          {"emulated", renderer.pace.device ? Json(renderer.pace.device) : Json()},
          {"rounds", rounds},
          {"front", front.path},
          {"candidates", candidates}};
}

void print_front(const CommonOptions& options, const Renderer& renderer, const OpenFront& front, const Front& measured,
                 std::uint32_t rounds) {
  std::printf("%s: %u×%u, %u thread%s, %u round%s%s; prices saved in %s\n", shown(options.scene).c_str(),
              renderer.settings.width, renderer.settings.height, renderer.settings.threads,
              renderer.settings.threads == 1 ? "" : "s", rounds, rounds == 1 ? "" : "s",
              emulation_text(renderer.pace).c_str(), front.path.empty() ? "no file" : shown(front.path).c_str());
  for (std::uint32_t i = 0; i < measured.count; ++i) {
    const Candidate& c = measured.candidates[i];
    char quality[kFrontLineMax];
    format_quality(c, quality, sizeof quality);
    std::printf("  %10.0f ns per pixel %10.1f ms   ꟻLIP %-8s %s\n", static_cast<double>(c.ns_per_pixel),
                static_cast<double>(c.ns_per_pixel) * pixel_count(renderer) * 1e-6, error_text(c).c_str(), quality);
  }
}

// Measures and saves the prices of the front that --budget-ms chooses from.
int run_front(const CommonOptions& options, const std::string& file, std::uint32_t rounds) {
  OpenScene opened;
  OpenFront front;
  Status status = check_outputs({{"SCENE", options.scene}}, {{"--front", file}, {"--json", options.json}});
  if (status.ok) status = open_scene_with_front(options, {file, true}, front_prices_bytes, &opened, &front);
  if (status.ok && file.empty() && !front.path.empty()) status = make_cache(front.path, "--front");
  if (!status.ok) return report(status);
  print_notes(opened);
  print_notes(front);
  if (rounds == 0 || rounds > kFrameCountMax)
    return report(failure("--frames is %u: it must lie in 1 … %u", rounds, kFrameCountMax));
  FrontPrices prices = make_front_prices(front.front, rounds);
  seal_memory();
  status = measure_front(&opened.renderer, front.front, &prices);
  unseal_memory();
  if (!status.ok) return report(status);
  if (prices.round_count == 0) return kExitInterrupted;
  Front measured = measured_front(front.front, &prices);
  status = keep_measured(front, measured);
  if (options.json != "-") print_front(options, opened.renderer, front, measured, prices.round_count);
  if (status.ok && !options.json.empty())
    status = write_json(options.json, front_json(options, opened.renderer, front, measured, prices.round_count));
  return status.ok && interrupted ? kExitInterrupted : report(status);
}

}  // namespace

void add_bench_command(Command program, int* exit_status) {
  auto options = std::make_shared<CommonOptions>();
  auto frames = std::make_shared<std::uint32_t>(9);
  auto no_prices = std::make_shared<bool>(false);
  auto sparse = std::make_shared<bool>(false);
  auto front = std::make_shared<std::string>();
  Command command = program.add_subcommand("bench", "measure the cost per pixel, scanline, ray and effect");
  add_scene_options(command, options.get());
  add_coherence_options(command, options.get(), "off");
  command.chapter("Measurement");
  command.add_option("--frames N", *frames, "frames to measure, after one that warms up")
      .range(1, kFrameCountMax)
      .capture_default_str();
  command.add_flag("--no-prices", *no_prices, "do not measure each effect");
  command.add_flag("--sparse", *sparse, "also measure pixels when few are traced")
      .details("2, 10, 50 and 100 % of the pixels, scattered and in patches.");
  Option priced = command.add_option("--front [FILE]", *front, "instead, measure and save prices for --budget-ms")
                      .details("In FILE, or in the scene's file in the cache. `render` and `view` choose from them.");
  add_json_option(command, &options->json);
  add_look_options(command, options.get(), {"--front"});
  priced.excludes(command.get_option("--coherence"), "the front's frames are traced whole");
  for (const char* chosen : {"--samples", "--depth", "--area-lights", "--cut-off", "--texture-filter", "--normals"})
    priced.excludes(command.get_option(chosen), "the front has settings of its own");
  command.everyday("Picture", {"--size", "--quality", "--effects"});
  command.everyday("Machine", {"--threads", "--isa", "--accel", "--emulate"});
  command.everyday("Measurement", {"--frames", "--no-prices", "--sparse", "--front", "--json"});
  command.example("pocketray bench cornell --threads 1");
  command.callback([=] {
    options->outputs = {{"--front", *front}};
    *exit_status =
        priced.count() > 0 ? run_front(*options, *front, *frames) : run(*options, *frames, !*no_prices, *sparse);
  });
}

}  // namespace pocketray
