#include "viewer/side_by_side.h"

#include <algorithm>
#include <vector>

#include "accuracy/display.h"
#include "accuracy/flip.h"
#include "base/limits.h"
#include "base/seal.h"
#include "effect/setting_list.h"
#include "engine/frame.h"
#include "reference/reference.h"

namespace pocketray {
namespace {

constexpr std::uint32_t kSamplesMax = 1u << 14;  // of each seed
constexpr std::uint32_t kSeedCount = 2;          // their difference tells what the reference itself errs by

bool is_same(const Vec3& a, const Vec3& b) { return a.x == b.x && a.y == b.y && a.z == b.z; }
bool is_same(const Camera& a, const Camera& b) {
  return is_same(a.eye, b.eye) && is_same(a.target, b.target) && is_same(a.up, b.up) &&
         a.vertical_fov == b.vertical_fov && a.vertical_extent == b.vertical_extent && a.projection == b.projection;
}

struct Errors {
  std::uint32_t picture = 0, samples = 0;  // of which; no samples: not measured
  double flip = 0, rmse = 0, reference_rmse = 0;
};

}  // namespace

struct SplitScreen {
  std::string name;  // of the reference
  int output = 0;    // of kOutputFormats, by which the picture is judged
  ReferenceOptions reference_options;
  FrameData frame;  // with the scene's own textures and normals, whatever settings the picture has
  Reference reference;
  bool aimed = false;
  Camera camera;
  double seconds = 0;
  std::uint32_t width = 0, height = 0;
  std::uint32_t samples = 0, row = 0;  // of every pixel; rows before this one have one more
  Errors errors;
  std::vector<LightPoint> lights;
  std::vector<std::uint8_t> memory;                // the reference's
  std::vector<Vec3d> sums[kSeedCount], row_light;  // row_light: a row for each thread
  std::vector<Vec3> shown;
};

namespace {

// The frame of a picture with everything as the scene has it.
Status prepare_reference(SplitScreen* s, Renderer* r, double seconds) {
  const Settings before = r->settings;
  RETURN_IF_ERROR(change_settings(r, reference_settings(before)));
  Status status = prepare_frame(r, seconds);
  if (status.ok) {
    s->frame = r->frame;
    s->lights.assign(r->frame.lights.begin(), r->frame.lights.end());
    s->frame.lights = {s->lights.data(), static_cast<std::uint32_t>(s->lights.size())};
  }
  Status restored = change_settings(r, before);
  return status.ok ? restored : status;
}

// Points the reference at what the picture shows; makes it anew where geometry may have moved.
Status aim(SplitScreen* s, Renderer* r, double seconds) {
  SealPause pause;
  bool stands = s->aimed && s->seconds == seconds;
  if (stands && is_same(s->camera, r->camera)) return success();
  s->aimed = false;
  RETURN_IF_ERROR(prepare_reference(s, r, seconds));
  if (!stands) {
    Arena arena = make_arena("reference", s->memory.data(), s->memory.size());
    s->reference =
        make_reference(s->frame, &arena, s->reference_options.transport == Transport::physical ? kGuidePathCount : 0);
  }
  s->camera = r->camera, s->seconds = seconds, s->aimed = true;
  forget_split_screen(s);
  return success();
}

struct RowQueue {
  SplitScreen* split;
  std::uint64_t deadline_ns;
  std::atomic<std::uint32_t> next_row;
};

void take_rows(void* context, std::uint32_t thread) {
  RowQueue* queue = static_cast<RowQueue*>(context);
  SplitScreen* s = queue->split;
  ReferenceOptions o = s->reference_options;
  o.samples_per_pixel = 1;
  o.first_sample = s->samples;
  Vec3d* light = s->row_light.data() + std::size_t(thread) * s->width;
  while (clock_ns() < queue->deadline_ns) {
    std::uint32_t row = queue->next_row++;
    if (row >= s->height) return;
    for (std::uint32_t seed = 0; seed < kSeedCount; ++seed) {
      o.seed = seed + 1;
      trace_reference(s->reference, o, row, row + 1, light);
      Vec3d* sum = s->sums[seed].data() + std::size_t(row) * s->width;
      for (std::uint32_t x = 0; x < s->width; ++x) sum[x] = s->samples == 0 ? light[x] : sum[x] + light[x];
    }
  }
}

// One more sample of each pixel, or of as many rows as there is time for.
void trace_pass(SplitScreen* s, Workers* workers, std::uint64_t deadline_ns) {
  RowQueue queue{s, deadline_ns, {s->row}};
  run_with(workers, take_rows, &queue);
  s->row = std::min<std::uint32_t>(queue.next_row, s->height);
  if (s->row < s->height) return;
  s->row = 0;
  ++s->samples;
}

std::vector<Vec3> mean_of_seeds(const SplitScreen& s, std::initializer_list<std::uint32_t> seeds) {
  double scale = 1.0 / (s.samples * static_cast<double>(seeds.size()));
  std::vector<Vec3> mean(s.shown.size());
  for (std::size_t i = 0; i < mean.size(); ++i) {
    Vec3d sum = {0, 0, 0};
    for (std::uint32_t seed : seeds) sum += s.sums[seed][i];
    sum = sum * scale;
    mean[i] = {static_cast<float>(sum.x), static_cast<float>(sum.y), static_cast<float>(sum.z)};
  }
  return mean;
}

// Where all pixels have the same number of samples.
void measure_errors(SplitScreen* s, const Renderer& r) {
  SealPause pause;
  std::vector<double> light = exposed_light(r.image.data, r.image.count, r.exposure);
  std::vector<double> seeds[kSeedCount];
  for (std::uint32_t seed = 0; seed < kSeedCount; ++seed)
    seeds[seed] = exposed_light(mean_of_seeds(*s, {seed}).data(), s->shown.size(), r.exposure);
  std::vector<double> mean = exposed_light(mean_of_seeds(*s, {0, 1}).data(), s->shown.size(), r.exposure);
  Levels levels = displayed_levels(r.image.data, s->width, s->height, r.exposure, kOutputFormats[s->output]);
  s->errors.flip =
      mean_of(flip_errors(encoded_light(mean), encoded_levels(levels), s->width, s->height, kHandheldPixelsPerDegree));
  s->errors.rmse = unbiased_rmse(seeds[0], seeds[1], light);
  s->errors.reference_rmse = reference_error(seeds[0], seeds[1]);
  s->errors.samples = s->samples;
}

}  // namespace

const char* split_screen_key_help() { return "V shows the reference of --split-screen or not, "; }
const char* split_screen_hint() {
  return "V shows the reference beside the picture: start with --split-screen model to have one";
}

SplitScreen* open_split_screen(const SplitScreenOptions& options, const Renderer& r, int bits_per_pixel, bool dither) {
  if (options.reference.empty()) return nullptr;
  SplitScreen* s = new SplitScreen;
  s->name = options.reference;
  s->output = find_output_format(bits_per_pixel > 16 ? "rgb888" : dither ? "rgb565-dithered" : "rgb565");
  s->reference_options.transport = options.reference == "model" ? Transport::model : Transport::physical;
  s->width = r.settings.width, s->height = r.settings.height;
  std::size_t pixel_count = std::size_t(s->width) * s->height;
  FrameData frame;
  frame.scene = &r.scene;
  s->memory.resize(reference_need(frame) + kArenaAlignment);
  for (std::vector<Vec3d>& sum : s->sums) sum.resize(pixel_count);
  s->row_light.resize(std::size_t(s->width) * worker_thread_count(r.workers));
  s->shown.resize(pixel_count);
  return s;
}

void close_split_screen(SplitScreen* split) { delete split; }

Status advance_split_screen(SplitScreen* s, Renderer* r, double seconds, std::uint32_t picture,
                            std::uint64_t deadline_ns) {
  RETURN_IF_ERROR(aim(s, r, seconds));
  if (s->errors.picture != picture) s->errors = Errors(), s->errors.picture = picture;
  while (!is_split_screen_full(*s)) {
    trace_pass(s, r->workers, deadline_ns);
    bool is_whole = s->row == 0 && s->samples > s->errors.samples;
    if (is_whole && (s->errors.samples == 0 || (s->samples & (s->samples - 1)) == 0)) measure_errors(s, *r);
    if (clock_ns() >= deadline_ns) break;
  }
  return success();
}

void forget_split_screen(SplitScreen* s) {
  s->samples = s->row = 0;
  s->errors = Errors();
}

bool is_split_screen_full(const SplitScreen& s) { return s.aimed && s.samples >= kSamplesMax; }

std::uint32_t split_screen_samples(const SplitScreen& s) { return kSeedCount * s.samples; }

const Vec3* split_picture(SplitScreen* s, const Renderer& r) {
  std::uint32_t middle = s->width / 2;
  float white = 1 / r.exposure;
  for (std::uint32_t y = 0; y < s->height; ++y) {
    std::uint32_t samples = s->samples + (y < s->row ? 1 : 0);
    for (std::uint32_t x = 0; x < s->width; ++x) {
      std::size_t i = std::size_t(y) * s->width + x;
      s->shown[i] = r.image[i];
      if (x == middle) s->shown[i] = {white, white, white};
      if (x <= middle || samples == 0 || !s->aimed) continue;
      Vec3d mean = (s->sums[0][i] + s->sums[1][i]) / (2.0 * samples);
      s->shown[i] = {static_cast<float>(mean.x), static_cast<float>(mean.y), static_cast<float>(mean.z)};
    }
  }
  return s->shown.data();
}

void write_split_lines(const SplitScreen& s, HudText* text) {
  add_hud_line(text, "right: %s reference, %u samples a pixel", s.name.c_str(), split_screen_samples(s));
  if (s.errors.samples > 0)
    add_hud_line(text, "FLIP %.4f, RMSE %.4f from it (itself %.4f)", s.errors.flip, s.errors.rmse,
                 s.errors.reference_rmse);
}

void print_split_screen(const SplitScreen& s) {
  if (s.errors.samples == 0) return;
  std::printf("  ꟻLIP %.4f, RMSE %.4f from the %s reference of %u samples a pixel, which itself errs by RMSE %.4f\n",
              s.errors.flip, s.errors.rmse, s.name.c_str(), kSeedCount * s.errors.samples, s.errors.reference_rmse);
}

}  // namespace pocketray
