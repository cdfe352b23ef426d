// pocketray split-report: measures what render servers gain for a device, for each share of rows, next to the paper's
// table.
#include "app/split_report/split_report_command.h"

#include <nlohmann/json.hpp>

#include "app/options.h"
#include "desktop/accuracy/gnuplot.h"
#include "desktop/split_report/fronts.h"
#include "desktop/split_report/pixel_cost.h"
#include "desktop/split_report/plot.h"
#include "engine/frame.h"
#include "session/interrupt.h"
#include "session/measure.h"
#include "session/note.h"
#include "session/output.h"
#include "session/report.h"
#include "session/scene_identity.h"

namespace pocketray {
namespace {

constexpr std::uint64_t kClockStepNs = 50;  // advance per reading of the simulated clock
constexpr std::uint64_t kSceneBytesMax = std::uint64_t(1) << 36;

struct ReportOptions {
  CommonOptions common;
  std::string folder;
  std::uint32_t server_count = 1, step_count = 21, frame_count = 8;
  float orbit_degrees = 1;
  double device_ns = 0, server_ns = 0;
  bool no_paper = false;
};

// Computes the device's cost of a pixel in frames shared by effect, where these are possible. here_ns: cost of a whole
// pixel on this machine; 0: not measured.
Status make_own_light(double here_ns, SplitSetup* setup) {
  double own_ns;
  RETURN_IF_ERROR(measure_own_light_ns(setup->device, kLightPitch, &own_ns));
  if (own_ns <= 0) return success();
  if (here_ns <= 0) RETURN_IF_ERROR(measure_pixel_ns(setup->device, &here_ns));
  setup->own_light_ns = setup->device_ns * own_ns / here_ns;
  return success();
}

Status make_setup(const ReportOptions& o, const platform::Device& device, Renderer* renderer, SplitSetup* setup) {
  double here_ns = 0;
  if (o.device_ns <= 0 || o.server_ns <= 0) RETURN_IF_ERROR(measure_pixel_ns(renderer, &here_ns));
  setup->device = renderer;
  setup->format = device.bits_per_pixel == 16 ? WireFormat::rgb565 : WireFormat::rgb888;
  setup->line.bytes_per_second = device.link_bytes_per_second;
  setup->line.latency_ns = device.link_latency_ns;
  setup->line.jitter_ns = device.link_jitter_ns;
  setup->line.clock_step_ns = kClockStepNs;
  setup->server_count = o.server_count;
  setup->device_ns = o.device_ns > 0 ? o.device_ns : here_ns * device.slowdown / renderer->settings.threads;
  setup->server_ns = o.server_ns > 0 ? o.server_ns : here_ns;
  RETURN_IF_ERROR(make_own_light(here_ns, setup));
  const PrepareCost cost = {device.prepare_triangle_ns, device.prepare_vertex_ns};
  setup->device_prepare_ns = prepare_ns(cost, renderer->scene);
  setup->server_prepare_ns = prepare_ns(kServerPrepare, renderer->scene);
  setup->decode = {device.decode_pixel_ns, device.decode_byte_ns};
  setup->encode = kServerEncode;
  setup->orbit_degrees = o.orbit_degrees;
  setup->frame_count = o.frame_count;
  return success();
}

std::string title_of(const ReportOptions& o, const SplitSetup& s) {
  const Settings& settings = s.device->settings;
  char text[400];
  std::snprintf(text, sizeof text,
                "%.200s, %ux%u, on %s with %u server%s: %.4g ns per pixel on the device, %.4g ns on a server; link "
                "%.3g MB/s, %.3g ms and up to %.3g ms of jitter",
                o.common.scene.c_str(), settings.width, settings.height, o.common.emulate.c_str(), s.server_count,
                s.server_count == 1 ? "" : "s", s.device_ns, s.server_ns,
                static_cast<double>(s.line.bytes_per_second) * 1e-6, static_cast<double>(s.line.latency_ns) * 1e-6,
                static_cast<double>(s.line.jitter_ns) * 1e-6);
  return text;
}

// Figures besides time.
struct Extras {
  DeviceEnergy energy;
  Fronts fronts;
  std::vector<ClientsRow> clients;
};

Extras make_extras(const platform::Device& device, const SplitSetup& setup, const SplitFigures& figures) {
  Extras extras;
  // W · ns = nJ; all cores are busy.
  extras.energy.pixel_nanojoules = device.core_watts * setup.device->settings.threads * setup.device_ns;
  extras.energy.prepare_nanojoules = device.core_watts * setup.device_prepare_ns;
  extras.energy.byte_nanojoules = device.byte_nanojoules;
  extras.fronts = make_fronts(figures, extras.energy, static_cast<std::uint32_t>(pixel_count(*setup.device)));
  double pixels = 0, bytes = 0;
  for (const SplitPoint& p : figures.sweep) pixels += p.row_count * setup.device->settings.width, bytes += p.row_bytes;
  if (pixels > 0 && bytes > 0) extras.clients = measure_clients(setup, bytes / pixels);
  return extras;
}

Json front_json(const std::vector<FrontPoint>& points, const char* unit) {
  Json front = Json::array();
  for (const FrontPoint& p : points)
    if (p.on_front) front.push_back({{"m", p.m}, {"ms_per_frame", p.ms}, {unit, p.cost}});
  return front;
}

Json point_json(const SplitPoint& p) { return {{"m", p.m}, {"ns_per_pixel", p.ns_per_pixel}}; }

// Null if frames cannot be shared by effect.
Json effect_json(const SplitPoint& p) {
  if (p.ns_per_pixel <= 0) return Json();
  Json point = point_json(p);
  point["bytes_per_frame"] = p.bytes, point["light_bytes_per_frame"] = p.light_bytes,
  point["frames_by_effect"] = p.by_effect;
  return point;
}

Json light_json(const std::vector<LightMapPoint>& points) {
  Json light = Json::array();
  for (const LightMapPoint& p : points)
    light.push_back({{"light_every", p.every > 0 ? Json(p.every) : Json()},
                     {"ns_per_pixel", p.ns_per_pixel},
                     {"light_bytes_per_frame", p.light_bytes},
                     {"flip", p.flip}});
  return light;
}

Json to_json(const ReportOptions& o, const SplitSetup& setup, const SplitFigures& s, const Extras& extras) {
  const Settings& settings = setup.device->settings;
  Json sweep = Json::array(), paper = Json::array(), clients = Json::array();
  for (const ClientsRow& row : extras.clients)
    clients.push_back({{"clients", row.count}, {"ms_per_frame", row.ms}, {"m", row.m}, {"price", row.price}});
  for (const SplitPoint& p : s.sweep) sweep.push_back(point_json(p));
  for (const PaperRow& row : s.paper)
    paper.push_back({{"times_of", row.scene},
                     {"processors", row.processors},
                     {"share", row.share},
                     {"ns_per_pixel", row.ns_per_pixel},
                     {"our_share", row.our_share},
                     {"our_ns_per_pixel", row.our_ns},
                     {"bound_ns_per_pixel", row.bound_ns},
                     {"bytes_per_pixel", row.bytes_per_pixel}});
  return {{"sweep", sweep},
          {"chosen", point_json(s.chosen)},
          {"best", point_json(s.best)},
          {"by_effect", effect_json(s.effect)},
          {"rows_and_effect", effect_json(s.both)},
          {"light", light_json(s.light)},
          {"device_own_light_ns_per_pixel", setup.own_light_ns > 0 ? Json(setup.own_light_ns) : Json()},
          {"local_ns_per_pixel", s.local.ns_per_pixel},
          {"paper", paper},
          {"energy_front", front_json(extras.fronts.energy, "millijoules_per_frame")},
          {"price_front", front_json(extras.fronts.bytes, "kilobytes_per_frame")},
          {"nanojoules_per_pixel", extras.energy.pixel_nanojoules},
          {"nanojoules_per_byte", extras.energy.byte_nanojoules},
          {"one_server_many_clients", clients},
          {"scene", o.common.scene},
          {"emulated", o.common.emulate},
          {"servers", setup.server_count},
          {"width", settings.width},
          {"height", settings.height},
          {"device_ns_per_pixel", setup.device_ns},
          {"server_ns_per_pixel", setup.server_ns},
          {"device_prepare_ms", setup.device_prepare_ns * 1e-6},
          {"server_prepare_ms", setup.server_prepare_ns * 1e-6},
          {"prepared_frames", s.chosen.prepared},
          {"link_bytes_per_second", setup.line.bytes_per_second},
          {"link_latency_ms", static_cast<double>(setup.line.latency_ns) * 1e-6},
          {"link_jitter_ms", static_cast<double>(setup.line.jitter_ns) * 1e-6},
          {"bytes_per_frame", s.chosen.bytes},
          {"row_bytes_per_frame", s.chosen.row_bytes},
          {"kept_rows_per_frame", s.chosen.kept_rows},
          {"kept_row_bytes_per_frame", s.chosen.kept_bytes},
          {"whole_bytes_per_frame", s.whole_bytes},
          {"lossless_bytes_per_frame", s.lossless_bytes},
          {"near_lossless_bytes_per_frame", s.near_bytes},
          {"near_lossless_error_levels", s.near_error},
          {"raw_bytes_per_frame", pixel_count(*setup.device) * pixel_bytes(setup.format)}};
}

void print_sweep(const SplitSetup& setup, const SplitFigures& s) {
  double pixels = pixel_count(*setup.device);
  auto print = [&](const char* what, const SplitPoint& p) {
    if (p.ns_per_pixel > 0)
      std::printf("  %-16s %6.3f %14.1f %12.2f %12.1f\n", what, p.m, p.ns_per_pixel, p.ns_per_pixel * pixels * 1e-6,
                  p.bytes * 1e-3);
  };
  std::printf("  %-16s %6s %14s %12s %12s\n", "", "m", "ns per pixel", "ms per frame", "kB per frame");
  for (const SplitPoint& p : s.sweep) print("m fixed", p);
  print("best of these", s.best);
  print("chosen", s.chosen);
  print("by effect", s.effect);
  print("rows and effect", s.both);
  if (s.sweep.empty()) return;
  std::printf("  chosen m takes %.3f of the best time and is %.4g times as fast as the device alone\n",
              s.chosen.ns_per_pixel / s.best.ns_per_pixel, s.local.ns_per_pixel / s.chosen.ns_per_pixel);
}

void print_bytes(const SplitSetup& setup, const SplitFigures& s) {
  double raw = pixel_count(*setup.device) * pixel_bytes(setup.format);
  double sent = s.chosen.row_count / setup.device->settings.height;
  std::printf(
      "bytes per frame at the chosen m: %.0f, of which %.0f message overhead; the same rows in a first frame: %.0f; "
      "as pixels: %.0f\n",
      s.chosen.bytes, s.chosen.bytes - s.chosen.row_bytes, s.whole_bytes * sent, raw * sent);
  if (s.near_bytes > 0)
    std::printf("all rows: %.0f bytes lossless, %.0f near-lossless with an error of %.2f levels (--near-lossless)\n",
                s.lossless_bytes, s.near_bytes, s.near_error);
  if (setup.device_prepare_ns > 0)
    std::printf(
        "posing and refitting: %.3g ms on the device, which did so in %.0f %% of the "
        "frames, and %.2g ms on a server\n",
        setup.device_prepare_ns * 1e-6, 100 * s.chosen.prepared, setup.server_prepare_ns * 1e-6);
  if (s.chosen.kept_rows > 0)
    std::printf("of these, chunks in which no pixel could change: %.0f bytes, %.1f rows\n", s.chosen.kept_bytes,
                s.chosen.kept_rows);
}

void print_light(const SplitSetup& setup, const SplitFigures& s) {
  if (s.light.empty()) return;
  std::printf("light from a server (--split effect): how different frames look from those of the device alone\n");
  std::printf("  %-16s %14s %14s %8s\n", "--light-every", "ms per frame", "bytes of light", "ꟻLIP");
  for (const LightMapPoint& p : s.light) {
    const std::string every = p.every > 0 ? std::to_string(p.every) : "the device's own";
    std::printf("  %-16s %14.2f %14.0f %8.4f\n", every.c_str(), p.ns_per_pixel * pixel_count(*setup.device) * 1e-6,
                p.light_bytes, p.flip);
  }
}

void print_paper(const SplitFigures& s) {
  if (s.paper.empty()) return;
  std::printf(
      "Aranha et al. 2007, Table 1: this scene's rows with the paper's times, T_m and T_s as printed for its scenes,\n"
      "T_t = 400 ns per pixel, scaled by how well the rows compress\n");
  std::printf("  %-12s %10s %15s %15s %17s %12s\n", "times of", "processors", "share, paper", "ns per pixel",
              "full overlap, ns", "bytes/pixel");
  for (const PaperRow& row : s.paper)
    std::printf("  %-12s %10d %6.2f%% %6.2f%% %7.0f %7.0f %8.0f (%+.1f%%) %10.3f\n", row.scene, row.processors,
                100 * row.our_share, 100 * row.share, row.our_ns, row.ns_per_pixel, row.bound_ns,
                100 * (row.our_ns / row.bound_ns - 1), row.bytes_per_pixel);
  std::printf("  (in each pair, ours comes first)\n");
}

void print_front(const char* unit, const std::vector<FrontPoint>& points) {
  std::printf("  %-16s %6s %14s %14s\n", "", "m", "ms per frame", unit);
  for (const FrontPoint& p : points)
    if (p.on_front) std::printf("  %-16s %6.3f %14.2f %14.3f\n", "not beaten", p.m, p.ms, p.cost);
}

void print_extras(const Extras& extras) {
  if (extras.fronts.energy.empty()) return;
  std::printf(
      "time against energy: the Pareto front of the fixed shares, at %.0f nJ per pixel and %.0f nJ per byte above "
      "idle\n",
      extras.energy.pixel_nanojoules, extras.energy.byte_nanojoules);
  print_front("mJ per frame", extras.fronts.energy);
  std::printf("time against price, if bytes are charged\n");
  print_front("kB per frame", extras.fronts.bytes);
  if (extras.clients.empty()) return;
  std::printf("one of these servers shared by many such devices, each with its best share at the server's price\n");
  std::printf("  %-16s %6s %14s %14s\n", "clients", "m", "ms per frame", "price");
  for (const ClientsRow& row : extras.clients)
    std::printf("  %-16u %6.3f %14.2f %14.2f\n", row.count, row.m, row.ms, row.price);
}

Status write_files(const ReportOptions& o, const SplitSetup& setup, const SplitFigures& figures, const Extras& extras) {
  if (o.folder.empty() || figures.sweep.empty()) return success();
  std::uint32_t pixels = setup.device->settings.width * setup.device->settings.height;
  RETURN_IF_ERROR(write_split_csv(o.folder, figures, pixels));
  RETURN_IF_ERROR(write_fronts_csv(o.folder, extras.fronts, extras.clients));
  bool drawn, fronts_drawn;
  RETURN_IF_ERROR(draw_split(o.folder, {title_of(o, setup), pixels}, figures, &drawn));
  RETURN_IF_ERROR(draw_fronts(o.folder, title_of(o, setup), extras.fronts, extras.clients, &fronts_drawn));
  if (!drawn || !fronts_drawn)
    std::fprintf(stderr,
                 "pocketray: no split.png or fronts.png: gnuplot is missing or failed; install it (Debian: gnuplot), "
                 "then: cd -- %s && gnuplot split.gnuplot fronts.gnuplot\n",
                 shell_word(o.folder).c_str());
  return success();
}

Status measure(const ReportOptions& o, const SplitSetup& setup, SplitFigures* figures) {
  Progress progress = start_progress("split", split_frame_count(setup, o.step_count));
  Status status = measure_split(setup, o.step_count, &progress, figures);
  end_progress(&progress);
  if (status.ok && !interrupted && setup.own_light_ns > 0) {
    progress = start_progress("rows and effects", effect_frame_count(setup));
    status = measure_effects(setup, &progress, figures);
    end_progress(&progress);
    progress = start_progress("maps of light", light_frame_count(setup));
    if (status.ok && !interrupted) status = measure_light(setup, &progress, figures);
    end_progress(&progress);
  }
  if (!status.ok || interrupted || o.no_paper) return status;
  progress = start_progress("the paper's table", paper_frame_count(setup));
  status = measure_paper(setup, &progress, figures);
  end_progress(&progress);
  return status;
}

int run(const ReportOptions& o) {
  const platform::Device* device;
  Status status = find_device(o.common, &device);
  if (status.ok) status = check_outputs({{"SCENE", o.common.scene}}, {{"--json", o.common.json}});
  if (status.ok && !o.folder.empty()) status = make_output_folder(o.folder);
  OpenScene opened;
  SceneStore store;
  SplitSetup setup;
  OpenHooks hooks;
  hooks.output_bytes = [](const Settings&) -> std::size_t { return 0; };
  hooks.loaded = [&](const SceneSource& source, Renderer* renderer) {
    return identify_scene(source, renderer, &setup.scene);
  };
  if (status.ok) status = open_scene(o.common, hooks, &opened);
  if (status.ok) status = start_scene(&opened, o.common);
  if (status.ok) status = store_scene(o.common.scene, o.common.scene, true, kSceneBytesMax, &store);
  if (status.ok) status = make_setup(o, *device, &opened.renderer, &setup);
  if (!status.ok) return report(status);
  print_notes(opened);
  setup.store = &store;
  SplitFigures figures;
  status = measure(o, setup, &figures);
  if (!status.ok) return report(status);
  if (figures.chosen.ns_per_pixel <= 0) {
    print_note("interrupted before the first point of the sweep; nothing is kept");
    return kExitInterrupted;
  }
  const Extras extras = make_extras(*device, setup, figures);
  if (o.common.json != "-") {
    std::printf("pixels, rows and messages are real; time is simulated, at these costs\n");
    std::printf("%s\n", title_of(o, setup).c_str());
    print_sweep(setup, figures);
    print_bytes(setup, figures);
    print_light(setup, figures);
    print_paper(figures);
    print_extras(extras);
  }
  status = write_files(o, setup, figures, extras);
  if (status.ok && !o.common.json.empty()) status = write_json(o.common.json, to_json(o, setup, figures, extras));
  if (status.ok && interrupted) {
    std::fprintf(stderr, "pocketray: interrupted; kept %zu points of the sweep and %zu rows of the table\n",
                 figures.sweep.size(), figures.paper.size());
    return kExitInterrupted;
  }
  return report(status);
}

}  // namespace

void add_split_report_command(Command program, int* exit_status) {
  auto o = std::make_shared<ReportOptions>();
  o->common.emulate = "tablet";
  Command command = program.add_subcommand("split-report", "measure what sharing frames with servers gains");
  add_scene_options(command, &o->common);
  command.get_option("--emulate").capture_default_str();
  add_coherence_options(command, &o->common, "off");
  command.chapter("Simulation");
  command.add_option("--servers N", o->server_count, "number of servers")
      .range(1, kServerCountMax)
      .capture_default_str();
  command.add_option("--steps N", o->step_count, "shares to measure, from 0 to 1")
      .range(2, 1000)
      .capture_default_str()
      .details("A few more are added around the fastest.");
  command.add_option("--frames N", o->frame_count, "frames per share; the median counts")
      .range(2, 1000)
      .capture_default_str();
  command.add_option("--orbit DEGREES", o->orbit_degrees, "orbit the camera by DEGREES per frame")
      .range(-90, 90)
      .capture_default_str()
      .details("0: it stands still, and only rows changed by animation are sent.");
  command.add_option("--device-ns X", o->device_ns, "the device's time per pixel in ns")
      .range(1, 1e9)
      .default_str("measured")
      .details("Otherwise this machine's, times the device's slowdown.");
  command.add_option("--server-ns X", o->server_ns, "a server's time per pixel in ns")
      .range(1, 1e9)
      .default_str("measured")
      .details("Otherwise that of one core here.");
  command.add_flag("--no-paper", o->no_paper, "skip the paper's table");
  command.chapter("Output");
  command.add_option("-o,--output DIR", o->folder, "folder for tables and plots; created if missing")
      .details("split.csv, fronts.csv and, if gnuplot is installed, split.png and fronts.png.");
  add_json_option(command, &o->common.json);
  command.everyday("Output", {"--output", "--json"});
  command.everyday("Picture", {"--size", "--emulate"});
  command.everyday("Simulation",
                   {"--servers", "--steps", "--frames", "--orbit", "--device-ns", "--server-ns", "--no-paper"});
  command.example("pocketray split-report cornell --emulate pi-zero -o .");
  command.example("pocketray split-report statue --emulate tablet --servers 3 --json -");
  command.about(
      "Measures the speed-up by render servers against the device's share of the rows, its energy and bytes, and how "
      "many "
      "devices share a server. Device, link and servers are simulated on a virtual clock, so you need not start any. A "
      "busy machine affects only the measured cost per pixel, unless --device-ns and --server-ns give it, and the "
      "fraction of it that a pixel without indirect light costs.");
  command.callback([=] {
    o->common.output_folder = o->folder;
    *exit_status = run(*o);
  });
}

}  // namespace pocketray
