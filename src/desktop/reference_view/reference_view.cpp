#include "desktop/reference_view/reference_view.h"

#include <algorithm>
#include <vector>

#include "base/check.h"
#include "base/limits.h"
#include "base/seal.h"
#include "desktop/accuracy/display.h"
#include "desktop/accuracy/flip.h"
#include "desktop/reference/reference.h"
#include "effect/setting_list.h"
#include "engine/frame.h"

namespace pocketray {
namespace {

// Per seed. Chosen: if a pixel's samples deviate by as much as display white, the mean of both seeds has noise of 1.4
// levels of 256; four times as many samples would halve it.
constexpr std::uint32_t kSamplesMax = 1u << 14;
constexpr std::uint32_t kSeedCount = 2;  // their difference estimates the reference's own error

bool is_same(const Vec3& a, const Vec3& b) { return a.x == b.x && a.y == b.y && a.z == b.z; }
bool is_same(const Camera& a, const Camera& b) {
  return is_same(a.eye, b.eye) && is_same(a.target, b.target) && is_same(a.up, b.up) &&
         a.vertical_fov == b.vertical_fov && a.vertical_extent == b.vertical_extent && a.projection == b.projection;
}

struct Errors {
  std::uint32_t picture = 0, samples = 0;  // picture and sample count at the last measurement; no samples: not measured
  double flip = 0, rmse = 0, reference_rmse = 0;
};

struct ReferenceView : SideBySide {
  std::string name;  // the reference's
  int output = 0;    // index into kOutputFormats; the picture is judged in this format
  ReferenceOptions reference_options;
  FrameData frame;  // with the scene's own textures and normals, whatever the picture's settings
  Reference reference;
  bool aimed = false;
  Camera camera;
  double seconds = 0;
  std::uint32_t width = 0, height = 0;
  std::uint32_t samples = 0, row = 0;  // per pixel; earlier rows have one more
  Errors errors;
  std::vector<LightPoint> lights;
  std::vector<std::uint8_t> memory;                // the reference's
  std::vector<Vec3d> sums[kSeedCount], row_light;  // row_light: one row per thread
  std::vector<Vec3> shown;
};

ReferenceView* view_of(SideBySide* side_by_side) { return static_cast<ReferenceView*>(side_by_side); }
const ReferenceView& view_of(const SideBySide& side_by_side) { return static_cast<const ReferenceView&>(side_by_side); }

void forget(ReferenceView* view) {
  view->samples = view->row = 0;
  view->errors = Errors();
}

// Prepares a frame with all effects and settings as the scene defines them.
Status prepare_reference(ReferenceView* view, Renderer* renderer, double seconds) {
  const Settings before = renderer->settings;
  RETURN_IF_ERROR(change_settings(renderer, reference_settings(before)));
  Status status = begin_frame(renderer, {seconds});
  if (status.ok) {
    view->frame = renderer->frame;
    view->lights.assign(renderer->frame.lights.points.begin(), renderer->frame.lights.points.end());
    view->frame.lights.points = {view->lights.data(), static_cast<std::uint32_t>(view->lights.size())};
  }
  Status restored = change_settings(renderer, before);
  return status.ok ? restored : status;
}

// Gives the reference the picture's view and time; rebuilds it if geometry may have moved.
Status aim(ReferenceView* view, Renderer* renderer, double seconds) {
  SealPause pause;
  bool stands = view->aimed && view->seconds == seconds;
  if (stands && is_same(view->camera, renderer->view.camera)) return success();
  view->aimed = false;
  RETURN_IF_ERROR(prepare_reference(view, renderer, seconds));
  if (!stands) {
    Arena arena = make_arena("reference", view->memory.data(), view->memory.size());
    view->reference = make_reference(view->frame, &arena,
                                     view->reference_options.transport == Transport::physical ? kGuidePathCount : 0);
  }
  view->camera = renderer->view.camera, view->seconds = seconds, view->aimed = true;
  forget(view);
  return success();
}

struct Pass {
  ReferenceView* view;
  std::uint64_t deadline_ns;
};

bool take_row(void* context, std::uint32_t thread, std::uint32_t row) {
  const Pass& pass = *static_cast<Pass*>(context);
  ReferenceView* view = pass.view;
  ReferenceOptions o = view->reference_options;
  o.samples_per_pixel = 1;
  o.first_sample = view->samples;
  Vec3d* light = view->row_light.data() + std::size_t(thread) * view->width;
  for (std::uint32_t seed = 0; seed < kSeedCount; ++seed) {
    o.seed = seed + 1;
    trace_reference(view->reference, o, row, row + 1, light);
    Vec3d* sum = view->sums[seed].data() + std::size_t(row) * view->width;
    for (std::uint32_t x = 0; x < view->width; ++x) sum[x] = view->samples == 0 ? light[x] : sum[x] + light[x];
  }
  return clock_ns() < pass.deadline_ns;
}

// Adds one sample per pixel, for as many rows as time allows.
void trace_pass(ReferenceView* view, Workers* workers, std::uint64_t deadline_ns) {
  CHECK_LT(view->row, view->height);
  Pass pass = {view, deadline_ns};
  view->row = share_items(workers, view->row, view->height, take_row, &pass);
  if (view->row < view->height) return;
  view->row = 0;
  ++view->samples;
}

std::vector<Vec3> mean_of_seeds(const ReferenceView& view, std::initializer_list<std::uint32_t> seeds) {
  CHECK_GT(view.samples, 0u);
  CHECK_GT(seeds.size(), 0u);
  double scale = 1.0 / (view.samples * static_cast<double>(seeds.size()));
  std::vector<Vec3> mean(view.shown.size());
  for (std::size_t i = 0; i < mean.size(); ++i) {
    Vec3d sum = {0, 0, 0};
    for (std::uint32_t seed : seeds) sum += view.sums[seed][i];
    sum = sum * scale;
    mean[i] = to_float(sum);
  }
  return mean;
}

// Call when all pixels have equally many samples.
void measure_errors(ReferenceView* view, const Renderer& renderer) {
  SealPause pause;
  std::vector<double> light = displayed_light(renderer.image.data, renderer.image.count, display_of(renderer));
  std::vector<double> seeds[kSeedCount];
  for (std::uint32_t seed = 0; seed < kSeedCount; ++seed)
    seeds[seed] = displayed_light(mean_of_seeds(*view, {seed}).data(), view->shown.size(), display_of(renderer));
  std::vector<double> mean =
      displayed_light(mean_of_seeds(*view, {0, 1}).data(), view->shown.size(), display_of(renderer));
  Levels levels = displayed_levels(renderer.image.data, view->width, view->height, display_of(renderer),
                                   kOutputFormats[view->output]);
  view->errors.flip = mean_of(
      flip_errors(encoded_light(mean), encoded_levels(levels), view->width, view->height, kHandheldPixelsPerDegree));
  view->errors.rmse = unbiased_rmse(seeds[0], seeds[1], light);
  view->errors.reference_rmse = reference_error(seeds[0], seeds[1]);
  view->errors.samples = view->samples;
}

SideBySide* open_view(const SideBySideOptions& options, const Renderer& renderer, int bits_per_pixel, bool dither) {
  ReferenceView* view = new ReferenceView;
  view->backend = &kReferenceView;
  view->name = options.reference;
  view->output = find_output_format(bits_per_pixel > 16 ? "rgb888" : dither ? "rgb565-dithered" : "rgb565");
  view->reference_options.transport = options.reference == "model" ? Transport::model : Transport::physical;
  view->width = renderer.settings.width, view->height = renderer.settings.height;
  std::size_t pixel_count = std::size_t(view->width) * view->height;
  FrameData frame;
  frame.scene = &renderer.scene;
  view->memory.resize(reference_need(frame) + kArenaAlignment);
  for (std::vector<Vec3d>& sum : view->sums) sum.resize(pixel_count);
  view->row_light.resize(std::size_t(view->width) * worker_thread_count(renderer.workers));
  view->shown.resize(pixel_count);
  return view;
}

void close_view(SideBySide* side_by_side) { delete view_of(side_by_side); }

bool is_full(const SideBySide& side_by_side) {
  const ReferenceView& view = view_of(side_by_side);
  return view.aimed && view.samples >= kSamplesMax;
}

Status advance_view(SideBySide* side_by_side, Renderer* renderer, double seconds, std::uint32_t picture,
                    std::uint64_t deadline_ns) {
  ReferenceView* view = view_of(side_by_side);
  RETURN_IF_ERROR(aim(view, renderer, seconds));
  if (view->errors.picture != picture) view->errors = Errors(), view->errors.picture = picture;
  while (!is_full(*view)) {
    trace_pass(view, renderer->workers, deadline_ns);
    bool is_whole = view->row == 0 && view->samples > view->errors.samples;
    if (is_whole && (view->errors.samples == 0 || (view->samples & (view->samples - 1)) == 0))
      measure_errors(view, *renderer);
    if (clock_ns() >= deadline_ns) break;
  }
  return success();
}

void forget_view(SideBySide* side_by_side) { forget(view_of(side_by_side)); }

std::uint32_t sample_count(const SideBySide& side_by_side) { return kSeedCount * view_of(side_by_side).samples; }

const Vec3* picture_beside(SideBySide* side_by_side, const Renderer& renderer) {
  ReferenceView* view = view_of(side_by_side);
  std::uint32_t middle = view->width / 2;
  const float white = 1000 / renderer.view.exposure;  // in every tone
  for (std::uint32_t y = 0; y < view->height; ++y) {
    std::uint32_t samples = view->samples + (y < view->row ? 1 : 0);
    for (std::uint32_t x = 0; x < view->width; ++x) {
      std::size_t i = std::size_t(y) * view->width + x;
      view->shown[i] = renderer.image[i];
      if (x == middle) view->shown[i] = {white, white, white};
      if (x <= middle || samples == 0 || !view->aimed) continue;
      Vec3d mean = (view->sums[0][i] + view->sums[1][i]) / (2.0 * samples);
      view->shown[i] = to_float(mean);
    }
  }
  return view->shown.data();
}

void write_lines(const SideBySide& side_by_side, HudText* text) {
  const ReferenceView& view = view_of(side_by_side);
  add_hud_line(text, "right: %s reference, %u samples per pixel", view.name.c_str(), sample_count(view));
  if (view.errors.samples > 0)
    add_hud_line(text, "FLIP %.4f, RMSE %.4f from it (its own %.4f)", view.errors.flip, view.errors.rmse,
                 view.errors.reference_rmse);
}

void print(const SideBySide& side_by_side) {
  const ReferenceView& view = view_of(side_by_side);
  if (view.errors.samples == 0) return;
  std::printf("  ꟻLIP %.4f, RMSE %.4f from the %s reference of %u samples per pixel, whose own RMSE is %.4f\n",
              view.errors.flip, view.errors.rmse, view.name.c_str(), kSeedCount * view.errors.samples,
              view.errors.reference_rmse);
}

}  // namespace

const SideBySideBackend kReferenceView = {open_view,    close_view,     advance_view, forget_view, is_full,
                                          sample_count, picture_beside, write_lines,  print};

}  // namespace pocketray
