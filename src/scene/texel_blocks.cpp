#include "scene/texel_blocks.h"

#include <cstring>

#include "base/check.h"

namespace pocketray {
namespace {

constexpr std::uint32_t kTexels = kBlockSide * kBlockSide;

struct Rgb {
  int c[3];
};

int squared(int x) { return x * x; }

// Endpoints are searched within this part of the range from either end: a few outliers should not spoil the rest.
constexpr int kInset = 8, kInsetSteps = 4;

// Fits the bytes between all pairs of endpoints on a small grid, and keeps the pair of the least squared error.
void encode_plane(const std::uint8_t* values, std::uint32_t* plane) {
  int low = 255, high = 0;
  for (std::uint32_t i = 0; i < kTexels; ++i) {
    low = values[i] < low ? values[i] : low;
    high = values[i] > high ? values[i] : high;
  }
  const int step = (high - low) / (kInset * kInsetSteps) + 1;
  int best = -1;
  for (int a = low; a <= low + (high - low) / kInset; a += step)
    for (int b = high; b >= high - (high - low) / kInset && b >= a; b -= step) {
      const int range = b - a;
      std::uint64_t indices = 0;
      int error = 0;
      for (std::uint32_t i = 0; i < kTexels; ++i) {
        const int off = values[i] < a ? 0 : values[i] > b ? range : values[i] - a;
        const int index = range ? (off * 14 + range) / (2 * range) : 0;
        indices |= std::uint64_t(index) << 3 * i;
        error += squared((a * (7 - index) + b * index + 3) / 7 - values[i]);
      }
      if (best >= 0 && error >= best) continue;
      best = error;
      plane[0] = static_cast<std::uint32_t>(a) | static_cast<std::uint32_t>(b) << 8 |
                 static_cast<std::uint32_t>(indices & 0xFFFF) << 16;
      plane[1] = static_cast<std::uint32_t>(indices >> 16);
    }
}

// Rounds to the nearest colour of 5, 6 and 5 bits.
std::uint32_t rounded_565(const Rgb& color) {
  auto nearest = [](int x, int most) {
    const int level = (x * most + 127) / 255;
    return static_cast<std::uint32_t>(level < 0 ? 0 : level > most ? most : level);
  };
  return nearest(color.c[0], 31) << 11 | nearest(color.c[1], 63) << 5 | nearest(color.c[2], 31);
}

struct ColorFit {
  std::uint32_t first, last, indices;
  int error;
};

// Assigns the nearest of the four colours to each texel.
ColorFit fit_of(const Rgb* texels, std::uint32_t first, std::uint32_t last) {
  Rgb palette[4];
  for (std::uint32_t index = 0; index < 4; ++index) {
    const std::uint32_t block[2] = {first | last << 16, index};
    const std::uint32_t color = color_value(block, 0);
    for (int c = 0; c < 3; ++c) palette[index].c[c] = static_cast<int>(color >> 8 * c & 0xFF);
  }
  ColorFit fit = {first, last, 0, 0};
  for (std::uint32_t i = 0; i < kTexels; ++i) {
    int least = -1;
    std::uint32_t nearest = 0;
    for (std::uint32_t index = 0; index < 4; ++index) {
      int error = 0;
      for (int c = 0; c < 3; ++c) error += squared(palette[index].c[c] - texels[i].c[c]);
      if (least >= 0 && error >= least) continue;
      least = error, nearest = index;
    }
    fit.indices |= nearest << 2 * i;
    fit.error += least;
  }
  return fit;
}

bool keep_better(const ColorFit& other, ColorFit* best) {
  if (other.error >= best->error) return false;
  *best = other;
  return true;
}

// Direction of largest variation: power iteration on 16² times the texels' covariance, kept below 2^12.
Rgb principal_axis(const Rgb* texels) {
  int sum[3] = {0, 0, 0};
  for (std::uint32_t i = 0; i < kTexels; ++i)
    for (int c = 0; c < 3; ++c) sum[c] += texels[i].c[c];
  std::int64_t covariance[3][3] = {};
  for (std::uint32_t i = 0; i < kTexels; ++i)
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b)
        covariance[a][b] += std::int64_t(16 * texels[i].c[a] - sum[a]) * (16 * texels[i].c[b] - sum[b]);
  int widest = 0;
  for (int c = 1; c < 3; ++c)
    if (covariance[c][c] > covariance[widest][widest]) widest = c;
  std::int64_t axis[3] = {0, 0, 0};
  axis[widest] = 1;
  for (int round = 0; round < 8; ++round) {
    std::int64_t next[3], most = 0;
    for (int a = 0; a < 3; ++a) {
      next[a] = covariance[a][0] * axis[0] + covariance[a][1] * axis[1] + covariance[a][2] * axis[2];
      const std::int64_t size = next[a] < 0 ? -next[a] : next[a];
      most = size > most ? size : most;
    }
    if (most == 0) break;
    for (int a = 0; a < 3; ++a) axis[a] = most < 4096 ? next[a] : next[a] / (most / 4096 + 1);
  }
  return {{static_cast<int>(axis[0]), static_cast<int>(axis[1]), static_cast<int>(axis[2])}};
}

// Least-squares endpoints for the fit's indices, rounded. Returns false if all indices are equal.
bool solve_endpoints(const Rgb* texels, std::uint32_t indices, std::uint32_t* first, std::uint32_t* last) {
  int aa = 0, ab = 0, bb = 0, at[3] = {0, 0, 0}, bt[3] = {0, 0, 0};
  for (std::uint32_t i = 0; i < kTexels; ++i) {
    const int b = static_cast<int>(indices >> 2 * i & 3), a = 3 - b;
    aa += a * a, ab += a * b, bb += b * b;
    for (int c = 0; c < 3; ++c) at[c] += a * texels[i].c[c], bt[c] += b * texels[i].c[c];
  }
  const int determinant = aa * bb - ab * ab;
  if (determinant == 0) return false;
  Rgb ends[2];
  for (int c = 0; c < 3; ++c) {
    const int x = 3 * (at[c] * bb - bt[c] * ab) / determinant, y = 3 * (bt[c] * aa - at[c] * ab) / determinant;
    ends[0].c[c] = x < 0 ? 0 : x > 255 ? 255 : x;
    ends[1].c[c] = y < 0 ? 0 : y > 255 ? 255 : y;
  }
  *first = rounded_565(ends[0]), *last = rounded_565(ends[1]);
  return true;
}

// Changes one channel of an endpoint by one step at a time, as long as that helps.
void search_nearby(const Rgb* texels, ColorFit* best) {
  constexpr std::uint32_t kShift[3] = {0, 5, 11}, kMost[3] = {31, 63, 31};
  for (bool better = best->error > 0; better;) {
    better = false;
    const ColorFit from = *best;
    for (int end = 0; end < 2; ++end)
      for (int c = 0; c < 3; ++c) {
        const std::uint32_t color = end ? from.last : from.first, level = color >> kShift[c] & kMost[c];
        for (int step : {-1, 1}) {
          if ((level == 0 && step < 0) || (level == kMost[c] && step > 0)) continue;
          const std::uint32_t moved = step < 0 ? color - (1u << kShift[c]) : color + (1u << kShift[c]);
          better |= keep_better(end ? fit_of(texels, from.first, moved) : fit_of(texels, moved, from.last), best);
        }
      }
  }
}

// Finds endpoints by the extremes along the principal axis, then least squares, then a local search.
void encode_color(const Rgb* texels, std::uint32_t* block) {
  const Rgb axis = principal_axis(texels);
  std::uint32_t low = 0, high = 0;
  auto along = [&](std::uint32_t i) {
    return axis.c[0] * texels[i].c[0] + axis.c[1] * texels[i].c[1] + axis.c[2] * texels[i].c[2];
  };
  for (std::uint32_t i = 1; i < kTexels; ++i) {
    if (along(i) < along(low)) low = i;
    if (along(i) > along(high)) high = i;
  }
  ColorFit best = fit_of(texels, rounded_565(texels[low]), rounded_565(texels[high]));
  for (int round = 0; round < 4; ++round) {
    std::uint32_t first, last;
    if (!solve_endpoints(texels, best.indices, &first, &last) || !keep_better(fit_of(texels, first, last), &best))
      break;
  }
  search_nearby(texels, &best);
  block[0] = best.first | best.last << 16;
  block[1] = best.indices;
}

// Normalizes the normal, so that blue follows from red and green.
void normalize_texel(std::uint8_t* rgba) {
  const int x = rgba[0] - 128, y = rgba[1] - 128, z = rgba[2] - 128, square = x * x + y * y + z * z;
  if (square == 0) return;
  const float scale = 127 / std::sqrt(static_cast<float>(square));
  for (int c = 0; c < 2; ++c)
    rgba[c] = static_cast<std::uint8_t>(std::floor(128.5f + static_cast<float>(rgba[c] - 128) * scale));
}

void encode_block(TexelFormat format, const std::uint8_t (*rgba)[4], std::uint32_t* block) {
  Rgb colors[kTexels];
  std::uint8_t channels[4][kTexels];
  for (std::uint32_t i = 0; i < kTexels; ++i) {
    colors[i] = {{rgba[i][0], rgba[i][1], rgba[i][2]}};
    for (int c = 0; c < 4; ++c) channels[c][i] = rgba[i][c];
  }
  switch (format) {
    case TexelFormat::exact:
      CHECK(format != TexelFormat::exact);
      return;
    case TexelFormat::color4:
      return encode_color(colors, block);
    case TexelFormat::color_alpha8:
      encode_color(colors, block), encode_plane(channels[3], block + 2);
      return;
    case TexelFormat::red4:
      return encode_plane(channels[0], block);
    case TexelFormat::green_blue8:
      encode_plane(channels[1], block), encode_plane(channels[2], block + 2);
      return;
    case TexelFormat::normal8:
      encode_plane(channels[0], block), encode_plane(channels[1], block + 2);
      return;
    case TexelFormat::numbers12:
      for (int c = 0; c < 3; ++c) encode_plane(channels[c], block + 2 * c);
      return;
  }
}

}  // namespace

void encode_blocks(TexelFormat format, const std::uint32_t* texels, std::uint32_t width, std::uint32_t height,
                   std::uint32_t* blocks) {
  CHECK(texels != nullptr && blocks != nullptr);
  CHECK(format != TexelFormat::exact);
  CHECK(width >= 1 && height >= 1);
  for (std::uint32_t top = 0; top < height; top += kBlockSide)
    for (std::uint32_t left = 0; left < width; left += kBlockSide, blocks += block_words(format)) {
      std::uint8_t rgba[kTexels][4];
      for (std::uint32_t i = 0; i < kTexels; ++i) {  // beyond the edge, the edge's texels again
        const std::uint32_t x = left + i % kBlockSide, y = top + i / kBlockSide;
        const std::size_t from =
            static_cast<std::size_t>(y < height ? y : height - 1) * width + (x < width ? x : width - 1);
        std::memcpy(rgba[i], &texels[from], 4);
        if (format == TexelFormat::normal8) normalize_texel(rgba[i]);
      }
      encode_block(format, rgba, blocks);
    }
}

}  // namespace pocketray
