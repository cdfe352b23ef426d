#include "desktop/accuracy/display.h"

#include <algorithm>
#include <cmath>

#include "base/check.h"

namespace pocketray {

Vec3d displayed_light(const Vec3& radiance, double exposure, Tone tone) {
  Vec3d light = to_double(radiance) * exposure;
  const double most = max_component(light);
  if (tone == Tone::film && most > static_cast<double>(kShoulder) && std::isfinite(most)) {
    const double room = 1 - static_cast<double>(kShoulder), shown = 1 - room * room / (most - 1 + 2 * room);
    const double white = 1 - 1 / (static_cast<double>(kFading) * (most - shown) + 1);
    light = light * (shown / most) * (1 - white) + Vec3d{shown, shown, shown} * white;
  }
  for (int c = 0; c < 3; ++c) light[c] = !(light[c] > 0) ? 0 : std::min(light[c], 1.0);
  return light;
}

std::vector<double> displayed_light(const Vec3* radiance, std::size_t pixel_count, const Display& display) {
  CHECK(radiance != nullptr || pixel_count == 0);
  CHECK_GT(display.exposure, 0);
  std::vector<double> light;
  light.reserve(3 * pixel_count);
  for (std::size_t i = 0; i < pixel_count; ++i) {
    const Vec3d shown = displayed_light(radiance[i], static_cast<double>(display.exposure), display.tone);
    light.insert(light.end(), {shown.x, shown.y, shown.z});
  }
  return light;
}

std::vector<float> encoded_light(const std::vector<double>& light) {
  std::vector<float> encoded(light.size());
  for (std::size_t i = 0; i < light.size(); ++i)  // IEC 61966-2-1
    encoded[i] =
        static_cast<float>(light[i] <= 0.0031308 ? 12.92 * light[i] : 1.055 * std::pow(light[i], 1 / 2.4) - 0.055);
  return encoded;
}

std::vector<std::uint8_t> packed_pixels(const Vec3* radiance, std::uint32_t width, std::uint32_t height,
                                        const Display& display, const OutputFormat& output) {
  const int line_bytes = static_cast<int>(width) * output.format.bits_per_pixel / 8, rows = static_cast<int>(height);
  std::vector<std::uint8_t> pixels(static_cast<std::size_t>(line_bytes) * height);  // from the heap: aligned
  pack_rows(radiance, static_cast<int>(width), rows, 0, rows, display, output.format, Rotation::none, output.dither,
            pixels.data(), line_bytes);
  return pixels;
}

Levels unpacked_levels(const std::uint8_t* pixels, std::uint32_t width, std::uint32_t height,
                       const PixelFormat& format) {
  CHECK(pixels != nullptr && pixel_format_valid(format));
  const std::size_t bytes = static_cast<std::size_t>(format.bits_per_pixel / 8), count = std::size_t(width) * height;
  Levels levels = {width, height, {}};
  levels.rgb.reserve(3 * count);
  for (std::size_t i = 0; i < count; ++i) {
    int shown[3];
    unpack_levels(format, read_pixel(format, pixels + i * bytes), shown);
    for (int level : shown) levels.rgb.push_back(static_cast<std::uint8_t>(level));
  }
  CHECK_EQ(levels.rgb.size(), 3 * count);
  return levels;
}

Levels displayed_levels(const Vec3* radiance, std::uint32_t width, std::uint32_t height, const Display& display,
                        const OutputFormat& output) {
  return unpacked_levels(packed_pixels(radiance, width, height, display, output).data(), width, height, output.format);
}

std::vector<float> encoded_levels(const Levels& levels) {
  std::vector<float> encoded;
  encoded.reserve(levels.rgb.size());
  for (std::uint8_t level : levels.rgb) encoded.push_back(static_cast<float>(level) / 255);
  return encoded;
}

double mean_of(const std::vector<float>& errors) {
  double sum = 0;
  for (float e : errors) sum += static_cast<double>(e);
  return errors.empty() ? 0 : sum / static_cast<double>(errors.size());
}

}  // namespace pocketray
