// Quantities that reach the renderer in several ways: command line, library, scene file, message. Each has one range,
// in this table, and every way checks it with within(): all accept equal values, and none lets in a NaN or an
// infinity.
#pragma once
#include "base/fmath.h"
#include "base/limits.h"
#include "base/status.h"

namespace pocketray {

enum class Quantity : int {
  width,
  height,
  samples,
  edge_samples,
  depth,
  area_light_points,
  virtual_lights,
  environment_shadows,
  cut_off,
  contrast,
  light_tolerance,
  texture_side,
  camera_index,
  seconds,
  frame_rate,
  exposure,
  coordinate,
  field_of_view,
  vertical_extent,
  price,
};

struct LimitRow {
  Quantity quantity;
  const char* name;
  double low, high;  // inclusive; representable as float where the quantity is stored as float
};

// Beyond 60 stops of exposure every float becomes black or white; the largest exposure times kRadianceMax is still
// finite. Beyond 31 years of time a float of seconds has steps of minutes, too coarse for frames.
constexpr float kExposureMin = 0x1p-60f, kExposureMax = 0x1p60f;
constexpr float kExposureStopsMax = 60;
constexpr double kSecondsMax = 1e9;
constexpr float kFrameRateMin = 1e-3f;
constexpr float kFieldOfViewMin = static_cast<float>(radians(0.001)),
                kFieldOfViewMax = static_cast<float>(radians(179));
constexpr float kVerticalExtentMin = 0x1p-126f;  // the smallest normal float
constexpr std::uint16_t kPriceUnit = 256;        // the price of a server without other clients

constexpr LimitRow kLimitList[] = {
    {Quantity::width, "the picture's width", 1, kImageSideMax},
    {Quantity::height, "the picture's height", 1, kImageSideMax},
    {Quantity::samples, "the number of samples per pixel", 1, kSampleCountMax},
    {Quantity::edge_samples, "the number of samples added at edges", 0, kSampleCountMax},
    {Quantity::depth, "the depth of reflections and refractions", 0, kRayDepthMax},
    {Quantity::area_light_points, "the number of points per area light", 1, kPointsPerAreaLightMax},
    {Quantity::virtual_lights, "the number of virtual lights", 1, kVirtualLightMax},
    {Quantity::environment_shadows, "the number of directions of shadows from the environment", 0,
     kEnvironmentLightMax},
    {Quantity::cut_off, "the cut-off in display levels", 0, double(kCutOffLevelsMax)},
    {Quantity::contrast, "the contrast up to which pixels are interpolated", 0, 1},
    {Quantity::light_tolerance, "the share of light that needs no shadow rays", 0, 1},
    {Quantity::texture_side, "the longest side of textures", 1, kTextureSideMax},
    {Quantity::camera_index, "the camera's index", 0, kCameraCountMax - 1},
    {Quantity::seconds, "the time in seconds", -kSecondsMax, kSecondsMax},
    {Quantity::frame_rate, "the number of frames per second", double(kFrameRateMin), double(kFrameRateMax)},
    {Quantity::exposure, "the exposure", double(kExposureMin), double(kExposureMax)},
    {Quantity::coordinate, "a coordinate", -double(kCoordinateMax), double(kCoordinateMax)},
    {Quantity::field_of_view, "the vertical field of view in radians", double(kFieldOfViewMin),
     double(kFieldOfViewMax)},
    {Quantity::vertical_extent, "the height that an orthographic camera sees", double(kVerticalExtentMin),
     double(kCoordinateMax)},
    {Quantity::price, "the price of a server's time in 256ths", kPriceUnit, UINT16_MAX},
};
constexpr int kLimitCount = sizeof kLimitList / sizeof kLimitList[0];

constexpr const LimitRow& limit_of(Quantity quantity) { return kLimitList[static_cast<int>(quantity)]; }
constexpr bool limits_in_order() {
  for (int i = 0; i < kLimitCount; ++i)
    if (static_cast<int>(kLimitList[i].quantity) != i) return false;
  return kLimitCount == static_cast<int>(Quantity::price) + 1;
}
static_assert(limits_in_order(), "one row for each quantity, in their order");

constexpr bool within(Quantity quantity, double x) {  // false for NaN
  return x >= limit_of(quantity).low && x <= limit_of(quantity).high;
}
constexpr bool within(Quantity quantity, float x) { return within(quantity, static_cast<double>(x)); }

// "the time in seconds is nan: it must lie in -1e+09 … 1e+09". `name`, such as an option's, replaces the table's name.
inline Status check_limit(Quantity quantity, double x, const char* name = nullptr) {
  if (within(quantity, x)) return success();
  const LimitRow& row = limit_of(quantity);
  return failure("%s is %.10g: it must lie in %.6g … %.6g", name ? name : row.name, x, row.low, row.high);
}

}  // namespace pocketray
