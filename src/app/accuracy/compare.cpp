#include "app/accuracy/compare.h"

#include <algorithm>
#include <cctype>

#include "base/check.h"
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

}  // namespace

Status read_picture(const std::string& path, Levels* picture) {
  CHECK(picture != nullptr);
  FileBytes loaded;
  platform::FileError error;
  if (!platform::load_file(path.c_str(), &loaded.file, &error)) return failure("%.300s %s", path.c_str(), error.text);
  if (begins_with(loaded.file, "P6")) return read_ppm(loaded.file, path.c_str(), picture);
#ifdef POCKETRAY_HAVE_IMPORT
  if (begins_with(loaded.file, "\x89PNG\r\n\x1a\n") || begins_with(loaded.file, "\xff\xd8\xff"))
    return read_compressed(loaded.file, path, picture);
  return failure("%.300s is not a PNG, JPEG or binary PPM picture: convert it", path.c_str());
#else
  return failure("%.300s is not a binary PPM picture, and this build reads no other: convert it", path.c_str());
#endif
}

Comparison compare_pictures(const Levels& reference, const Levels& test, double pixels_per_degree) {
  CHECK_EQ(reference.width, test.width);
  CHECK_EQ(reference.height, test.height);
  CHECK_EQ(reference.rgb.size(), test.rgb.size());
  Comparison result;
  result.flip_map = flip_errors(encoded_levels(reference), encoded_levels(test), reference.width, reference.height,
                                pixels_per_degree);
  result.flip = mean_of(result.flip_map);
  result.flip_max = static_cast<double>(*std::max_element(result.flip_map.begin(), result.flip_map.end()));
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

}  // namespace pocketray
