#include <algorithm>
#include <cmath>

#include "base/fmath.h"
#include "desktop/import/environment.h"

namespace pocketray {
namespace {

constexpr double kUnit = 30;    // kcd/m² at radiance 1
constexpr double kSolar = 128;  // klx of the sun above the atmosphere
constexpr double kGroundAlbedo = 0.2;
constexpr double kHaze = 0.03;       // sine of the angle below the horizon where the ground fades into it
constexpr double kCosineMin = 0.01;  // the model is singular at the horizon, which is read here

struct Perez {
  double a, b, c, d, e;
};

// App. A.2: distribution coefficients of luminance and chromaticity.
Perez luminance_of(double t) {
  return {0.1787 * t - 1.4630, -0.3554 * t + 0.4275, -0.0227 * t + 5.3251, 0.1206 * t - 2.5771, -0.0670 * t + 0.3703};
}
Perez x_of(double t) {
  return {-0.0193 * t - 0.2592, -0.0665 * t + 0.0008, -0.0004 * t + 0.2125, -0.0641 * t - 0.8989, -0.0033 * t + 0.0452};
}
Perez y_of(double t) {
  return {-0.0167 * t - 0.2608, -0.0950 * t + 0.0092, -0.0079 * t + 0.2102, -0.0441 * t - 1.6537, -0.0109 * t + 0.0529};
}

// Eq. 3.
double perez(const Perez& p, double cos_zenith, double gamma, double cos_gamma) {
  return (1 + p.a * det_exp(p.b / cos_zenith)) * (1 + p.c * det_exp(p.d * gamma) + p.e * cos_gamma * cos_gamma);
}

struct Zenith {
  double luminance, x, y;  // kcd/m²
};
// App. A.2; s: the sun's angle from the zenith.
Zenith zenith_of(double t, double s) {
  const double chi = (4.0 / 9 - t / 120) * (kPi - 2 * s), s2 = s * s, s3 = s2 * s;
  Zenith z;
  z.luminance = (4.0453 * t - 4.9710) * det_sin(chi) / det_cos(chi) - 0.2155 * t + 2.4192;
  z.x = t * t * (0.00166 * s3 - 0.00375 * s2 + 0.00209 * s) +
        t * (-0.02903 * s3 + 0.06377 * s2 - 0.03202 * s + 0.00394) +
        (0.11693 * s3 - 0.21196 * s2 + 0.06052 * s + 0.25886);
  z.y = t * t * (0.00275 * s3 - 0.00610 * s2 + 0.00317 * s) +
        t * (-0.04214 * s3 + 0.08970 * s2 - 0.04153 * s + 0.00516) +
        (0.15346 * s3 - 0.26756 * s2 + 0.06670 * s + 0.26688);
  return z;
}

// Chromaticity and luminance to linear sRGB (IEC 61966-2-1), without negative parts.
Vec3d to_rgb(double x, double y, double luminance) {
  const double X = x / y * luminance, Y = luminance, Z = (1 - x - y) / y * luminance;
  return {std::fmax(3.2406 * X - 1.5372 * Y - 0.4986 * Z, 0), std::fmax(-0.9689 * X + 1.8758 * Y + 0.0415 * Z, 0),
          std::fmax(0.0557 * X - 0.2040 * Y + 1.0570 * Z, 0)};
}

// Direction to the sun: to the upper left of the default camera, like the default sun.
Vec3d to_sun(const Sky& sky) {
  const double elevation = radians(sky.elevation), ground = det_cos(elevation), side = std::sqrt(0.5 * 0.5 + 0.6 * 0.6);
  return {-0.5 / side * ground, det_sin(elevation), 0.6 / side * ground};
}

Vec3d above_horizon(const Sky& sky, Vec3d direction) {
  const Vec3d sun = to_sun(sky);
  const double t = sky.turbidity, s = radians(90 - sky.elevation), cos_s = std::fmax(sun.y, kCosineMin);
  const double cos_gamma = std::clamp(dot(direction, sun), -1.0, 1.0), gamma = det_acos(cos_gamma);
  const double cosine = std::fmax(direction.y, kCosineMin);
  const Zenith zenith = zenith_of(t, s);
  auto spread = [&](const Perez& p, double value) {
    return value * perez(p, cosine, gamma, cos_gamma) / perez(p, 1, s, cos_s);
  };
  return to_rgb(spread(x_of(t), zenith.x), spread(y_of(t), zenith.y),
                std::fmax(spread(luminance_of(t), zenith.luminance), 0)) *
         (1 / kUnit);
}

// The sun's irradiance by app. A.1: Rayleigh scattering, aerosols and ozone along the path through the air, at 615, 535
// and 445 nm, which represent red, green and blue.
Vec3d sunlight(const Sky& sky) {
  const double wavelength[3] = {0.615, 0.535, 0.445}, ozone[3] = {11.5, 7.2, 0.3};  // µm, 1/m
  const double mass = 1 / (det_sin(radians(sky.elevation)) + 0.15 / det_exp(1.253 * det_log(sky.elevation + 3.885)));
  const double beta = 0.04608 * sky.turbidity - 0.04586;
  Vec3d sum;
  for (int c = 0; c < 3; ++c) {
    const double log_wavelength = det_log(wavelength[c]);
    const double depth =
        0.008735 * det_exp(-4.08 * log_wavelength) + beta * det_exp(-1.3 * log_wavelength) + ozone[c] * 0.0035;
    sum[c] = kSolar / kUnit * det_exp(-depth * mass);
  }
  return sum;
}

}  // namespace

Vec3d sky_radiance(const Sky& sky, const Vec3d& direction) {
  if (direction.y >= 0) return above_horizon(sky, direction);
  // The ground is lit by this sun and by a sky as bright as at 45° to the sun's side.
  const Vec3d sun = to_sun(sky), aside = {-sun.z, 0, sun.x};
  const double length_aside = std::sqrt(dot(aside, aside));
  const Vec3d high = length_aside > 0 ? aside * (std::sqrt(0.5) / length_aside) : Vec3d{std::sqrt(0.5), 0, 0};
  const Vec3d irradiance = above_horizon(sky, {high.x, std::sqrt(0.5), high.z}) * kPi + sunlight(sky) * sun.y;
  const Vec3d ground = irradiance * (kGroundAlbedo / kPi);
  const double share = -direction.y / kHaze;
  return share < 1 ? above_horizon(sky, normalize(Vec3d{direction.x, 0, direction.z})) * (1 - share) + ground * share
                   : ground;
}

Light sun_of(const Sky& sky) {
  Light light;
  light.kind = LightKind::directional;
  const Vec3d direction = -to_sun(sky), irradiance = sunlight(sky);
  light.direction = to_float(direction);
  light.intensity = to_float(irradiance);
  return light;
}

}  // namespace pocketray
