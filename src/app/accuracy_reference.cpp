#include "app/accuracy_reference.h"

#include <algorithm>
#include <cmath>

#include "accuracy/display.h"
#include "app/frame.h"
#include "base/limits.h"

namespace pocketray {
namespace {

// FLIP of half a difference to that of the whole: its exponent for colours [Andersson20, sec. 4.1, q_c].
constexpr double kFlipExponent = 0.7;

constexpr std::uint32_t kModelSamples = 2048, kPhysicalSamples = 256;

const char* name_of(Transport transport) { return transport == Transport::model ? "model" : "physical"; }

// The scene's own textures and normals, whatever the baseline makes of them.
Status prepare(const AccuracyOptions& options, Rig* rig) {
  Settings settings = rig->baseline.settings;
  settings.texture_filter = TextureFilter::as_scene;
  settings.normals = NormalMode::as_scene;
  settings.ray_depth = kRayDepthMax;
  settings.cut_off_levels = 0;
  RETURN_IF_ERROR(change_settings(&rig->opened.renderer, settings));
  return prepare_frame(&rig->opened.renderer, options.seconds);
}

void compare(const Rig& rig, double pixels_per_degree, const std::vector<Vec3>& one, const std::vector<Vec3>& other,
             ReferencePictures* p) {
  const Renderer& r = rig.opened.renderer;
  std::uint32_t width = r.settings.width, height = r.settings.height;
  std::vector<Vec3> mean(one.size());
  for (std::size_t i = 0; i < one.size(); ++i) mean[i] = one[i] * 0.5f + other[i] * 0.5f;
  p->one = exposed_light(one.data(), one.size(), r.exposure);
  p->other = exposed_light(other.data(), other.size(), r.exposure);
  p->mean = exposed_light(mean.data(), mean.size(), r.exposure);
  p->encoded = encoded_light(p->mean);
  p->levels = displayed_levels(mean.data(), width, height, r.exposure, kOutputFormats[find_output_format("rgb888")]);
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

Status render_reference(const AccuracyOptions& options, Transport transport, Rig* rig, AccuracyState* state,
                        ReferencePictures* pictures, bool* whole) {
  const Settings& settings = rig->opened.renderer.settings;
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
    seeds[i].resize(std::size_t(settings.width) * settings.height);
    std::string stage = std::string(name_of(transport)) + " reference, " + std::to_string(i + 1) + " of 2";
    Progress progress = start_progress(stage.c_str(), settings.height);
    *whole = trace_rows(
        settings, [&](std::uint32_t row, Vec3d* means) { trace_reference(rig->reference, o, row, row + 1, means); },
        &progress, seeds[i].data());
    end_progress(&progress);
    if (!*whole) return success();
    RETURN_IF_ERROR(save_radiance(options.folder, name, settings.width, settings.height, seeds[i]));
    state->references.push_back(name);
    RETURN_IF_ERROR(save_state(options.folder, *state));
  }
  compare(*rig, options.pixels_per_degree, seeds[0], seeds[1], pictures);
  return success();
}

}  // namespace pocketray
