#include "plan/framing.h"

#include <algorithm>

#include "base/check.h"
#include "base/limits.h"

namespace pocketray {
namespace {

constexpr double kAngleStep = kPi / 2 / (kReachAngles - 1);

// Axes of a picture that is seen from the unit direction `backward`.
void picture_axes(const Vec3& backward, Vec3* right, Vec3* up) {
  CHECK(right != nullptr && up != nullptr);
  *right = normalize(cross(Vec3{0, 1, 0}, backward));
  if (is_zero(*right))
    make_basis(backward, right, up);
  else
    *up = cross(backward, *right);
}

// Returns an upper bound, within a hundredth of the scene's size, on the maximum of ±x + kz: a support function is
// sublinear, so its value in a direction between two others is at most their combination.
double reach_at(const float (&reach)[kReachAngles], double k) {
  std::uint32_t i = 0;
  while (i + 2 < kReachAngles && det_sin((i + 1) * kAngleStep) < k * det_cos((i + 1) * kAngleStep)) ++i;
  const double low = i * kAngleStep, high = (i + 1) * kAngleStep;
  const double of_low = det_sin(high) - k * det_cos(high), of_high = k * det_cos(low) - det_sin(low);
  return (of_low * static_cast<double>(reach[i]) + of_high * static_cast<double>(reach[i + 1])) / det_sin(kAngleStep);
}

// Least distance of the eye along the view axis, and its shift across.
struct Fit {
  double distance, shift;
};
Fit fit(const float (&positive)[kReachAngles], const float (&negative)[kReachAngles], double k) {
  CHECK_GE(k, 0);
  const double p = reach_at(positive, k), n = reach_at(negative, k);
  return {(p + n) / (2 * k), (p - n) / 2};
}

// Shift that centres the projection at a distance of at least the fit's: that of the slope at which the scene would fit
// tightly.
double centered_shift(const float (&positive)[kReachAngles], const float (&negative)[kReachAngles], double k,
                      double distance) {
  double low = 0, high = k;
  for (int i = 0; i < 30; ++i) {
    const double middle = (low + high) / 2;
    (fit(positive, negative, middle).distance > distance ? low : high) = middle;
  }
  return fit(positive, negative, high).shift;
}

Vec3 within_coordinates(const Vec3& p) {
  return max(min(p, Vec3{kCoordinateMax, kCoordinateMax, kCoordinateMax}),
             Vec3{-kCoordinateMax, -kCoordinateMax, -kCoordinateMax});
}

}  // namespace

ReachMeter::ReachMeter(const Vec3& middle, const Vec3& backward) : middle_(middle), backward_(backward) {
  CHECK(!is_zero(backward));
  picture_axes(backward, &right_, &up_);
  for (std::uint32_t i = 0; i < kReachAngles; ++i) {
    cosine_[i] = static_cast<float>(det_cos(i * kAngleStep)), sine_[i] = static_cast<float>(det_sin(i * kAngleStep));
    for (auto& side : reach_) side[i] = -__builtin_inff();
  }
}

void ReachMeter::add(const Vec3& point) {
  const Vec3 p = point - middle_;
  const float x = dot(p, right_), y = dot(p, up_), z = dot(p, backward_);
  const float across[kReachSides] = {x, -x, y, -y};
  for (std::uint32_t side = 0; side < kReachSides; ++side)
    for (std::uint32_t i = 0; i < kReachAngles; ++i) {
      const float reach = across[side] * cosine_[i] + z * sine_[i];
      reach_[side][i] = reach > reach_[side][i] ? reach : reach_[side][i];
    }
}

Framing ReachMeter::framing() const {
  Framing framing;
  framing.backward = backward_;
  const bool is_empty = !(reach_[0][0] > -__builtin_inff());
  for (std::uint32_t side = 0; side < kReachSides; ++side)
    for (std::uint32_t i = 0; i < kReachAngles; ++i) framing.reach[side][i] = is_empty ? 0 : reach_[side][i];
  return framing;
}

Camera framing_camera(const Framing& framing, const Box& bounds, float aspect, double vertical_fov) {
  CHECK_GT(aspect, 0);
  const Vec3& backward = framing.backward;
  CHECK(!is_zero(backward));
  Camera camera;
  if (is_empty(bounds)) return camera;
  camera.vertical_fov = static_cast<float>(vertical_fov);
  Vec3 right, up;
  picture_axes(backward, &right, &up);
  if (is_zero(cross(camera.up, backward))) camera.up = up;
  const auto& reach = framing.reach;
  const double tall = static_cast<double>(kFramingFill) * det_sin(vertical_fov / 2) / det_cos(vertical_fov / 2),
               wide = tall * static_cast<double>(aspect);
  const Fit across = fit(reach[0], reach[1], wide), along = fit(reach[2], reach[3], tall);
  // Points on the view axis fit however near the eye is: keeps it in front of them.
  const double clear =
      static_cast<double>(reach[0][kReachAngles - 1]) + 0.002 * static_cast<double>(length(extent(bounds)));
  double distance = std::max({across.distance, along.distance, clear});
  const double x = centered_shift(reach[0], reach[1], wide, distance),
               y = centered_shift(reach[2], reach[3], tall, distance);
  camera.target = center(bounds) + right * static_cast<float>(x) + up * static_cast<float>(y);
  if (!(distance > 0)) distance = static_cast<double>(max_component(abs(camera.target)));
  if (!(distance > 0)) distance = 1;
  camera.eye = within_coordinates(camera.target + backward * static_cast<float>(distance));
  camera.target = within_coordinates(camera.target);
  return camera;
}

Camera framing_camera(const Box& bounds, float aspect, const Vec3& backward, double vertical_fov) {
  ReachMeter meter(is_empty(bounds) ? Vec3{0, 0, 0} : center(bounds), backward);
  for (int corner = 0; corner < 8; ++corner)
    meter.add({corner & 1 ? bounds.high.x : bounds.low.x, corner & 2 ? bounds.high.y : bounds.low.y,
               corner & 4 ? bounds.high.z : bounds.low.z});
  return framing_camera(meter.framing(), bounds, aspect, vertical_fov);
}

}  // namespace pocketray
