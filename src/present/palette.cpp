// Variance-based quantisation [Wan, Prusinkiewicz and Wong 1990, Color Research and Application 15(1)]: divides the box
// of colours with the largest squared error until there are enough. Splits boxes at their mean rather than at the plane
// of least error.
#include "present/palette.h"

#include <algorithm>

#include "base/check.h"

namespace pocketray {
namespace {

// Weights of squared differences by visibility: about the luminance weights.
constexpr std::uint32_t kWeights[3] = {3, 6, 1};

struct ColorBox {
  std::uint32_t begin, end;  // of the samples
  std::uint64_t sums[3];
  double error;  // sum of weighted squared differences from the mean
  int axis;      // axis with the largest part of it
};

ColorBox measure(Array<Rgb> samples, std::uint32_t begin, std::uint32_t end) {
  CHECK_LT(begin, end);
  ColorBox box = {begin, end, {0, 0, 0}, 0, 0};
  std::uint64_t squares[3] = {0, 0, 0};
  for (std::uint32_t i = begin; i < end; ++i)
    for (int c = 0; c < 3; ++c) {
      const std::uint32_t level = samples[i].channel[c];
      box.sums[c] += level, squares[c] += level * level;
    }
  const std::uint64_t count = end - begin;
  double most = 0;
  for (int c = 0; c < 3; ++c) {  // exact: count² levels² are below 2⁴⁸
    const double error =
        kWeights[c] * static_cast<double>(count * squares[c] - box.sums[c] * box.sums[c]) / static_cast<double>(count);
    box.error += error;
    if (error > most) most = error, box.axis = c;
  }
  return box;
}

Rgb mean_of(const ColorBox& box) {
  const std::uint64_t count = box.end - box.begin;
  Rgb mean;
  for (int c = 0; c < 3; ++c) mean.channel[c] = static_cast<std::uint8_t>((box.sums[c] + count / 2) / count);
  return mean;
}

}  // namespace

void make_palette(Array<Rgb> samples, std::uint32_t count_max, Palette* palette) {
  CHECK(samples.count >= 1 && samples.count <= kPaletteSampleMax);
  CHECK(count_max >= 1 && count_max <= kPaletteMax);
  ColorBox boxes[kPaletteMax];
  std::uint32_t count = 0;
  boxes[count++] = measure(samples, 0, samples.count);
  while (count < count_max) {
    ColorBox* worst =
        std::max_element(boxes, boxes + count, [](const ColorBox& a, const ColorBox& b) { return a.error < b.error; });
    if (!(worst->error > 0)) break;  // every box has one colour
    const ColorBox box = *worst;
    const std::uint64_t box_count = box.end - box.begin, sum = box.sums[box.axis];
    Rgb* middle = std::partition(samples.data + box.begin, samples.data + box.end,
                                 [&](const Rgb& sample) { return sample.channel[box.axis] * box_count <= sum; });
    const auto division = static_cast<std::uint32_t>(middle - samples.data);
    *worst = measure(samples, box.begin, division);
    boxes[count++] = measure(samples, division, box.end);
  }
  palette->count = count;
  for (std::uint32_t i = 0; i < count; ++i) palette->colors[i] = mean_of(boxes[i]);
}

std::uint32_t nearest_color(const Palette& palette, const Rgb& color) {
  CHECK_GT(palette.count, 0u);
  std::uint32_t best = 0, least = ~0u;
  for (std::uint32_t i = 0; i < palette.count; ++i) {
    std::uint32_t distance = 0;
    for (int c = 0; c < 3; ++c) {
      const int difference = palette.colors[i].channel[c] - color.channel[c];
      distance += kWeights[c] * static_cast<std::uint32_t>(difference * difference);
    }
    if (distance < least) least = distance, best = i;
  }
  return best;
}

}  // namespace pocketray
