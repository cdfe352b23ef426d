// Pictures of a reference, and its own error.
#include <cmath>

#include "base/check.h"
#include "desktop/accuracy/display.h"
#include "desktop/accuracy/errors.h"
#include "desktop/sweep/reference_run.h"

namespace pocketray {
namespace {

// Exponent for colours [Andersson20, sec. 4.1, q_c]: scales ꟻLIP from half a difference to the whole.
constexpr double kFlipExponent = 0.7;
constexpr std::uint32_t kRegionColumns = 8, kRegionRows = 6;

std::vector<float> half_flips(const ReferencePictures& p, std::uint32_t width, std::uint32_t height, double ppd) {
  std::vector<float> flips = flip_errors(p.encoded_one, p.encoded_other, width, height, ppd);
  for (float& flip : flips) flip *= static_cast<float>(std::pow(0.5, kFlipExponent));
  return flips;
}

}  // namespace

void develop(const Accumulation& a, const Display& display, double ppd, ReferencePictures* p) {
  CHECK(p != nullptr && display.exposure > 0);
  std::vector<Vec3> one = mean_of_half(a, 0), other = mean_of_half(a, 1), mean(one.size());
  for (std::size_t i = 0; i < mean.size(); ++i) mean[i] = one[i] * 0.5f + other[i] * 0.5f;
  p->one = displayed_light(one.data(), one.size(), display);
  p->other = displayed_light(other.data(), other.size(), display);
  p->mean = displayed_light(mean.data(), mean.size(), display);
  p->encoded_one = encoded_light(p->one), p->encoded_other = encoded_light(p->other);
  p->encoded = encoded_light(p->mean);
  p->levels = displayed_levels(mean.data(), a.width, a.height, display, kOutputFormats[find_output_format("rgb888")]);
  p->samples = samples_of(a);
  p->rmse = reference_error(p->one, p->other);
  p->flip = mean_of(half_flips(*p, a.width, a.height, ppd));
}

std::vector<RegionError> region_errors(const ReferencePictures& p, std::uint32_t width, std::uint32_t height,
                                       double ppd) {
  CHECK_EQ(p.one.size(), std::size_t(width) * height * 3);
  std::vector<float> flips = half_flips(p, width, height, ppd);
  std::vector<RegionError> regions;
  std::uint32_t columns = std::min(kRegionColumns, width), rows = std::min(kRegionRows, height);
  for (std::uint32_t i = 0; i < rows * columns; ++i) {
    RegionError r = {i % columns * width / columns,
                     i / columns * height / rows,
                     (i % columns + 1) * width / columns,
                     (i / columns + 1) * height / rows,
                     0,
                     0};
    double squares = 0, sum = 0;
    for (std::size_t y = r.row; y < r.row_end; ++y)
      for (std::size_t x = r.column; x < r.column_end; ++x) {
        std::size_t pixel = y * width + x;
        sum += static_cast<double>(flips[pixel]);
        for (std::size_t c = 3 * pixel; c < 3 * pixel + 3; ++c)
          squares += 0.25 * (p.one[c] - p.other[c]) * (p.one[c] - p.other[c]);
      }
    double pixels = static_cast<double>((r.column_end - r.column) * (r.row_end - r.row));
    r.rmse = std::sqrt(squares / (3 * pixels)), r.flip = sum / pixels;
    regions.push_back(r);
  }
  return regions;
}

}  // namespace pocketray
