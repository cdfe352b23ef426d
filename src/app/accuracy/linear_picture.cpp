#include "app/accuracy/linear_picture.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <limits>

#include "base/check.h"
#include "base/color.h"
#include "base/limit_list.h"
#include "session/exr.h"

namespace pocketray {
namespace {

// A PFM's header: "PF" or "Pf", width, height and scale, each after white space; one such character ends it.
struct PfmHeader {
  std::size_t channel_count = 0, width = 0, height = 0, byte_count = 0;
  double scale = 0;  // negative: values are little-endian
};

// Reads the word that begins at or after *at; empty at the end, or if it is longer than any number needs to be.
std::string read_word(const std::uint8_t* bytes, std::size_t byte_count, std::size_t* at) {
  constexpr std::size_t kLengthMax = 40;
  while (*at < byte_count && std::isspace(bytes[*at])) ++*at;
  const std::size_t begin = *at;
  while (*at < byte_count && !std::isspace(bytes[*at]) && *at - begin <= kLengthMax) ++*at;
  return *at - begin > kLengthMax ? "" : std::string(bytes + begin, bytes + *at);
}

// Returns the number, or 0 if the word is not one in 1 … limit.
std::size_t size_of_word(const std::string& word, std::size_t limit) {
  std::size_t number = 0;
  for (char c : word) {
    if (c < '0' || c > '9') return 0;
    number = 10 * number + static_cast<std::size_t>(c - '0');
    if (number > limit) return 0;
  }
  return number;
}

// Returns the number, or 0 if the word is not one, or not finite.
double scale_of_word(const std::string& word) {
  char* end = nullptr;
  const double number = std::strtod(word.c_str(), &end);
  return word.empty() || *end != 0 || !std::isfinite(number) ? 0 : number;
}

Status read_header(const std::uint8_t* bytes, std::size_t byte_count, std::size_t pixel_count_max,
                   const std::string& name, PfmHeader* header) {
  CHECK(is_pfm(bytes, byte_count));
  std::size_t at = 2;
  header->channel_count = bytes[1] == 'F' ? 3 : 1;
  header->width = size_of_word(read_word(bytes, byte_count, &at), pixel_count_max);
  header->height = size_of_word(read_word(bytes, byte_count, &at), pixel_count_max);
  if (header->width == 0 || header->height == 0 || header->width > pixel_count_max / header->height)
    return failure("%.300s is not a PFM of 1 to %zu pixels: write it again, or scale it down", name.c_str(),
                   pixel_count_max);
  header->scale = scale_of_word(read_word(bytes, byte_count, &at));
  if (header->scale == 0)
    return failure("%.300s has no scale in its PFM header, a number other than 0: write it again", name.c_str());
  header->byte_count = at + 1;
  return success();
}

float value_at(const std::uint8_t* bytes, bool is_little_endian) {
  std::uint32_t bits = 0;
  for (int i = 0; i < 4; ++i) bits |= std::uint32_t(bytes[i]) << 8 * (is_little_endian ? i : 3 - i);
  float value;
  std::memcpy(&value, &bits, sizeof value);
  return value;
}

// Values beyond a float's range become infinite.
float to_float(double value) {
  using Limits = std::numeric_limits<float>;
  return std::fabs(value) > static_cast<double>(Limits::max()) ? Limits::infinity() : static_cast<float>(value);
}

Status check_finite(const LinearPicture& picture, const std::string& name) {
  CHECK_EQ(picture.radiance.size(), std::size_t{picture.width} * picture.height);
  for (std::size_t i = 0; i < picture.radiance.size(); ++i)
    for (int c = 0; c < 3; ++c)
      if (!std::isfinite(picture.radiance[i][c]))
        return failure("%.300s has a value that is %s, in column %zu of row %zu: write it again without", name.c_str(),
                       std::isnan(picture.radiance[i][c]) ? "NaN" : "infinite", i % picture.width, i / picture.width);
  return success();
}

}  // namespace

bool is_pfm(const std::uint8_t* bytes, std::size_t byte_count) {
  return byte_count > 2 && bytes[0] == 'P' && (bytes[1] == 'F' || bytes[1] == 'f') && std::isspace(bytes[2]);
}

bool is_exr(const std::uint8_t* bytes, std::size_t byte_count) {
  return byte_count >= 4 && std::memcmp(bytes, "\x76\x2f\x31\x01", 4) == 0;
}

Status decode_pfm(const std::uint8_t* bytes, std::size_t byte_count, std::size_t pixel_count_max,
                  const std::string& name, LinearPicture* picture) {
  CHECK(picture != nullptr);
  PfmHeader header;
  RETURN_IF_ERROR(read_header(bytes, byte_count, pixel_count_max, name, &header));
  const std::size_t pixel_bytes = sizeof(float) * header.channel_count, pixel_count = header.width * header.height;
  if (header.byte_count > byte_count || (byte_count - header.byte_count) / pixel_bytes < pixel_count)
    return failure("%.300s is truncated: write it again", name.c_str());
  picture->width = static_cast<std::uint32_t>(header.width);
  picture->height = static_cast<std::uint32_t>(header.height);
  picture->radiance.resize(pixel_count);
  const std::uint8_t* in = bytes + header.byte_count;
  const double scale = std::fabs(header.scale);
  for (std::size_t row = header.height; row-- > 0;)  // the bottom row comes first
    for (std::size_t column = 0; column < header.width; ++column, in += pixel_bytes)
      for (std::size_t c = 0; c < 3; ++c) {
        const double value = static_cast<double>(value_at(in + 4 * (c % header.channel_count), header.scale < 0));
        picture->radiance[row * header.width + column][static_cast<int>(c)] = to_float(scale * value);
      }
  return check_finite(*picture, name);
}

Status decode_linear_exr(const std::uint8_t* bytes, std::size_t byte_count, std::size_t pixel_count_max,
                         const std::string& name, LinearPicture* picture) {
  CHECK(picture != nullptr);
  if (!has_exr())
    return failure("%.300s is an OpenEXR picture, which this build cannot read: convert it to .pfm", name.c_str());
  Status status = decode_exr(bytes, byte_count, pixel_count_max, &picture->width, &picture->height, &picture->radiance);
  if (!status.ok) return failure("%.300s %.190s", name.c_str(), status.message);
  return check_finite(*picture, name);
}

double exposure_to_middle_grey(const LinearPicture& picture) {
  constexpr double kGrey = 0.18;  // the key of [Reinhard et al. 2002] sec. 3
  double log_sum = 0, lit_count = 0;
  for (const Vec3& radiance : picture.radiance) {
    const double bright = static_cast<double>(luminance(radiance));
    if (bright > 0 && std::isfinite(bright)) log_sum += std::log(bright), ++lit_count;
  }
  const LimitRow& limit = limit_of(Quantity::exposure);
  const double measured = lit_count > 0 ? kGrey / std::exp(log_sum / lit_count) : 1;
  return std::min(std::max(measured, limit.low), limit.high);
}

double aligned_scale(const std::vector<double>& reference, const std::vector<double>& test) {
  CHECK_EQ(reference.size(), test.size());
  double products = 0, squares = 0;  // of d/ds Σ (s·test − reference)² = 0
  for (std::size_t i = 0; i < test.size(); ++i) products += reference[i] * test[i], squares += test[i] * test[i];
  const double scale = products / squares;
  return products > 0 && squares > 0 && std::isfinite(scale) ? scale : 0;
}

}  // namespace pocketray
