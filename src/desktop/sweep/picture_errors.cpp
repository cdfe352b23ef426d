#include "desktop/sweep/picture_errors.h"

#include <algorithm>
#include <cmath>

#include "base/check.h"
#include "desktop/accuracy/claim.h"
#include "desktop/accuracy/display.h"
#include "session/interrupt.h"
#ifdef POCKETRAY_HAVE_NETWORK
#include "desktop/sweep/network/sent_frames.h"
#endif

namespace pocketray {

Status find_levels(const AccuracyOptions& options, Rig* rig, const Configuration& configuration, Levels* levels,
                   double* bytes_per_frame) {
  const Renderer& renderer = rig->opened.renderer;
  *levels = displayed_levels(renderer.image.data, renderer.settings.width, renderer.settings.height,
                             display_of(renderer), kOutputFormats[configuration.output]);
#ifdef POCKETRAY_HAVE_NETWORK
  if (!bytes_per_frame && !configuration.near_lossless) return success();
  SentPicture sent;
  RETURN_IF_ERROR(send_frames(rig, configuration, options.seconds, &sent));
  CHECK(interrupted || configuration.near_lossless || sent.levels.rgb == levels->rgb);
  *levels = std::move(sent.levels);
  if (bytes_per_frame) *bytes_per_frame = sent.bytes_per_frame;
#else
  CHECK(!configuration.near_lossless);  // there is no such knob
  (void)options, (void)bytes_per_frame;
#endif
  return success();
}

Distance distance_of(const ReferencePictures& reference, const std::vector<float>& shown, std::uint32_t width,
                     std::uint32_t height, double ppd, double* noise) {
  const std::vector<float> against_one = flip_errors(reference.encoded_one, shown, width, height, ppd);
  const std::vector<float> against_other = flip_errors(reference.encoded_other, shown, width, height, ppd);
  const double against_mean = mean_of(flip_errors(reference.encoded, shown, width, height, ppd));
  Distance d;
  d.flip = without_noise(against_mean, mean_of(against_one), mean_of(against_other));
  d.one = block_means(against_one, width, height), d.other = block_means(against_other, width, height);
  *noise = against_mean - d.flip;
  return d;
}

Status find_errors(const AccuracyOptions& options, const Judges& judges, bool counts_bytes,
                   const Configuration& configuration, Rig* rig, PointFigures* f) {
  const Renderer& renderer = rig->opened.renderer;
  std::uint32_t width = renderer.settings.width, height = renderer.settings.height;
  Levels levels;
  RETURN_IF_ERROR(find_levels(options, rig, configuration, &levels, counts_bytes ? &f->bytes_per_frame : nullptr));
  if (interrupted) return success();
  std::vector<double> light = displayed_light(renderer.image.data, renderer.image.count, display_of(renderer));
  CHECK_EQ(light.size(), judges.model.mean.size());
  const double ppd = options.pixels_per_degree;
  const auto shown = encoded_levels(levels);
  double noise = 0;
  f->truth = distance_of(judges.truth, shown, width, height, ppd, &noise);
  for (int i = 0; i < kOutputFormatCount; ++i) {
    double* flip = &f->flip_as[static_cast<std::size_t>(i)];
    *flip = f->truth.flip;
    if (i == configuration.output) continue;
    const Levels as = displayed_levels(renderer.image.data, width, height, display_of(renderer), kOutputFormats[i]);
    *flip = mean_of(flip_errors(judges.truth.encoded, encoded_levels(as), width, height, ppd));
    *flip = std::max(*flip - noise, 0.0);
  }
  f->model = distance_of(judges.model, shown, width, height, ppd, &noise);
  f->flip_before = mean_of(flip_errors(judges.model.encoded, encoded_light(light), width, height, ppd));
  f->errors = picture_errors(judges.model.mean, light);
  f->errors.rmse = unbiased_rmse(judges.model.one, judges.model.other, light);
  f->errors.psnr = f->errors.rmse > 0 ? -20 * std::log10(f->errors.rmse) : std::numeric_limits<double>::infinity();
  f->has_errors = true;
  return success();
}

}  // namespace pocketray
