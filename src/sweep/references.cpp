#include "sweep/references.h"

#include <algorithm>
#include <cmath>

#include "accuracy/display.h"
#include "base/check.h"
#include "effect/setting_list.h"
#include "engine/frame.h"

namespace pocketray {
namespace {

// FLIP of half a difference to that of the whole: its exponent for colours [Andersson20, sec. 4.1, q_c].
constexpr double kFlipExponent = 0.7;

constexpr std::uint32_t kModelSamples = 2048, kPhysicalSamples = 256;

const char* name_of(Transport transport) { return transport == Transport::model ? "model" : "physical"; }

Status prepare(const AccuracyOptions& options, Rig* rig) {
  RETURN_IF_ERROR(change_settings(&rig->opened.renderer, reference_settings(rig->baseline.settings)));
  return prepare_frame(&rig->opened.renderer, options.seconds);
}

void compare(const Rig& rig, double pixels_per_degree, const std::vector<Vec3>& one, const std::vector<Vec3>& other,
             ReferencePictures* p) {
  const Renderer& renderer = rig.opened.renderer;
  std::uint32_t width = renderer.settings.width, height = renderer.settings.height;
  CHECK_EQ(one.size(), std::size_t(width) * height);
  CHECK_EQ(other.size(), one.size());
  std::vector<Vec3> mean(one.size());
  for (std::size_t i = 0; i < one.size(); ++i) mean[i] = one[i] * 0.5f + other[i] * 0.5f;
  p->one = exposed_light(one.data(), one.size(), renderer.exposure);
  p->other = exposed_light(other.data(), other.size(), renderer.exposure);
  p->mean = exposed_light(mean.data(), mean.size(), renderer.exposure);
  p->encoded = encoded_light(p->mean);
  p->levels =
      displayed_levels(mean.data(), width, height, renderer.exposure, kOutputFormats[find_output_format("rgb888")]);
  p->rmse = reference_error(p->one, p->other);
  p->flip = std::pow(0.5, kFlipExponent) *
            mean_of(flip_errors(encoded_light(p->one), encoded_light(p->other), width, height, pixels_per_degree));
}

}  // namespace

std::uint32_t reference_samples(const AccuracyOptions& options, Transport transport) {
  std::uint32_t usual = transport == Transport::model ? kModelSamples : kPhysicalSamples;
  if (options.reference_samples == 0) return usual;
  return options.reference == name_of(transport) ? options.reference_samples
                                                 : std::min(usual, options.reference_samples);
}

namespace {

// Saves the finished rows of an unfinished picture to its file. The file may hold rows the state does not list yet.
Status save_begun(const AccuracyOptions& options, const Settings& settings, const std::vector<Vec3>& picture,
                  const AccuracyState& state) {
  CHECK_EQ(state.begun_rows.size(), settings.height);
  CHECK_EQ(picture.size(), std::size_t(settings.width) * settings.height);
  std::vector<Vec3> there(picture.size(), Vec3{0, 0, 0});  // without rows that other threads are writing
  std::ptrdiff_t width = settings.width;
  for (std::ptrdiff_t row = 0; row < static_cast<std::ptrdiff_t>(settings.height); ++row)
    if (state.begun_rows[static_cast<std::size_t>(row)] == '1')
      std::copy_n(picture.begin() + row * width, width, there.begin() + row * width);
  RETURN_IF_ERROR(save_radiance(options.folder, state.begun, settings.width, settings.height, there));
  return save_state(options.folder, state);
}

// Lists the rows of a picture still to be traced and reads the others.
Status resume(const AccuracyOptions& options, const Settings& settings, const std::string& name, AccuracyState* state,
              std::vector<Vec3>* picture, std::vector<std::uint32_t>* rows) {
  picture->assign(std::size_t(settings.width) * settings.height, Vec3{0, 0, 0});
  bool ours = state->begun == name && state->begun_rows.size() == settings.height;
  if (ours && state->begun_rows.find('1') != std::string::npos)
    RETURN_IF_ERROR(load_radiance(options.folder, name, settings.width, settings.height, picture));
  if (!ours) state->begun = name, state->begun_rows.assign(settings.height, '0');
  for (std::uint32_t row = 0; row < settings.height; ++row)
    if (state->begun_rows[row] != '1') rows->push_back(row);
  return success();
}

// Renders a picture, or the rest of it, saving it now and then. Each path depends only on seed, pixel and index, so
// rows come out the same whenever they are traced.
Status render_seed(const AccuracyOptions& options, const ReferenceOptions& o, const std::string& stage,
                   const std::string& name, const Rig& rig, AccuracyState* state, std::vector<Vec3>* picture,
                   bool* whole) {
  const Settings& settings = rig.opened.renderer.settings;
  std::vector<std::uint32_t> rows;
  RETURN_IF_ERROR(resume(options, settings, name, state, picture, &rows));
  Progress progress = start_progress(stage.c_str(), rows.size());
  std::uint64_t done = 0, saved_ns = clock_ns();
  auto row_done = [&](std::uint32_t row) {
    state->begun_rows[row] = '1';
    show_progress(&progress, ++done);
    if (options.row_done) options.row_done(row);
    if (static_cast<double>(clock_ns() - saved_ns) < options.save_seconds * 1e9) return;
    // If saving fails, the next save tries again, at the latest the final one.
    if (save_begun(options, settings, *picture, *state).ok) saved_ns = clock_ns();
  };
  auto trace_row = [&](std::uint32_t row, Vec3d* means) { trace_reference(rig.reference, o, row, row + 1, means); };
  *whole = trace_rows(rig.opened.renderer, rows, trace_row, row_done, picture->data());
  end_progress(&progress);
  if (!*whole) return save_begun(options, settings, *picture, *state);
  RETURN_IF_ERROR(save_radiance(options.folder, name, settings.width, settings.height, *picture));
  state->references.push_back(name);
  state->begun.clear(), state->begun_rows.clear();
  return save_state(options.folder, *state);
}

}  // namespace

Status render_reference(const AccuracyOptions& options, Transport transport, Rig* rig, AccuracyState* state,
                        ReferencePictures* pictures, bool* whole) {
  const Settings& settings = rig->opened.renderer.settings;
  CHECK(state != nullptr && pictures != nullptr);
  std::vector<Vec3> seeds[2];
  *whole = true;
  for (int i = 0; i < 2; ++i) {
    std::string name = std::string("reference-") + name_of(transport) + "-" + std::to_string(i + 1);
    if (std::find(state->references.begin(), state->references.end(), name) != state->references.end()) {
      RETURN_IF_ERROR(load_radiance(options.folder, name, settings.width, settings.height, &seeds[i]));
      continue;
    }
    RETURN_IF_ERROR(prepare(options, rig));
    make_rig_reference(rig);
    ReferenceOptions o;
    o.transport = transport;
    o.samples_per_pixel = std::max(1u, reference_samples(options, transport) / 2);
    o.seed = static_cast<std::uint64_t>(i) + 1;
    std::string stage = std::string(name_of(transport)) + " reference, " + std::to_string(i + 1) + " of 2";
    RETURN_IF_ERROR(render_seed(options, o, stage, name, *rig, state, &seeds[i], whole));
    if (!*whole) return success();
  }
  compare(*rig, options.pixels_per_degree, seeds[0], seeds[1], pictures);
  return success();
}

}  // namespace pocketray
