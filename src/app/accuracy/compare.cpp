#include "app/accuracy/compare.h"

#include <algorithm>
#include <cctype>
#include <cmath>

#include "base/check.h"
#include "base/color.h"
#include "base/limit_list.h"
#include "desktop/accuracy/display.h"
#include "desktop/accuracy/flip.h"
#include "platform/file.h"
#ifdef POCKETRAY_HAVE_IMPORT
#include "desktop/import/image.h"
#endif

namespace pocketray {
namespace {

struct FileBytes {
  platform::LoadedFile file;
  ~FileBytes() { platform::unload_file(&file); }
};

bool begins_with(const platform::LoadedFile& file, const std::string& signature) {
  return file.byte_count >= signature.size() &&
         std::equal(signature.begin(), signature.end(), file.bytes,
                    [](char c, std::uint8_t b) { return static_cast<std::uint8_t>(c) == b; });
}

// Reads the next number of a PPM's header, after white space and comments; 0 if there is none, or it is too large.
std::size_t read_header_number(const platform::LoadedFile& file, std::size_t* at) {
  bool comment = false;
  for (; *at < file.byte_count && (comment || std::isspace(file.bytes[*at]) || file.bytes[*at] == '#'); ++*at)
    comment = file.bytes[*at] == '#' || (comment && file.bytes[*at] != '\n');
  std::size_t number = 0;
  for (; *at < file.byte_count && std::isdigit(file.bytes[*at]); ++*at) {
    number = 10 * number + static_cast<std::size_t>(file.bytes[*at] - '0');
    if (number > kComparedPixelsMax) return 0;
  }
  return number;
}

Status read_ppm(const platform::LoadedFile& file, const char* path, Levels* picture) {
  std::size_t at = 2, size[3];
  for (std::size_t& number : size) number = read_header_number(file, &at);
  const std::size_t width = size[0], height = size[1];
  if (width == 0 || height == 0 || width > kComparedPixelsMax / height || size[2] != 255)
    return failure("%.300s is not a PPM of 8 bits and at most 4096×4096 pixels: convert it or scale it down", path);
  ++at;  // one white-space character ends the header
  const std::size_t byte_count = 3 * width * height;
  if (at > file.byte_count || file.byte_count - at < byte_count)
    return failure("%.300s is truncated: write it again", path);
  picture->width = static_cast<std::uint32_t>(width), picture->height = static_cast<std::uint32_t>(height);
  picture->rgb.assign(file.bytes + at, file.bytes + at + byte_count);
  return success();
}

#ifdef POCKETRAY_HAVE_IMPORT
Status read_compressed(const platform::LoadedFile& file, const std::string& path, Levels* picture) {
  Image image;
  RETURN_IF_ERROR(read_image({file.bytes, file.bytes + file.byte_count}, path, kComparedPixelsMax, &image));
  picture->width = image.width, picture->height = image.height;
  picture->rgb.clear();
  const std::uint8_t* texels = reinterpret_cast<const std::uint8_t*>(image.texels.data());
  for (std::size_t i = 0; i < image.texels.size(); ++i)
    picture->rgb.insert(picture->rgb.end(), texels + 4 * i, texels + 4 * i + 3);
  return success();
}
#endif

void compare_displayed(const std::vector<float>& reference, const std::vector<float>& test, std::uint32_t width,
                       std::uint32_t height, double pixels_per_degree, Comparison* result) {
  result->flip_map = flip_errors(reference, test, width, height, pixels_per_degree);
  result->flip = mean_of(result->flip_map);
  result->flip_max = static_cast<double>(*std::max_element(result->flip_map.begin(), result->flip_map.end()));
}

std::vector<double> values_of(const LinearPicture& picture) {
  std::vector<double> values;
  values.reserve(3 * picture.radiance.size());
  for (const Vec3& radiance : picture.radiance)
    for (int c = 0; c < 3; ++c) values.push_back(static_cast<double>(radiance[c]));
  return values;
}

double exposure_of(const Development& development, const LinearPicture& light) {
  return development.measured ? exposure_to_middle_grey(light) : development.exposure;
}

// Sum of squared differences of displayed light from levels, both linear, of every `step`th pixel.
double displayed_squares(const std::vector<double>& shown, const std::vector<Vec3>& radiance, double exposure,
                         Tone tone, std::size_t step) {
  CHECK_GT(step, 0u);
  double sum = 0;
  for (std::size_t i = 0; i < radiance.size(); i += step) {
    const Vec3d light = displayed_light(radiance[i], exposure, tone);
    for (int c = 0; c < 3; ++c) {
      const double difference = light[c] - shown[3 * i + static_cast<std::size_t>(c)];
      sum += difference * difference;
    }
  }
  return sum;
}

// The exposure at which displayed light is closest to the levels, in linear light; 0 if none is closer than black. A
// scan finds the valley, since the sum has flat parts where all light is black or white.
double exposure_of_levels(const Levels& levels, const LinearPicture& light, Tone tone) {
  std::vector<double> shown;
  for (std::uint8_t level : levels.rgb) shown.push_back(static_cast<double>(srgb_to_linear(level)));
  const std::vector<Vec3>& radiance = light.radiance;
  constexpr std::size_t kScannedPixels = 1 << 15;
  constexpr double kScanStops = 0.25, kRefinedStops = 1e-5, kGolden = 0.6180339887498949;
  const std::size_t step = 1 + radiance.size() / kScannedPixels;
  double best = 0, least = displayed_squares(shown, radiance, 0, tone, step);
  for (double stops = -kExposureStopsMax; stops <= kExposureStopsMax; stops += kScanStops) {
    const double squares = displayed_squares(shown, radiance, std::exp2(stops), tone, step);
    if (squares < least) least = squares, best = std::exp2(stops);
  }
  if (best == 0) return 0;
  double low = std::log2(best) - kScanStops, high = std::log2(best) + kScanStops;
  while (high - low > kRefinedStops) {
    const double one = high - kGolden * (high - low), other = low + kGolden * (high - low);
    const bool lower = displayed_squares(shown, radiance, std::exp2(one), tone, 1) <
                       displayed_squares(shown, radiance, std::exp2(other), tone, 1);
    (lower ? high : low) = lower ? other : one;
  }
  return std::exp2(0.5 * (low + high));
}

// An exposure must be usable as a float.
Status check_exposure(double exposure) {
  const LimitRow& limit = limit_of(Quantity::exposure);
  if (exposure >= limit.low && exposure <= limit.high) return success();
  if (exposure == 0) return failure("--align finds no scale: the pictures have no light in common; drop it");
  return failure("the pictures would be exposed by %g, beyond 60 stops: drop --align, or give other stops", exposure);
}

Status compare_light(const LinearPicture& reference, const LinearPicture& test, const Development& development,
                     double pixels_per_degree, Comparison* c) {
  const std::vector<double> a = values_of(reference);
  std::vector<double> b = values_of(test);
  *c = Comparison();
  c->are_linear = c->has_exposure = true;
  c->exposure = exposure_of(development, reference);
  if (development.aligned) {
    c->scale = aligned_scale(a, b);
    RETURN_IF_ERROR(check_exposure(c->scale));
    for (double& value : b) value *= c->scale;
  }
  RETURN_IF_ERROR(check_exposure(c->exposure));
  RETURN_IF_ERROR(check_exposure(c->exposure * c->scale));
  c->light = picture_errors(a, b);
  for (std::size_t i = 0; i < a.size(); i += 3)
    if (!std::equal(&a[i], &a[i] + 3, &b[i])) ++c->differing_count;
  auto encoded = [&](const LinearPicture& picture, double exposure) {
    return encoded_light(displayed_light(picture.radiance.data(), picture.radiance.size(),
                                         {static_cast<float>(exposure), development.tone}));
  };
  const std::vector<float> shown = encoded(reference, c->exposure), judged = encoded(test, c->exposure * c->scale);
  compare_displayed(shown, judged, reference.width, reference.height, pixels_per_degree, c);
  c->errors = picture_errors({shown.begin(), shown.end()}, {judged.begin(), judged.end()});
  return success();
}

}  // namespace

Status read_picture(const std::string& path, AnyPicture* picture) {
  CHECK(picture != nullptr);
  FileBytes loaded;
  platform::FileError error;
  if (!platform::load_file(path.c_str(), &loaded.file, &error)) return failure("%.300s %s", path.c_str(), error.text);
  const std::uint8_t* bytes = loaded.file.bytes;
  const std::size_t byte_count = loaded.file.byte_count;
  *picture = AnyPicture();
  picture->is_linear = is_pfm(bytes, byte_count) || is_exr(bytes, byte_count);
  if (is_pfm(bytes, byte_count)) return decode_pfm(bytes, byte_count, kComparedPixelsMax, path, &picture->light);
  if (is_exr(bytes, byte_count)) return decode_linear_exr(bytes, byte_count, kComparedPixelsMax, path, &picture->light);
  if (begins_with(loaded.file, "P6")) return read_ppm(loaded.file, path.c_str(), &picture->levels);
#ifdef POCKETRAY_HAVE_IMPORT
  if (begins_with(loaded.file, "\x89PNG\r\n\x1a\n") || begins_with(loaded.file, "\xff\xd8\xff"))
    return read_compressed(loaded.file, path, &picture->levels);
  return failure("%.300s is not a PNG, JPEG, binary PPM, PFM or OpenEXR picture: convert it", path.c_str());
#else
  return failure("%.300s is not a binary PPM or PFM picture, and this build reads no other: convert it", path.c_str());
#endif
}

Comparison compare_levels(const Levels& reference, const Levels& test, double pixels_per_degree) {
  CHECK_EQ(reference.width, test.width);
  CHECK_EQ(reference.height, test.height);
  CHECK_EQ(reference.rgb.size(), test.rgb.size());
  Comparison result;
  compare_displayed(encoded_levels(reference), encoded_levels(test), reference.width, reference.height,
                    pixels_per_degree, &result);
  auto values = [](const Levels& levels) {
    std::vector<double> list;
    list.reserve(levels.rgb.size());
    for (std::uint8_t level : levels.rgb) list.push_back(level / 255.0);
    return list;
  };
  result.errors = picture_errors(values(reference), values(test));
  for (std::size_t i = 0; i < reference.rgb.size(); i += 3)
    if (!std::equal(&reference.rgb[i], &reference.rgb[i] + 3, &test.rgb[i])) ++result.differing_count;
  return result;
}

Status compare_pictures(const AnyPicture& reference, const AnyPicture& test, const Development& development,
                        double pixels_per_degree, Comparison* comparison) {
  CHECK(comparison != nullptr);
  CHECK_EQ(reference.width(), test.width());
  CHECK_EQ(reference.height(), test.height());
  if (reference.is_linear && test.is_linear)
    return compare_light(reference.light, test.light, development, pixels_per_degree, comparison);
  if (!reference.is_linear && !test.is_linear) {
    *comparison = compare_levels(reference.levels, test.levels, pixels_per_degree);
    return success();
  }
  const LinearPicture& light = reference.is_linear ? reference.light : test.light;
  const Levels& levels = reference.is_linear ? test.levels : reference.levels;
  double exposure = exposure_of(development, light);
  if (development.aligned) exposure = exposure_of_levels(levels, light, development.tone);
  RETURN_IF_ERROR(check_exposure(exposure));
  const Levels shown =
      displayed_levels(light.radiance.data(), light.width, light.height,
                       {static_cast<float>(exposure), development.tone}, kOutputFormats[find_output_format("rgb888")]);
  *comparison = reference.is_linear ? compare_levels(shown, levels, pixels_per_degree)
                                    : compare_levels(levels, shown, pixels_per_degree);
  comparison->has_exposure = true, comparison->exposure = exposure;
  return success();
}

}  // namespace pocketray
