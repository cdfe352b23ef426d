#include "desktop/split_report/split_report.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>

#include "base/check.h"
#include "desktop/accuracy/display.h"
#include "desktop/accuracy/flip.h"
#include "desktop/split_report/row_streams.h"
#include "engine/frame.h"
#include "engine/light_map.h"
#include "remote/client/frame.h"
#include "session/camera_control.h"
#include "session/interrupt.h"
#include "session/measure.h"
#include "split/closed_form.h"

namespace pocketray {
namespace {

constexpr std::uint32_t kSettleFrames = 40;         // within which all servers must come into use, ...
constexpr std::uint64_t kSettleNs = 1'000'000'000;  // ... unless they take less than this simulated time
constexpr std::uint32_t kSkippedFrames = 2;         // at the start of a lap
constexpr std::uint32_t kChosenLaps = 2;
constexpr double kPaperTransferNs = 400;  // T_t of [Aranha07] sec. 4
constexpr int kRefinements = 2, kPaperRuns = 2, kPaperRows = 6;

// Frames per map of a server's light, as measured. The first is the default.
constexpr std::uint32_t kLightEvery[] = {1, 2, 4, 8};

// While it exists, the device and its servers trace frames whole.
struct WholeFrames {
  Renderer* device;
  CoherenceMode mode;
  CoherenceState state;
  explicit WholeFrames(Renderer* renderer)
      : device(renderer), mode(renderer->settings.coherence), state(renderer->history.state) {
    device->settings.coherence = CoherenceMode::off;
    device->history.state = CoherenceState();
  }
  ~WholeFrames() { device->settings.coherence = mode, device->history.state = state; }
};

struct Experiment {
  SplitSetup setup;
  VirtualWorld world;
  std::vector<unsigned char> memory;
  Client client;
  CameraControl camera;
  std::vector<double> times;
  std::uint32_t frame = 0;  // along the path
  std::uint64_t* frames_done = nullptr;
  Progress* progress = nullptr;
  std::function<void(const Client& client, std::uint32_t step)> shown;  // called with each measured frame; may be null
  ~Experiment() {
    close_client(&client);
    if (setup.device) setup.device->view.camera = camera.home;  // for the next experiment's path
  }
};

Status open_experiment(const SplitSetup& setup, const LightOptions& light, Progress* progress,
                       std::uint64_t* frames_done, Experiment* e) {
  CHECK(setup.device != nullptr && setup.store != nullptr);
  CHECK(setup.server_count >= 1 && setup.server_count <= kServerCountMax);
  CHECK_GT(setup.frame_count, 0u);
  e->setup = setup;
  e->progress = progress, e->frames_done = frames_done;
  e->times.resize(kChosenLaps * std::size_t(setup.frame_count));
  Renderer* renderer = setup.device;
  renderer->pace = Pace();
  e->camera = make_camera_control(renderer->view.camera, renderer->accel.built.bounds);
  RETURN_IF_ERROR(open_world(setup.line, *setup.store, setup.server_count, &e->world));
  ServerOptions server;
  server.thread_count = renderer->settings.threads;
  server.coherence = renderer->settings.coherence;
  server.pace.ns_per_pixel = setup.server_ns, server.pace.prepare_ns = setup.server_prepare_ns;
  server.encode = setup.encode;
  for (std::uint32_t i = 0; i < setup.server_count; ++i) RETURN_IF_ERROR(start_server(&e->world, i, server));
  ClientOptions options;
  options.format = setup.format;
  options.pace.ns_per_pixel = setup.device_ns, options.pace.prepare_ns = setup.device_prepare_ns;
  options.own_light_pixel_ns = setup.own_light_ns;
  options.light = light, options.light.indirect = renderer->settings.indirect;
  options.decode = setup.decode;
  options.check_count = 0;  // measures the split alone: spot checks would add 1 %
  e->memory.resize(client_need(renderer->settings, setup.format, setup.server_count, options.light) + kArenaAlignment);
  Arena arena = make_arena("client", e->memory.data(), e->memory.size());
  RETURN_IF_ERROR(make_client(options, renderer->settings, setup.scene, e->world.link, e->world.addresses.data(),
                              setup.server_count, &arena, &e->client));
  return success();
}

Status open_experiment(const SplitSetup& setup, SplitKind kind, Progress* progress, std::uint64_t* frames_done,
                       Experiment* e) {
  LightOptions light;
  light.split = kind;
  return open_experiment(setup, light, progress, frames_done, e);
}

// Aims the device at a step of the path. Returns its time.
Status aim(const CameraControl& path, const SplitSetup& setup, std::uint32_t step, double* seconds) {
  *seconds = step / static_cast<double>(setup.device->scene.info.frames_per_second);
  if (setup.orbit_degrees == 0) return success();
  return set_camera(setup.device, orbited_camera(path, static_cast<float>(step) * setup.orbit_degrees));
}

// Renders the next frame along the path.
Status next_frame(Experiment* e, bool* complete) {
  std::uint32_t step = e->frame++ % (kSkippedFrames + e->setup.frame_count);
  Renderer* renderer = e->setup.device;
  double seconds;
  RETURN_IF_ERROR(aim(e->camera, e->setup, step, &seconds));
  RETURN_IF_ERROR(render_frame(renderer, &e->client, seconds, &interrupted, complete));
  show_progress(e->progress, ++*e->frames_done);
  return success();
}

// Renders frames until all servers are in use and their speed and the link's are known.
Status settle(Experiment* e, bool* complete) {
  *complete = true;
  const std::uint64_t begin_ns = world_now_ns(e->world);
  for (std::uint32_t i = 0; *complete && !is_settled(e->client); ++i) {
    if (i >= kSettleFrames && world_now_ns(e->world) - begin_ns >= kSettleNs)
      return failure(
          "the servers did not come into use within %u frames of %.3g ms; choose a larger --size or a slower device", i,
          1e-6 * static_cast<double>(world_now_ns(e->world) - begin_ns) / i);
    RETURN_IF_ERROR(next_frame(e, complete));
  }
  for (std::uint32_t i = 0; *complete && i < e->setup.frame_count; ++i) RETURN_IF_ERROR(next_frame(e, complete));
  return success();
}

// Runs the path from its start `lap_count` times, skipping the first frames of each lap, which follow a jump and
// perhaps a change of share. An earlier lap does not count either: a stream that has already seen a small picture's
// path compresses it better.
Status measure_point(Experiment* e, std::uint32_t lap_count, SplitPoint* point, bool* complete, RowStreams* whole) {
  const Settings& settings = e->client.settings;
  const std::uint32_t frame_count = lap_count * e->setup.frame_count;
  CHECK_LE(frame_count, e->times.size());
  *point = SplitPoint();
  *complete = true;
  std::uint32_t measured = 0;
  for (e->frame = 0; *complete && measured < frame_count;) {
    const std::uint32_t lap = kSkippedFrames + e->setup.frame_count;
    bool counts = e->frame >= lap && e->frame % lap >= kSkippedFrames;
    RETURN_IF_ERROR(next_frame(e, complete));
    if (!*complete || !counts) continue;
    const FrameShare& share = e->client.share;
    if (e->shown) e->shown(e->client, (e->frame - 1) % lap);
    e->times[measured++] = share.measured_ns / (double(settings.width) * settings.height);
    point->m += double(share.device_rows) / settings.height / frame_count;
    point->device_pixels += double(share.device_pixels) / frame_count;
    point->prepared += double(e->client.frame.prepared) / frame_count;
    point->bytes += double(share.bytes_in + share.bytes_out) / frame_count;
    point->row_bytes += double(share.row_bytes) / frame_count;
    point->by_effect += double(share.by_effect) / frame_count;
    point->light_bytes += double(share.light_bytes) / frame_count;
    point->kept_rows += double(share.kept_rows) / frame_count;
    point->kept_bytes += double(share.kept_bytes) / frame_count;
    point->row_count += double(settings.height - share.device_rows) / frame_count;
    for (std::uint32_t i = 0; i < e->setup.server_count; ++i)
      point->server_rows[i] += double(share.server_rows[i]) / frame_count;
    if (whole)
      send_picture(
          whole, merged_row(e->client, 0),
          row_coding(e->client.servers[0].link.ns_per_byte, code_threshold(e->client, e->client.servers[0]), false));
  }
  CHECK(!*complete || measured == frame_count);
  if (*complete) point->ns_per_pixel = range_of(e->times.data(), frame_count).median;
  return success();
}

// Measures a point of the sweep unless it already exists.
Status measure_share(Experiment* e, double m, std::vector<SplitPoint>* sweep, bool* complete) {
  CHECK(m >= 0 && m <= 1);
  double height = e->client.settings.height, row = std::floor(m * height + 0.5);
  for (const SplitPoint& point : *sweep)
    if (std::floor(point.m * height + 0.5) == row) return success();
  e->client.options.device_share = m;
  e->client.options.device_goes_on = false;
  SplitPoint point;
  RETURN_IF_ERROR(measure_point(e, 1, &point, complete, nullptr));
  if (!*complete) return success();
  sweep->push_back(point);
  std::sort(sweep->begin(), sweep->end(), [](const SplitPoint& a, const SplitPoint& b) { return a.m < b.m; });
  return success();
}

std::size_t least_of(const std::vector<SplitPoint>& sweep) {
  CHECK(!sweep.empty());
  auto faster = [](const SplitPoint& a, const SplitPoint& b) { return a.ns_per_pixel < b.ns_per_pixel; };
  return static_cast<std::size_t>(std::min_element(sweep.begin(), sweep.end(), faster) - sweep.begin());
}

using Shown = std::function<void(const Client& client, std::uint32_t step)>;

// Measures frames shared in another way, in a world of their own. `shown` may be null.
Status measure_kind(const SplitSetup& setup, const LightOptions& light, std::uint32_t lap_count, const Shown& shown,
                    std::uint64_t* frames_done, Progress* progress, SplitPoint* point, bool* complete) {
  const Settings kept = setup.device->settings;
  Status status;
  SplitPoint measured;
  {
    Experiment e;
    status = open_experiment(setup, light, progress, frames_done, &e);
    if (status.ok) status = settle(&e, complete);
    e.shown = shown;
    if (status.ok && *complete) status = measure_point(&e, lap_count, &measured, complete, nullptr);
  }
  if (status.ok && *complete) *point = measured;
  const Status back = change_settings(setup.device, kept);  // the client has chosen the device's indirect light
  return status.ok ? back : status;
}

// Frames of the path as the device alone shows them, encoded for ꟻLIP.
struct LightFrames {
  OutputFormat output;
  std::uint32_t width, height;
  std::vector<std::vector<float>> steps;
};

double flip_of(const LightFrames& frames, std::uint32_t step, const std::uint8_t* pixels) {
  CHECK_LT(step, frames.steps.size());
  const Levels levels = unpacked_levels(pixels, frames.width, frames.height, frames.output.format);
  return mean_of(
      flip_errors(frames.steps[step], encoded_levels(levels), frames.width, frames.height, kHandheldPixelsPerDegree));
}

// Renders the path on the device alone: with the settings' light into *frames, and with its own light, whose mean
// distance from these *own_flip receives.
Status render_path(const SplitSetup& setup, std::uint64_t* frames_done, Progress* progress, LightFrames* frames,
                   double* own_flip, bool* complete) {
  Renderer* device = setup.device;
  const Settings kept = device->settings;
  frames->output = kOutputFormats[find_output_format(setup.format == WireFormat::rgb565 ? "rgb565" : "rgb888")];
  frames->width = kept.width, frames->height = kept.height;
  const CameraControl path = make_camera_control(device->view.camera, device->accel.built.bounds);
  Settings own = kept;
  own.indirect = own_indirect(device->scene);
  Status status;
  *own_flip = 0;
  for (const Settings& settings : {kept, own}) {
    if (status.ok) status = change_settings(device, settings);
    for (std::uint32_t step = 0; status.ok && *complete && step < kSkippedFrames + setup.frame_count; ++step) {
      double seconds;
      status = aim(path, setup, step, &seconds);
      if (status.ok) status = render_frame(device, seconds, Aov::none, &interrupted);
      *complete = !interrupted;
      if (!status.ok || !*complete) break;
      show_progress(progress, ++*frames_done);
      const std::vector<std::uint8_t> pixels =
          packed_pixels(device->image.data, frames->width, frames->height, display_of(*device), frames->output);
      if (settings.indirect == kept.indirect)
        frames->steps.push_back(
            encoded_levels(unpacked_levels(pixels.data(), frames->width, frames->height, frames->output.format)));
      else if (step >= kSkippedFrames)
        *own_flip += flip_of(*frames, step, pixels.data()) / setup.frame_count;
    }
  }
  device->view.camera = path.home;
  const Status back = change_settings(device, kept);
  return status.ok ? back : status;
}

Status measure_paper_row(const SplitSetup& given, double* bytes_per_pixel, std::uint64_t* frames_done,
                         Progress* progress, PaperRow* row, bool* complete) {
  CHECK_GT(*bytes_per_pixel, 0);
  SplitSetup setup = given;
  setup.server_count = 1;
  setup.device_ns = row->device_ns, setup.server_ns = row->server_ns;
  setup.decode = setup.encode = CodeCost();               // the paper's times include its own,
  setup.device_prepare_ns = setup.server_prepare_ns = 0;  // and nothing moves there
  setup.line.latency_ns = setup.line.jitter_ns = 0;
  SplitPoint point;
  // The first run finds the compressed size of the rows.
  for (int run = 0; run < kPaperRuns && *complete; ++run) {
    setup.line.bytes_per_second = static_cast<std::uint64_t>(*bytes_per_pixel * 1e9 / kPaperTransferNs);
    Experiment e;
    RETURN_IF_ERROR(open_experiment(setup, SplitKind::rows, progress, frames_done, &e));
    RETURN_IF_ERROR(settle(&e, complete));
    if (*complete) RETURN_IF_ERROR(measure_point(&e, 1, &point, complete, nullptr));
    if (point.row_count > 0) *bytes_per_pixel = point.row_bytes / (point.row_count * e.client.settings.width);
  }
  if (!*complete) return success();
  row->our_share = point.m, row->our_ns = point.ns_per_pixel, row->bytes_per_pixel = *bytes_per_pixel;
  row->bound_ns = overlapped_split({row->device_ns, row->server_ns, kPaperTransferNs}).ns_per_pixel;
  return success();
}

}  // namespace

std::uint64_t split_frame_count(const SplitSetup& setup, std::uint32_t step_count) {
  std::uint64_t lap = kSkippedFrames + setup.frame_count;
  return 4 + (2 + kChosenLaps) * lap + (step_count + 2 * kRefinements) * 2 * lap;
}

std::uint64_t effect_frame_count(const SplitSetup& setup) {
  return 2 * (4 + (2 + kChosenLaps) * std::uint64_t(kSkippedFrames + setup.frame_count));
}

std::uint64_t paper_frame_count(const SplitSetup& setup) {
  return kPaperRows * kPaperRuns * (4 + 3 * std::uint64_t(kSkippedFrames + setup.frame_count));
}

Status measure_split(const SplitSetup& setup, std::uint32_t step_count, Progress* progress, SplitFigures* figures) {
  CHECK_GE(step_count, 2u);
  Experiment e;
  std::uint64_t frames_done = 0;
  bool complete;
  RETURN_IF_ERROR(open_experiment(setup, SplitKind::rows, progress, &frames_done, &e));
  RETURN_IF_ERROR(settle(&e, &complete));
  RowStreams whole;
  open_row_streams({e.client.settings.width, e.client.settings.height,
                    std::min(kChunkRowsMax, e.client.settings.height), setup.format},
                   &whole);
  if (complete) RETURN_IF_ERROR(measure_point(&e, kChosenLaps, &figures->chosen, &complete, &whole));
  if (whole.picture_count > 1) {
    const double changes = whole.picture_count - 1;
    figures->whole_bytes = whole.first.bytes / whole.picture_count;
    figures->lossless_bytes = whole.lossless.bytes / changes, figures->near_bytes = whole.near.bytes / changes;
    figures->near_error = std::sqrt(whole.near.squares / changes);
  }
  // 1. The ends first, so that they exist for comparison after an interrupt.
  std::vector<SplitPoint>* sweep = &figures->sweep;
  if (complete) RETURN_IF_ERROR(measure_share(&e, 1, sweep, &complete));
  if (complete) figures->local = sweep->back();
  for (std::uint32_t i = 0; complete && i < step_count; ++i)
    RETURN_IF_ERROR(measure_share(&e, double(i) / (step_count - 1), sweep, &complete));
  // 2. Repeatedly halve the distance to the neighbours of the minimum.
  for (int i = 0; complete && i < kRefinements; ++i) {
    std::size_t least = least_of(*sweep);
    double m = (*sweep)[least].m, before = least > 0 ? (*sweep)[least - 1].m : m,
           after = least + 1 < sweep->size() ? (*sweep)[least + 1].m : m;
    RETURN_IF_ERROR(measure_share(&e, (before + m) / 2, sweep, &complete));
    if (complete) RETURN_IF_ERROR(measure_share(&e, (m + after) / 2, sweep, &complete));
  }
  if (!sweep->empty()) figures->best = (*sweep)[least_of(*sweep)];
  return success();
}

Status measure_effects(const SplitSetup& setup, Progress* progress, SplitFigures* figures) {
  CHECK_GT(setup.own_light_ns, 0);
  std::uint64_t frames_done = 0;
  bool complete = true;
  LightOptions light;
  light.split = SplitKind::effect;
  RETURN_IF_ERROR(
      measure_kind(setup, light, kChosenLaps, nullptr, &frames_done, progress, &figures->effect, &complete));
  if (!complete) return success();
  light.split = SplitKind::automatic;
  return measure_kind(setup, light, kChosenLaps, nullptr, &frames_done, progress, &figures->both, &complete);
}

std::uint64_t light_frame_count(const SplitSetup& setup) {
  const std::uint64_t lap = kSkippedFrames + setup.frame_count;
  return std::size(kLightEvery) * (4 + 3 * lap) + 2 * lap;
}

Status measure_light(const SplitSetup& setup, Progress* progress, SplitFigures* figures) {
  CHECK_GT(setup.own_light_ns, 0);
  std::uint64_t frames_done = 0;
  bool complete = true;
  LightFrames frames;
  LightMapPoint own;
  own.ns_per_pixel = setup.own_light_ns;
  RETURN_IF_ERROR(render_path(setup, &frames_done, progress, &frames, &own.flip, &complete));
  if (complete) figures->light.push_back(own);
  for (std::uint32_t every : kLightEvery) {
    if (!complete) break;
    LightOptions light;
    light.split = SplitKind::effect, light.every = every;
    LightMapPoint point;
    point.every = every;
    SplitPoint measured;
    const Shown shown = [&](const Client& client, std::uint32_t step) {
      point.flip += flip_of(frames, step, merged_row(client, 0)) / setup.frame_count;
    };
    RETURN_IF_ERROR(measure_kind(setup, light, 1, shown, &frames_done, progress, &measured, &complete));
    point.ns_per_pixel = measured.ns_per_pixel, point.light_bytes = measured.light_bytes;
    if (complete) figures->light.push_back(point);
  }
  return success();
}

Status measure_paper(const SplitSetup& setup, Progress* progress, SplitFigures* figures) {
  // Table 1: times per pixel in ns (T_s for the given number of server cores, T_m of the tablet), the client's share m
  // and the resulting time.
  const PaperRow rows[kPaperRows] = {
      {"Cornell box", 2, 989, 8841, 0.1358, 1200}, {"Cornell box", 4, 585, 8841, 0.1002, 886},
      {"Cornell box", 8, 325, 8841, 0.0758, 669},  {"Buddha", 2, 520, 6688, 0.1209, 809},
      {"Buddha", 4, 390, 6688, 0.1056, 706},       {"Buddha", 8, 208, 6688, 0.0833, 557}};
  const WholeFrames whole(setup.device);  // the paper's times are for all rows
  double bytes_per_pixel = 0.8;
  std::uint64_t frames_done = 0;
  bool complete = true;
  for (PaperRow row : rows) {
    RETURN_IF_ERROR(measure_paper_row(setup, &bytes_per_pixel, &frames_done, progress, &row, &complete));
    if (!complete) break;
    figures->paper.push_back(row);
  }
  return success();
}

}  // namespace pocketray
