#include "shade/motion_contrast.h"

#include <algorithm>
#include <cmath>

#include "base/check.h"
#include "base/fmath.h"
#include "shade/cell.h"

namespace pocketray {

double retinal_speed(double degrees_per_second) {
  constexpr double kGain = 0.82, kDrift = 0.15, kFastest = 80;  // [Daly98]
  CHECK_GE(degrees_per_second, 0);
  const double eye = std::min(kGain * degrees_per_second + kDrift, kFastest);
  return std::max(degrees_per_second - eye, kDrift);
}

double contrast_sensitivity(double cycles_per_degree, double speed) {
  constexpr double kC0 = 1.14, kC1 = 0.67, kC2 = 1.7, kS1 = 6.1, kS2 = 7.3, kP1 = 45.9;  // [Daly98]
  CHECK(cycles_per_degree > 0 && speed > 0);
  const double tens = std::fabs(det_log(kC2 * speed / 3) / det_log(10));
  const double k = kS1 + kS2 * tens * tens * tens, frequency = 2 * kPi * cycles_per_degree * kC1;
  const double frequency_max = kP1 / (kC2 * speed + 2);
  return k * kC0 * kC2 * speed * frequency * frequency * det_exp(-kC1 * 4 * kPi * cycles_per_degree / frequency_max);
}

void set_motion_tolerance(double pixels_per_degree, double frames_per_second, MotionTolerance* tolerance) {
  CHECK(pixels_per_degree > 0 && frames_per_second > 0);
  const double frequency = pixels_per_degree / (2 * kCellSide);
  const double at_rest = contrast_sensitivity(frequency, retinal_speed(0));
  for (std::uint32_t step = 0; step <= kMotionStepMax; ++step) {
    const double sensitivity =
        contrast_sensitivity(frequency, retinal_speed(step * frames_per_second / pixels_per_degree));
    const bool is_least = !(at_rest < double(kMotionToleranceMax) * sensitivity);
    tolerance->at[step] = is_least ? kMotionToleranceMax : std::max(1.0f, static_cast<float>(at_rest / sensitivity));
  }
}

float motion_tolerance(const FrameData& frame, std::uint32_t column, std::uint32_t row, const Hit& hit) {
  Vec2 step;
  if (!frame.last || !frame.last->is_known || !step_to_last(frame, *frame.last, column, row, hit, &step)) return 1;
  const float moved = std::sqrt(step.x * step.x + step.y * step.y);
  const float* at = frame.last->tolerance->at;
  if (!(moved < static_cast<float>(kMotionStepMax))) return at[kMotionStepMax];
  const auto below = static_cast<std::uint32_t>(moved);
  return at[below] + (at[below + 1] - at[below]) * (moved - static_cast<float>(below));
}

}  // namespace pocketray
