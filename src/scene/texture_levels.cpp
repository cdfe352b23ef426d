#include "scene/texture_levels.h"

#include <cstring>

#include "base/check.h"
#include "base/color.h"

namespace pocketray {
namespace {

// Sums of a texel: its channels × its weight, and the weight.
constexpr std::size_t kSums = 5;
// Weight of texels with alpha 0, so that their colour counts where there is nothing else.
constexpr float kLeastWeight = 0x1p-16f;

void read_texel(std::uint32_t texel, TexelKind kind, float* sums) {
  std::uint8_t bytes[4];
  std::memcpy(bytes, &texel, sizeof bytes);
  const bool colors = kind == TexelKind::colors;
  const float alpha = static_cast<float>(bytes[3]);
  const float weight = !colors ? 1 : alpha > 0 ? alpha * (1.0f / 255) : kLeastWeight;
  for (int c = 0; c < 3; ++c) sums[c] = (colors ? srgb_to_linear(bytes[c]) : static_cast<float>(bytes[c])) * weight;
  sums[3] = alpha, sums[4] = weight;
}

std::uint32_t written_texel(const float* sums, TexelKind kind) {
  auto rounded = [](float x) { return static_cast<std::uint8_t>(x < 255 ? x + 0.5f : 255); };
  std::uint8_t bytes[4];
  for (int c = 0; c < 3; ++c) {
    const float mean = sums[c] / sums[4];
    bytes[c] = kind == TexelKind::colors ? srgb_level(mean) : rounded(mean);
  }
  bytes[3] = rounded(sums[3]);
  std::uint32_t texel;
  std::memcpy(&texel, bytes, sizeof texel);
  return texel;
}

// Weights of the texels of a side that texel `i` of its half covers: one, two, or three for an odd side.
struct Taps {
  std::uint32_t begin, count;
  float weight[3];
};

Taps taps_of(std::uint32_t side, std::uint32_t i) {
  CHECK_LT(i, level_side(side, 1));
  if (side == 1) return {0, 1, {1, 0, 0}};
  if (side % 2 == 0) return {2 * i, 2, {0.5f, 0.5f, 0}};
  const float half = static_cast<float>(side / 2), whole = static_cast<float>(side), at = static_cast<float>(i);
  return {2 * i, 3, {(half - at) / whole, half / whole, (at + 1) / whole}};
}

// Makes level 1 of `from` or of `sums`, whichever is not null. It may overwrite `sums`: a texel is never written beyond
// those that later ones read.
void halve(const std::uint32_t* from, const float* sums, std::uint32_t width, std::uint32_t height, TexelKind kind,
           float* to) {
  CHECK((from == nullptr) != (sums == nullptr));
  for (std::uint32_t y = 0; y < level_side(height, 1); ++y) {
    const Taps down = taps_of(height, y);
    for (std::uint32_t x = 0; x < level_side(width, 1); ++x, to += kSums) {
      const Taps across = taps_of(width, x);
      float mean[kSums] = {};
      for (std::uint32_t v = 0; v < down.count; ++v)
        for (std::uint32_t u = 0; u < across.count; ++u) {
          const std::size_t at = static_cast<std::size_t>(down.begin + v) * width + across.begin + u;
          float texel[kSums];
          if (from)
            read_texel(from[at], kind, texel);
          else
            std::memcpy(texel, sums + at * kSums, sizeof texel);
          const float weight = down.weight[v] * across.weight[u];
          for (std::size_t c = 0; c < kSums; ++c) mean[c] += texel[c] * weight;
        }
      std::memcpy(to, mean, sizeof mean);
    }
  }
}

}  // namespace

std::size_t level_scratch_need(std::uint32_t width, std::uint32_t height) {
  CHECK(width >= 1 && width <= kTextureSideMax && height >= 1 && height <= kTextureSideMax);
  return std::size_t(kSums) * level_side(width, 1) * level_side(height, 1);
}

void make_levels(const std::uint32_t* texels, std::uint32_t width, std::uint32_t height, TexelKind kind, float* scratch,
                 std::uint32_t* levels) {
  CHECK(texels != nullptr && scratch != nullptr && levels != nullptr);
  const std::uint32_t count = level_count_max(width, height);
  for (std::uint32_t level = 1; level < count; ++level) {
    const bool first = level == 1;
    halve(first ? texels : nullptr, first ? nullptr : scratch, level_side(width, level - 1),
          level_side(height, level - 1), kind, scratch);
    const std::uint32_t texel_count = level_side(width, level) * level_side(height, level);
    for (std::uint32_t i = 0; i < texel_count; ++i) *levels++ = written_texel(scratch + i * kSums, kind);
  }
}

}  // namespace pocketray
