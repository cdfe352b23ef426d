// pocketray render: renders a frame or a sequence into files.
#include <cinttypes>
#include <cmath>
#include <nlohmann/json.hpp>

#include "app/coherent_sequence.h"
#include "app/commands.h"
#include "app/options.h"
#include "base/limit_list.h"
#include "base/seal.h"
#include "budget/budget.h"
#include "engine/frame.h"
#include "session/camera_control.h"
#include "session/interrupt.h"
#include "session/output.h"
#include "session/picture.h"
#include "session/progress.h"
#include "session/report.h"
#include "session/sequence.h"
#include "session/servers.h"

namespace pocketray {
namespace {

struct RenderOptions {
  CommonOptions common;
  std::string output = "out.png", frames, aov = "none", raw_format = "rgb565";
  double seconds = 0;
  float orbit_degrees = 0;
  int rotation = 0;
  bool dither = false, plan = false;
  ServersOptions servers;
  OptionalParts parts;
  BudgetOptions budget;
};

Status parse_aov(const std::string& text, Aov* aov) {
  constexpr struct {
    const char* name;
    Aov aov;
  } kNames[] = {{"none", Aov::none},
                {"depth", Aov::depth},
                {"normal", Aov::normal},
                {"triangle", Aov::triangle},
                {"cost", Aov::cost}};
  for (const auto& row : kNames)
    if (text == row.name) return *aov = row.aov, success();
  return failure("--aov is '%s': it must be depth, normal, triangle or cost", text.c_str());
}

Status parse_raw_format(const std::string& text, PixelFormat* format) {
  const struct {
    const char* name;
    PixelFormat format;
  } kNames[] = {{"rgb565", kRgb565},     {"bgr565", kBgr565}, {"xrgb8888", kXrgb8888},
                {"xbgr8888", kXbgr8888}, {"rgb888", kRgb888}, {"bgr888", kBgr888}};
  for (const auto& row : kNames)
    if (text == row.name) return *format = row.format, success();
  return failure("--raw-format is '%s': it must be rgb565, bgr565, xrgb8888, xbgr8888, rgb888 or bgr888", text.c_str());
}

// "out.png" and 7 → "out-0007.png".
std::string numbered_path(const std::string& path, std::uint32_t number) {
  char digits[16];
  std::snprintf(digits, sizeof digits, "-%04" PRIu32, number);
  std::size_t dot = path.rfind('.');
  return path.substr(0, dot) + digits + path.substr(dot);
}

// Scales an AOV to display levels; formats of radiance keep the values.
void fit_for_levels(Aov aov, const std::string& path, Renderer* renderer) {
  if (aov == Aov::none || has_suffix(path.c_str(), ".pfm")) return;
  renderer->exposure = 1;
  float most = 0;
  for (const Vec3& p : renderer->image) most = max_component(p) > most ? max_component(p) : most;
  for (Vec3& p : renderer->image) {
    if (aov == Aov::normal) {
      if (!is_zero(p)) p = (p + Vec3{1, 1, 1}) * 0.5f;
    } else if (most > 0) {
      p = p * (1 / most);
    }
  }
}

struct Job {
  RenderOptions options;
  FrameRange sequence;
  std::vector<std::string> paths;  // one per picture
  Aov aov;
  PictureOptions picture;
  Servers* servers = nullptr;
  Budget* budget = nullptr;
  CoherentSequence* coherent = nullptr;  // null: frames are traced whole
  std::uint8_t* page = nullptr;          // the packed frame, for --budget-ms: packing is part of the frame time
  CameraControl camera;                  // for --orbit
};

constexpr std::uint64_t kProgressNs = 100'000'000;

Status render_with_servers(Renderer* renderer, const Job& job, double seconds, std::uint64_t rows_before,
                           Progress* progress, bool* complete) {
  const ServersBackend& servers = *job.servers->backend;
  std::uint64_t start = clock_ns();
  RETURN_IF_ERROR(servers.begin_frame(job.servers, renderer, seconds));
  do {
    if (servers.state(*job.servers).cut_off)
      return failure("no server answers, and the scene does not fit in --memory: start a server, or raise --memory");
    *complete = servers.advance_frame(job.servers, renderer, clock_ns() + kProgressNs, &interrupted);
    ServersState state = servers.state(*job.servers);
    if (state.disputed)
      return failure("frame discarded: two servers disagree about its pixels (--verify 0 skips the check)");
    show_progress(progress, rows_before + state.rows_done);
  } while (!*complete && !interrupted);
  renderer->timings.trace_ms = static_cast<double>(clock_ns() - start) * 1e-6;
  return success();
}

// Renders in bands of rows, or what has changed, to show progress and to lose at most a frame when interrupted.
Status render_with_progress(Renderer* renderer, const Job& job, std::uint32_t frame, Progress* progress,
                            bool* complete) {
  double seconds =
      job.sequence.given ? frame / static_cast<double>(renderer->scene.info.frames_per_second) : job.options.seconds;
  std::uint64_t rows_before = std::uint64_t(frame - job.sequence.first) * renderer->settings.height;
  if (job.servers) return render_with_servers(renderer, job, seconds, rows_before, progress, complete);
  if (job.coherent) {
    RETURN_IF_ERROR(render_next(renderer, seconds, job.coherent, complete));
    show_progress(progress, rows_before + renderer->settings.height);
    return success();
  }
  struct Shown {
    Progress* progress;
    std::uint64_t rows_before;
  } shown = {progress, rows_before};
  SpanList bands = row_bands(renderer);
  bands.progress_context = &shown;
  bands.progress = [](void* context, std::uint32_t row_count) {
    const Shown& s = *static_cast<Shown*>(context);
    show_progress(s.progress, s.rows_before + row_count);
  };
  SpanSource source = list_source(&bands);
  source.aov = job.aov;
  source.stop = &interrupted;
  return render_frame(renderer, seconds, source, complete);
}

void pack_page(Renderer* renderer, const Job& job) {
  const PictureOptions& p = job.picture;
  std::uint64_t start = clock_ns();
  pack_rows(renderer->image.data, static_cast<int>(renderer->settings.width),
            static_cast<int>(renderer->settings.height), 0, static_cast<int>(renderer->settings.height),
            renderer->exposure, p.packed_format, Rotation::none, p.dither, job.page, p.packed_line_bytes);
  wait_for_pace(&renderer->pace, 0, start);
}

// Renders a single frame until its settings settle, a frame of a sequence once.
Status render_budgeted(Renderer* renderer, const Job& job, std::uint32_t frame, Progress* progress, bool* complete) {
  constexpr int kSettleFrames = 12;  // derived: as many as the ladder of builtin_front() has steps up
  RETURN_IF_ERROR(begin_budget_frame(job.budget, renderer));
  for (int i = 0; i < kSettleFrames; ++i) {
    std::uint32_t chosen = job.budget->governor.current;
    std::uint64_t start = clock_ns();
    RETURN_IF_ERROR(render_with_progress(renderer, job, frame, progress, complete));
    if (!*complete) break;
    pack_page(renderer, job);
    end_budget_frame(job.budget, clock_ns() - start);
    if (job.sequence.given || i + 1 == kSettleFrames) break;
    RETURN_IF_ERROR(begin_budget_frame(job.budget, renderer));
    if (job.budget->governor.current == chosen) break;
  }
  return success();
}

Status render_one(Renderer* renderer, const Job& job, std::uint32_t frame, Progress* progress, bool* complete) {
  if (job.options.orbit_degrees != 0) {
    float degrees = static_cast<float>(frame - job.sequence.first) * job.options.orbit_degrees;
    RETURN_IF_ERROR(set_camera(renderer, orbited_camera(job.camera, degrees)));
  }
  return job.budget ? render_budgeted(renderer, job, frame, progress, complete)
                    : render_with_progress(renderer, job, frame, progress, complete);
}

Json to_json(const Job& job, const Renderer& renderer, const std::vector<std::string>& files, double trace_ms) {
  Tracer counts = total_counts(renderer);
  Json rays = Json::object();
  for (int kind = 0; kind < kRayKindCount; ++kind) rays[kRayKindNames[kind]] = counts.rays[kind];
  double pixels = static_cast<double>(renderer.settings.width) * renderer.settings.height *
                  static_cast<double>(files.empty() ? 1 : files.size());
  return {{"scene", job.options.common.scene},
          {"files", files},
          {"triangles", triangle_count(job.servers, renderer)},
          {"width", renderer.settings.width},
          {"height", renderer.settings.height},
          {"ns_per_pixel", trace_ms * 1e6 / pixels},
          {"emulated", renderer.pace.device ? Json(renderer.pace.device) : Json()},
          {"rays", rays},
          {"rays_left_out", counts.rays_left_out},
          {"left_out_radiance_max", counts.left_out_max},
          {"exposure", renderer.exposure},
          {"memory", memory_json(renderer.memory)},
          {"effects", effects_json(renderer.effects)},
          {"coherence", job.coherent ? coherence_json(*job.coherent) : Json()},
          {"budget", job.budget ? budget_json(*job.budget) : Json()}};
}

void print_summary(const Job& job, const Renderer& renderer, std::size_t file_count, const std::string& last,
                   double trace_ms) {
  double pixels =
      static_cast<double>(renderer.settings.width) * renderer.settings.height * static_cast<double>(file_count);
  if (job.options.plan) {
    print_effects(renderer.effects);
    print_memory(renderer.memory);
  }
  std::printf("%s: %u×%u, %s triangles, %.1f ms%s, %.0f ns per pixel, %u thread%s%s\n", last.c_str(),
              renderer.settings.width, renderer.settings.height, grouped(triangle_count(job.servers, renderer)).c_str(),
              trace_ms / static_cast<double>(file_count), file_count > 1 ? " per frame" : "", trace_ms * 1e6 / pixels,
              renderer.settings.threads, renderer.settings.threads == 1 ? "" : "s",
              emulation_text(renderer.pace).c_str());
  if (job.coherent) print_coherence(*job.coherent);
  Tracer counts = total_counts(renderer);
  if (counts.rays_left_out)
    std::printf("  %s rays skipped, which could change a sample by at most %.2g of a display level in total\n",
                grouped(counts.rays_left_out).c_str(),
                static_cast<double>(counts.left_out_max * renderer.exposure) * 255 * 12.92);
}

void print_share(const Servers& servers, std::uint32_t width) {
  ServersTotals t = servers.backend->totals(servers);
  if (t.frames == 0) return;
  double rows = static_cast<double>(t.device_rows + t.server_rows), frames = static_cast<double>(t.frames);
  std::printf("  render servers: the device rendered %.0f %% of the rows, servers sent %.1f kB per frame",
              100 * static_cast<double>(t.device_rows) / rows, static_cast<double>(t.bytes_in) * 1e-3 / frames);
  if (t.device_rows > 0)
    std::printf("; the device traced %.1f %% of its pixels",
                100 * static_cast<double>(t.device_pixels) / (static_cast<double>(t.device_rows) * width));
  if (t.unchanged_frames > 0)
    std::printf("; %.0f frames equal the one before", static_cast<double>(t.unchanged_frames));
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

// Refuses pictures that servers cannot send.
Status check_shareable(const RenderOptions& o, Aov aov) {
  if (o.servers.addresses.empty()) return success();
  if (aov != Aov::none) return failure("--server sends only colours: drop --server or --aov");
  if (has_suffix(o.output.c_str(), ".pfm"))
    return failure("--server sends display levels but .pfm stores radiance: drop --server, or write .png or .ppm");
  return success();
}

Status start_servers_for(const RenderOptions& o, Renderer* renderer, Job* job) {
  if (!job->servers) return success();
  bool raw = has_suffix(o.output.c_str(), ".raw");
  const ServersBackend& servers = *job->servers->backend;
  bool small_pixels = raw && job->picture.raw_format.bits_per_pixel == 16;
  RETURN_IF_ERROR(servers.start(job->servers, renderer, small_pixels, raw && o.dither));
  MergedPicture merged = servers.picture(*job->servers);
  job->picture.packed = merged.pixels;
  job->picture.packed_line_bytes = merged.line_bytes;
  job->picture.packed_format = merged.format;
  return success();
}

// With a budget, packing for the screen is part of the frame.
std::size_t budget_bytes(const Settings& settings) {
  return picture_bytes(settings) + arena_need(std::size_t(settings.width) * settings.height * 4);
}

Status check_budget_and_orbit(const RenderOptions& o, Aov aov) {
  if (o.orbit_degrees != 0 && o.frames.empty())
    return failure("--orbit turns the camera from frame to frame: add --frames 0:359");
  if (o.budget.ms == 0) return success();
  if (!o.servers.addresses.empty())
    return failure("--budget-ms changes settings per frame and servers cannot: drop --budget-ms or --server");
  if (aov != Aov::none) return failure("--budget-ms renders only colours: drop --budget-ms or --aov");
  return success();
}

// Coherence is for sequences in colour.
const char* incoherent_because(const RenderOptions& o, Aov aov) {
  if (o.frames.empty()) return "a single frame: add --frames 0:99, or drop --coherence";
  return aov != Aov::none ? "--aov: drop --aov or --coherence" : nullptr;
}

// Opens the scene with a budget, without servers.
Status open_budgeted(const RenderOptions& o, Job* job, OpenScene* opened, Budget* budget) {
  OpenFront front;
  RETURN_IF_ERROR(open_scene_with_front(o.common, {o.budget.front}, budget_bytes, opened, &front));
  print_notes(front);
  Renderer* renderer = &opened->renderer;
  start_budget(o.budget, front, *renderer, job->sequence.last - job->sequence.first + 12, budget);
  job->budget = budget;
  PictureOptions* p = &job->picture;
  bool raw = has_suffix(o.output.c_str(), ".raw");
  p->packed_format = raw ? p->raw_format : kRgb888;
  p->dither = raw && o.dither;
  p->packed_line_bytes = static_cast<int>(renderer->settings.width) * p->packed_format.bits_per_pixel / 8;
  job->page = arena_array<std::uint8_t>(&renderer->frame_arena,
                                        static_cast<std::size_t>(p->packed_line_bytes) * renderer->settings.height)
                  .data;
  p->packed = job->page;
  return success();
}

// Checks that each picture can be written, before rendering the first.
Status check_paths(const RenderOptions& o, Job* job) {
  RETURN_IF_ERROR(check_picture_path(o.output));
  const FrameRange& s = job->sequence;
  for (std::uint32_t frame = s.first; frame <= s.last; ++frame) {
    job->paths.push_back(s.given ? numbered_path(o.output, frame) : o.output);
    RETURN_IF_ERROR(check_outputs({{"SCENE", o.common.scene}, {"--front", o.budget.front}},
                                  {{"-o", job->paths.back()}, {"--json", o.common.json}}));
  }
  return success();
}

Status render_files(Renderer* renderer, const Job& job, std::vector<std::string>* files, double* trace_ms,
                    bool* stopped) {
  const FrameRange& s = job.sequence;
  Progress progress = start_progress("rendering", std::uint64_t(s.last - s.first + 1) * renderer->settings.height);
  Status status;
  seal_memory();
  std::size_t written = 0;
  for (std::uint32_t frame = s.first; frame <= s.last; ++frame, ++written) {
    bool complete;
    float exposure = renderer->exposure;
    status = render_one(renderer, job, frame, &progress, &complete);
    if (!status.ok) break;
    *stopped = !complete;
    if (*stopped) break;
    *trace_ms += renderer->timings.trace_ms;
    fit_for_levels(job.aov, job.paths[written], renderer);
    status = write_picture(job.paths[written].c_str(), job.picture, renderer);
    renderer->exposure = exposure;
    if (!status.ok) break;
  }
  unseal_memory();
  end_progress(&progress);
  files->assign(job.paths.begin(), job.paths.begin() + static_cast<std::ptrdiff_t>(written));
  return status;
}

int run(RenderOptions options) {
  Job job;
  Status status = parse_frames(options.frames, &job.sequence);
  if (status.ok) status = parse_aov(options.aov, &job.aov);
  if (status.ok) status = parse_raw_format(options.raw_format, &job.picture.raw_format);
  if (status.ok) status = check_paths(options, &job);
  if (status.ok && !rotation_from_degrees(options.rotation, &job.picture.rotation))
    status = failure("--rotate is %d: it must be 0, 90, 180 or 270", options.rotation);
  if (status.ok) status = check_limit(Quantity::seconds, options.seconds, "--time");
  if (status.ok && !(std::fabs(options.orbit_degrees) <= 360))
    status = failure("--orbit is %g: it must lie in -360 … 360", static_cast<double>(options.orbit_degrees));
  job.picture.dither = options.dither;
  if (status.ok) status = check_shareable(options, job.aov);
  if (status.ok) status = check_budget_and_orbit(options, job.aov);
  if (status.ok) status = check_coherence(incoherent_because(options, job.aov), &options.common);
  job.options = options;
  const platform::Device* device = nullptr;
  if (status.ok) status = find_device(options.common, &device);
  if (status.ok)
    status =
        open_servers(options.parts, options.servers, options.common.emulate.empty() ? nullptr : device, &job.servers);
  ServersHandle closing(job.servers);
  OpenScene opened;
  Budget budget;
  if (status.ok)
    status = options.budget.ms > 0 ? open_budgeted(options, &job, &opened, &budget)
                                   : open_scene_with(job.servers, options.common, picture_bytes, &opened);
  if (status.ok && options.orbit_degrees != 0)
    job.camera = make_camera_control(opened.renderer.camera, opened.renderer.accel.bounds);
  if (status.ok) status = start_servers_for(options, &opened.renderer, &job);
  if (!status.ok && interrupted) return kExitInterrupted;
  if (!status.ok) return report(status);
  print_notes(opened);
  std::vector<std::string> files;
  double trace_ms = 0;
  bool stopped = false;
  CoherentSequence coherent;
  if (opened.renderer.coherence_state.planned && !job.servers) job.coherent = &coherent;  // or the client uses it
  status = render_files(&opened.renderer, job, &files, &trace_ms, &stopped);
  if (!files.empty() && options.common.json != "-")
    print_summary(job, opened.renderer, files.size(), files.back(), trace_ms);
  if (!files.empty() && options.common.json != "-" && job.servers)
    print_share(*job.servers, opened.renderer.settings.width);
  if (!files.empty() && options.common.json != "-" && job.budget) print_budget(budget, !job.sequence.given);
  if (status.ok && job.budget) status = finish_budget(budget);
  if (status.ok && !options.common.json.empty())
    status = write_json(options.common.json, to_json(job, opened.renderer, files, trace_ms));
  if (status.ok && stopped) {
    std::fprintf(stderr, "pocketray: interrupted; %zu finished frame%s kept\n", files.size(),
                 files.size() == 1 ? " is" : "s are");
    return kExitInterrupted;
  }
  return report(status);
}

}  // namespace

void add_render_command(Command program, const OptionalParts& parts, int* exit_status) {
  auto o = std::make_shared<RenderOptions>();
  o->parts = parts;
  Command command = program.add_subcommand("render", "render a frame or a sequence to files");
  add_scene_options(command, &o->common);
  if (parts.servers) add_servers_options(command, &o->servers);
  add_budget_options(command, &o->budget);
  add_look_options(command, &o->common);
  add_coherence_options(command, &o->common);
  command
      .add_option("-o,--output", o->output,
                  "picture to write: .png, .ppm, .pfm (linear radiance) or .raw (framebuffer bytes)")
      .capture_default_str();
  command.add_option("--frames", o->frames, "render a sequence, FIRST:LAST, into numbered files: out-0000.png …");
  command.add_option("--time", o->seconds, "animation time in seconds, for a single frame").capture_default_str();
  command.add_option("--orbit", o->orbit_degrees, "degrees that the camera orbits its target per frame")
      .capture_default_str();
  command.add_option("--aov", o->aov, "write depth, normal, triangle or cost instead of colour (.pfm keeps the values)")
      .capture_default_str();
  command.add_option("--rotate", o->rotation, "rotate .raw pictures clockwise: 0, 90, 180 or 270")
      .capture_default_str();
  command.add_flag("--dither", o->dither, "apply ordered dithering to .raw pictures");
  command
      .add_option("--raw-format", o->raw_format,
                  "pixel format of .raw: rgb565, bgr565, xrgb8888, xbgr8888, rgb888, bgr888")
      .capture_default_str();
  command.add_flag("--plan", o->plan, "also print the effect plan and the memory map");
  add_json_option(command, &o->common.json);
  command.callback([=] { *exit_status = run(*o); });
}

}  // namespace pocketray
