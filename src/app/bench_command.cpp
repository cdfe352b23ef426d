// pocketray bench: what a pixel, a scanline, a ray and an effect cost.
#include <algorithm>
#include <vector>

#include "app/commands.h"
#include "app/frame.h"
#include "app/interrupt.h"
#include "app/options.h"
#include "app/report.h"
#include "base/seal.h"
#include "effect/effect_list.h"

namespace pocketray {
namespace {

constexpr std::uint32_t kFrameCountMax = 1000;

struct Range {
  double min = 0, median = 0, max = 0;
};

Range range_of(double* values, std::uint32_t count) {
  std::sort(values, values + count);
  return {values[0], (values[(count - 1) / 2] + values[count / 2]) / 2, values[count - 1]};
}

struct Measurement {
  std::uint32_t frame_count = 0;
  double ns_per_pixel[kFrameCountMax];
  std::vector<double> row_ns;  // rows × frames
  Tracer counts;               // of one frame
  double trace_ns = 0;         // of all frames
  Range refit_ms;
  double effect_price[kEffectCount];  // ns per pixel; NaN: not measured
};

double pixel_count(const Renderer& r) { return static_cast<double>(r.settings.width) * r.settings.height; }

Status render_once(Renderer* r, std::uint32_t frame, double* ns_per_pixel) {
  double seconds = frame / static_cast<double>(r->scene.info.frames_per_second);
  RETURN_IF_ERROR(render_frame(r, seconds));
  *ns_per_pixel = r->timings.trace_ms * 1e6 / pixel_count(*r);
  return success();
}

Status measure_frames(Renderer* r, std::uint32_t frame_count, Measurement* m) {
  double refit_ms[kFrameCountMax];
  for (std::uint32_t frame = 0; frame < frame_count && !interrupted; ++frame) {
    RETURN_IF_ERROR(render_once(r, frame, &m->ns_per_pixel[frame]));
    for (std::uint32_t row = 0; row < r->settings.height; ++row)
      m->row_ns[static_cast<std::size_t>(row) * frame_count + frame] = static_cast<double>(r->row_ns[row]);
    m->trace_ns += r->timings.trace_ms * 1e6;
    refit_ms[frame] = r->timings.refit_ms;
    m->counts = total_counts(*r);
    m->frame_count = frame + 1;
  }
  if (m->frame_count) m->refit_ms = range_of(refit_ms, m->frame_count);
  return success();
}

// What an effect costs: the median of frames with it minus frames without it, in turn.
Status measure_price(Renderer* r, Effect effect, double* price) {
  constexpr int kRounds = 3;
  EffectMask mask = r->effects.mask;
  std::uint32_t samples = r->settings.samples_per_pixel;
  double with[kRounds], without[kRounds];
  for (int round = 0; round < kRounds && !interrupted; ++round) {
    RETURN_IF_ERROR(render_once(r, 0, &with[round]));
    r->effects.mask = mask & ~bit(effect);
    if (effect == Effect::supersampling) r->settings.samples_per_pixel = 1;
    Status status = render_once(r, 0, &without[round]);
    r->effects.mask = mask;
    r->settings.samples_per_pixel = samples;
    RETURN_IF_ERROR(status);
  }
  *price = range_of(with, kRounds).median - range_of(without, kRounds).median;
  return success();
}

Status measure_prices(Renderer* r, Measurement* m) {
  for (int i = 0; i < kEffectCount; ++i) {
    m->effect_price[i] = std::numeric_limits<double>::quiet_NaN();
    Effect effect = static_cast<Effect>(i);
    if (!has(r->effects.mask, effect) || interrupted) continue;
    if (effect == Effect::animation) {
      m->effect_price[i] = m->refit_ms.median * 1e6 / pixel_count(*r);
      continue;
    }
    RETURN_IF_ERROR(measure_price(r, effect, &m->effect_price[i]));
  }
  return success();
}

double rays_per_second(const Measurement& m) {
  std::uint64_t rays = 0;
  for (std::uint64_t count : m.counts.rays) rays += count;
  return m.trace_ns > 0 ? static_cast<double>(rays) * m.frame_count / (m.trace_ns * 1e-9) : 0;
}

Json to_json(const CommonOptions& options, const Renderer& r, Measurement* m) {
  Range pixel = range_of(m->ns_per_pixel, m->frame_count);
  Json rows = Json::array();
  std::size_t stride = m->row_ns.size() / r.settings.height;
  for (std::uint32_t row = 0; row < r.settings.height; ++row)
    rows.push_back(range_of(&m->row_ns[row * stride], m->frame_count).median / r.settings.width);
  Json rays = Json::object();
  for (int kind = 0; kind < kRayKindCount; ++kind) rays[kRayKindNames[kind]] = m->counts.rays[kind];
  Json effects = effects_json(r.effects);
  for (int i = 0; i < kEffectCount; ++i)
    if (std::isfinite(m->effect_price[i])) effects[static_cast<std::size_t>(i)]["price_ns_per_pixel"] = m->effect_price[i];
  return {{"scene", options.scene},
          {"triangles", r.scene.triangles.count},
          {"width", r.settings.width},
          {"height", r.settings.height},
          {"threads", r.settings.threads},
          {"frames", m->frame_count},
          {"ns_per_pixel", {{"min", pixel.min}, {"median", pixel.median}, {"max", pixel.max}}},
          {"scanline_ns_per_pixel", rows},
          {"rays", rays},
          {"rays_left_out", m->counts.rays_left_out},
          {"left_out_radiance_max", m->counts.left_out_max},
          {"rays_per_second", rays_per_second(*m)},
          {"nodes_visited", m->counts.stats.nodes},
          {"triangles_tested", m->counts.stats.triangles},
          {"memory", memory_json(r.memory)},
          {"effects", effects},
          {"build_ms", r.timings.build_ms},
          {"refit_ms", m->refit_ms.median}};
}

void print_table(const CommonOptions& options, const Renderer& r, Measurement* m) {
  Range pixel = range_of(m->ns_per_pixel, m->frame_count);
  std::printf("%s: %s triangles, %u×%u, %u thread%s, %u frame%s\n", options.scene.c_str(), grouped(r.scene.triangles.count).c_str(),
              r.settings.width, r.settings.height, r.settings.threads, r.settings.threads == 1 ? "" : "s", m->frame_count, m->frame_count == 1 ? "" : "s");
  std::printf("  %-22s %10.0f ns   (%.0f … %.0f)\n", "per pixel", pixel.median, pixel.min, pixel.max);
  std::printf("  %-22s %10.1f ms   (%.1f frames per second)\n", "per frame", pixel.median * pixel_count(r) * 1e-6, 1e9 / (pixel.median * pixel_count(r)));
  std::printf("  %-22s %10.2f million\n", "rays per second", rays_per_second(*m) * 1e-6);
  for (int kind = 0; kind < kRayKindCount; ++kind)
    if (m->counts.rays[kind]) std::printf("  %-22s %10s per frame\n", (std::string(kRayKindNames[kind]) + " rays").c_str(), grouped(m->counts.rays[kind]).c_str());
  std::printf("  %-22s %10s per frame, at most %.2g of radiance a sample\n", "rays left out", grouped(m->counts.rays_left_out).c_str(),
              static_cast<double>(m->counts.left_out_max));
  std::printf("  %-22s %10.1f ms\n", "build", r.timings.build_ms);
  if (has(r.effects.mask, Effect::animation)) std::printf("  %-22s %10.2f ms\n", "pose and refit", m->refit_ms.median);
  std::printf("price of each effect, ns per pixel (by switching it off)\n");
  for (const EffectRow& row : kEffectList) {
    double price = m->effect_price[static_cast<int>(row.effect)];
    if (std::isfinite(price)) std::printf("  %-22s %10.0f\n", row.name, price);
  }
  print_memory(r.memory);
}

int run(const CommonOptions& options, std::uint32_t frame_count, bool prices) {
  OpenScene opened;
  Status status = open_scene(options, [](const Settings&) -> std::size_t { return 0; }, &opened);
  if (status.ok) status = start_scene(&opened, options);
  if (!status.ok) return report(status);
  print_notes(opened);
  Renderer* r = &opened.renderer;
  if (frame_count == 0 || frame_count > kFrameCountMax) return report(failure("--frames is %u: it must lie in 1 … %u", frame_count, kFrameCountMax));
  auto m = std::make_unique<Measurement>();
  m->row_ns.resize(static_cast<std::size_t>(r->settings.height) * frame_count);
  std::fill_n(m->effect_price, kEffectCount, std::numeric_limits<double>::quiet_NaN());
  seal_memory();
  double warm_up;
  status = render_once(r, 0, &warm_up);
  if (status.ok) status = measure_frames(r, frame_count, m.get());
  if (status.ok && prices) status = measure_prices(r, m.get());
  unseal_memory();
  if (!status.ok) return report(status);
  if (m->frame_count == 0) return kExitInterrupted;
  if (options.json != "-") print_table(options, *r, m.get());
  if (!options.json.empty()) status = write_json(options.json, to_json(options, *r, m.get()));
  return status.ok && interrupted ? kExitInterrupted : report(status);
}

}  // namespace

void add_bench_command(CLI::App* program, int* exit_status) {
  auto options = std::make_shared<CommonOptions>();
  auto frames = std::make_shared<std::uint32_t>(9);
  auto no_prices = std::make_shared<bool>(false);
  CLI::App* command = program->add_subcommand("bench", "measure what a pixel, a scanline, a ray and an effect cost");
  add_scene_options(command, options.get());
  command->add_option("--frames", *frames, "frames to measure, after one to warm up")->capture_default_str();
  command->add_flag("--no-prices", *no_prices, "leave out the price of each effect");
  command->add_option("--json", options->json, "also write it as JSON to FILE, or - for standard output");
  command->callback([=] { *exit_status = run(*options, *frames, !*no_prices); });
}

}  // namespace pocketray
