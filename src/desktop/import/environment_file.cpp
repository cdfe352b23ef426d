// Environments by name: the sky, or an equirectangular picture.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <new>

#include "base/color.h"
#include "base/fmath.h"
#include "base/limits.h"
#include "desktop/import/environment.h"
#include "desktop/import/image.h"
#include "desktop/import/import_error.h"

namespace pocketray {
namespace {

constexpr std::uint32_t kSkySide = 256, kStudioSide = 128, kFileSideMax = 512;
constexpr float kSunRadius = static_cast<float>(radians(0.2665));  // seen from the earth, on average
constexpr std::uint64_t kFileBytesMax = std::uint64_t(1) << 30;

// Reads a number at *at and advances it.
bool read_number(const char** at, double* value) {
  char* end;
  *value = std::strtod(*at, &end);
  if (end == *at || !std::isfinite(*value)) return false;
  *at = end;
  return true;
}

Status parse_sky(const std::string& name, Sky* sky) {
  const char* at = name.c_str() + 3;
  bool ok = true;
  if (*at == ':') {
    ++at, ok = read_number(&at, &sky->elevation);
    if (ok && *at == ',') ++at, ok = read_number(&at, &sky->turbidity);
  }
  if (!ok || *at)
    return failure("--environment is '%.100s': write sky:ELEVATION,TURBIDITY, as sky:30 or sky:30,4", name.c_str());
  if (!(sky->elevation >= 0 && sky->elevation <= 90))
    return failure("the sun's elevation of --environment is %g degrees: it must lie in 0 … 90", sky->elevation);
  if (!(sky->turbidity >= 2 && sky->turbidity <= 10))
    return failure("the turbidity of --environment is %g: it must lie in 2 … 10", sky->turbidity);
  return success();
}

Status read_sky(const std::string& name, ImportedEnvironment* environment) {
  Sky sky;
  RETURN_IF_ERROR(parse_sky(name, &sky));
  environment->lights = {sun_of(sky)};
  environment->suns = {{0, kSunRadius, 2, 0}};
  return make_environment(
      kSkySide, 2, [&](const Vec3d& direction) { return sky_radiance(sky, direction); }, environment);
}

Status make_studio(ImportedEnvironment* environment) {
  environment->is_studio = true;
  return make_environment(kStudioSide, 2, studio_radiance, environment);
}

// Averages 2 × 2 pixels.
RadiancePicture halved(const RadiancePicture& picture) {
  RadiancePicture half;
  half.width = (picture.width + 1) / 2, half.height = (picture.height + 1) / 2;
  for (std::uint32_t y = 0; y < half.height; ++y)
    for (std::uint32_t x = 0; x < half.width; ++x) {
      auto at = [&](std::uint32_t i, std::uint32_t j) {
        const std::uint32_t column = std::min(2 * x + i, picture.width - 1);
        const std::uint32_t row = std::min(2 * y + j, picture.height - 1);
        return picture.pixels[std::size_t(row) * picture.width + column];
      };
      half.pixels.push_back((at(0, 0) + at(1, 0) + at(0, 1) + at(1, 1)) * 0.25f);
    }
  return half;
}

// Bilinear sample of the picture, around the seam and up to the poles.
Vec3d picture_at(const RadiancePicture& picture, const Vec3d& direction) {
  const double across = std::sqrt(direction.x * direction.x + direction.z * direction.z);
  const double turn = across > 0 ? det_acos(-direction.z / across) / (2 * kPi) : 0;
  const double x = (0.5 + (direction.x < 0 ? -turn : turn)) * picture.width - 0.5;
  const double y = std::clamp(det_acos(direction.y) / kPi * picture.height - 0.5, 0.0, picture.height - 1.0);
  const double column = std::floor(x), row = std::floor(y);
  auto at = [&](double i, double j) {
    const auto width = static_cast<std::int64_t>(picture.width);
    const auto wrapped = static_cast<std::size_t>((static_cast<std::int64_t>(i) + width) % width);
    const auto kept = static_cast<std::size_t>(std::fmin(j, picture.height - 1.0));
    return to_double(picture.pixels[kept * picture.width + wrapped]);
  };
  const double s = x - column, t = y - row;
  return (at(column, row) * (1 - s) + at(column + 1, row) * s) * (1 - t) +
         (at(column, row + 1) * (1 - s) + at(column + 1, row + 1) * s) * t;
}

Status read_picture(const std::string& name, RadiancePicture* picture) {
  FilesRead files;
  const Bytes bytes = read_file(name, kFileBytesMax, &files);
  if (bytes.size() >= 2 && bytes[0] == '#' && bytes[1] == '?') {
    const Status status = decode_radiance(bytes, picture);
    return status.ok ? status : failure("%.300s %.200s", name.c_str(), status.message);
  }
  Image image;
  const Status status = read_image(bytes, name, std::size_t(1) << 26, &image);
  if (!status.ok) return failure("%.400s. An environment is a picture (.hdr, .png, .jpg) or sky", status.message);
  picture->width = image.width, picture->height = image.height;
  for (std::uint32_t texel : image.texels)
    picture->pixels.push_back({srgb_to_linear(static_cast<std::uint8_t>(texel)),
                               srgb_to_linear(static_cast<std::uint8_t>(texel >> 8)),
                               srgb_to_linear(static_cast<std::uint8_t>(texel >> 16))});
  return success();
}

}  // namespace

Status read_environment(const std::string& name, ImportedEnvironment* environment) {
  *environment = ImportedEnvironment();
  if (name == "sky" || name.compare(0, 4, "sky:") == 0) return read_sky(name, environment);
  if (name == kStudio) return make_studio(environment);
  environment->file = name;
  try {
    RadiancePicture picture;
    RETURN_IF_ERROR(read_picture(name, &picture));
    // A map of 512² texels has as many along the horizon as a picture 1024 pixels wide, on average.
    std::uint32_t side = 64;
    while (side < kFileSideMax && 2 * side < picture.width) side *= 2;
    while (picture.width > 4 * side) picture = halved(picture);
    const Status status = make_sunny_environment(
        side, 4, [&](const Vec3d& direction) { return picture_at(picture, direction); }, environment);
    return status.ok ? status : failure("%.300s %.200s", name.c_str(), status.message);
  } catch (const std::bad_alloc&) {
    return failure("%.300s: not enough memory to read it; scale it down", name.c_str());
  } catch (const ImportError& error) {
    return failure("%s", error.what());
  }
}

}  // namespace pocketray
