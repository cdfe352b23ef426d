// Radiance pictures: text up to an empty line, the size, then scanlines of RGBE, run-length coded in either of two ways
// [Radiance, doc/filefmts].
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <new>

#include "desktop/import/environment.h"

namespace pocketray {
namespace {

constexpr std::uint32_t kSideMax = 16384;
constexpr std::uint64_t kPixelCountMax = std::uint64_t(1) << 26;

using Rgbe = std::uint8_t[4];

struct Reader {
  const std::uint8_t* at;
  const std::uint8_t* end;
  std::size_t left() const { return static_cast<std::size_t>(end - at); }
  // Reads the next line without its end; returns false at the end of the bytes.
  bool line(std::string* text) {
    if (at == end) return false;
    const auto* stop = static_cast<const std::uint8_t*>(std::memchr(at, '\n', left()));
    if (!stop) return false;
    text->assign(reinterpret_cast<const char*>(at), static_cast<std::size_t>(stop - at));
    if (!text->empty() && text->back() == '\r') text->pop_back();
    at = stop + 1;
    return true;
  }
};

Status read_header(Reader* in, RadiancePicture* picture, double* exposure) {
  std::string text;
  if (!in->line(&text) || text.compare(0, 2, "#?") != 0) return failure("is not a Radiance picture: export it as .hdr");
  for (;;) {
    if (!in->line(&text)) return failure("is cut short in its header: copy it again");
    if (text.empty()) break;
    if (text.compare(0, 7, "FORMAT=") == 0 && text != "FORMAT=32-bit_rle_rgbe")
      return failure("has %.40s: export it as 32-bit_rle_rgbe", text.c_str());
    if (text.compare(0, 9, "EXPOSURE=") == 0) *exposure *= std::strtod(text.c_str() + 9, nullptr);
  }
  if (!(*exposure > 1e-30 && *exposure < 1e30)) return failure("has an exposure out of range: export it again");
  if (!in->line(&text)) return failure("is cut short in its header: copy it again");
  unsigned width, height;
  int used = 0;
  if (std::sscanf(text.c_str(), "-Y %6u +X %6u%n", &height, &width, &used) != 2 ||
      static_cast<std::size_t>(used) != text.size())
    return failure("has the size '%.40s', not '-Y height +X width': export it upright", text.c_str());
  if (width < 1 || height < 1 || width > kSideMax || height > kSideMax ||
      std::uint64_t(width) * height > kPixelCountMax)
    return failure("has %u × %u pixels, more than can be read: scale it down", width, height);
  picture->width = width, picture->height = height;
  return success();
}

// Reads scanlines of 8 … 32767 pixels: each component separately, in runs and literal parts.
bool read_components(Reader* in, std::vector<std::uint8_t>* row, std::uint32_t width) {
  for (std::uint32_t c = 0; c < 4; ++c)
    for (std::uint32_t x = 0; x < width;) {
      if (in->left() < 2) return false;
      const bool is_run = *in->at > 128;
      const std::uint32_t count = is_run ? *in->at - 128u : *in->at;
      ++in->at;
      if (count == 0 || count > width - x || in->left() < (is_run ? 1 : count)) return false;
      for (std::uint32_t i = 0; i < count; ++i) (*row)[4 * (x + i) + c] = in->at[is_run ? 0 : i];
      in->at += is_run ? 1 : count;
      x += count;
    }
  return true;
}

// Reads plain pixels; 1, 1, 1, n repeats the last one n times, and 256 n times after another repetition.
bool read_pixels(Reader* in, std::vector<std::uint8_t>* row, std::uint32_t width) {
  std::uint32_t shift = 0;
  for (std::uint32_t x = 0; x < width;) {
    if (in->left() < 4) return false;
    const std::uint8_t* p = in->at;
    in->at += 4;
    if (p[0] == 1 && p[1] == 1 && p[2] == 1) {
      if (shift > 16) return false;
      const std::uint32_t count = static_cast<std::uint32_t>(p[3]) << shift;
      if (x == 0 || count > width - x) return false;
      for (std::uint32_t i = 0; i < count; ++i) std::memcpy(&(*row)[4 * (x + i)], &(*row)[4 * (x - 1)], 4);
      x += count, shift += 8;
    } else {
      std::memcpy(&(*row)[4 * x], p, 4);
      ++x, shift = 0;
    }
  }
  return true;
}

bool read_row(Reader* in, std::vector<std::uint8_t>* row, std::uint32_t width) {
  const bool by_component = width >= 8 && width <= 32767 && in->left() >= 4 && in->at[0] == 2 && in->at[1] == 2 &&
                            (in->at[2] << 8 | in->at[3]) == static_cast<int>(width);
  if (!by_component) return read_pixels(in, row, width);
  in->at += 4;
  return read_components(in, row, width);
}

}  // namespace

Status decode_radiance(const std::vector<std::uint8_t>& bytes, RadiancePicture* picture) {
  Reader in = {bytes.data(), bytes.data() + bytes.size()};
  double exposure = 1;
  RETURN_IF_ERROR(read_header(&in, picture, &exposure));
  // Pixels are stored as they arrive, so that a short file that claims a large size takes little memory.
  std::vector<std::uint8_t> row(std::size_t(4) * picture->width);
  picture->pixels.clear();
  try {
    for (std::uint32_t y = 0; y < picture->height; ++y) {
      if (!read_row(&in, &row, picture->width))
        return failure("is cut short or damaged in row %u of %u: copy it again", y, picture->height);
      for (std::uint32_t x = 0; x < picture->width; ++x) {
        const std::uint8_t* p = &row[std::size_t(4) * x];
        const double unit = p[3] ? std::ldexp(1 / exposure, p[3] - 136) : 0;
        Vec3 color;
        for (int c = 0; c < 3; ++c) color[c] = static_cast<float>(std::fmin((p[c] + 0.5) * unit, 1e30));
        picture->pixels.push_back(color);
      }
    }
  } catch (const std::bad_alloc&) {
    return failure("has %u × %u pixels, more than there is memory for: scale it down", picture->width, picture->height);
  }
  return success();
}

}  // namespace pocketray
