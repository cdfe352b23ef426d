// The probabilities that both ends of the codec adapt, and the coding of numbers and of pixels that differ from their
// prediction. Coders are RangeEncoder or RangeDecoder: one code serves both, so they cannot disagree.
#pragma once
#include "wire/predict.h"
#include "wire/range_coder.h"

namespace pocketray {

constexpr std::uint32_t kLengthsMax = 8;  // bits of a number above 0
constexpr int kNumberMax = (1 << kLengthsMax) - 1;

// Codes numbers from 1: how many bits follow the leading one, and the first of those. The remaining bits are even.
template <std::uint32_t lengths_max>
struct NumberModelOf {
  Probability length[lengths_max], second[lengths_max];
};
using NumberModel = NumberModelOf<kLengthsMax>;

constexpr std::uint32_t kPixelContexts = 64, kActivities = 4;

// Model of pixels with one kind of prediction.
struct PixelModel {
  Probability row_differs[4];  // any pixel of the block's row; by the rows beside and below
  Probability differs[kPixelContexts];
  Probability channel_differs[3][9][kActivities];  // by the signs of the channels before, 0, fall or rise
  Probability sign[3][9];
  NumberModel difference[3][kActivities];
};

struct BlockModel {
  Probability is_spatial[3], is_same_motion[3], is_exact[3];  // by the blocks beside and below
  Probability motion_differs[2][2], motion_sign[2];           // along x and y; y by whether x differs
  NumberModel motion[2];
};

struct CodeModels {
  PixelModel spatial, temporal;
  BlockModel block;
};
static_assert(sizeof(CodeModels) % sizeof(Probability) == 0, "all members are probabilities");

inline void restart_models(CodeModels* models) {
  auto* p = reinterpret_cast<Probability*>(models);
  for (std::size_t i = 0; i < sizeof *models / sizeof *p; ++i) p[i] = kEven;
}

inline std::uint32_t bits_after_first(std::uint32_t value) {
  return 31u - static_cast<std::uint32_t>(__builtin_clz(value));
}

// Codes a number from 1 with at most `bits_max` bits, at most lengths_max. An encoder returns it, too.
template <class Coder, std::uint32_t lengths_max>
std::uint32_t code_number(Coder* coder, NumberModelOf<lengths_max>* model, std::uint32_t bits_max,
                          std::uint32_t value) {
  const std::uint32_t wanted = Coder::kEncodes ? bits_after_first(value) : 0;
  std::uint32_t length = 0;
  while (length + 1 < bits_max && coder->bit(&model->length[length], length < wanted)) ++length;
  if (length == 0) return 1;
  std::uint32_t rest = length - 1, number = 2 | coder->bit(&model->second[length], value >> rest & 1);
  return number << rest | coder->even_bits(value & ((1u << rest) - 1), rest);
}

// Codes a pixel other than its prediction: per channel, the difference modulo the channel's levels. `activity` is how
// much the pixel's neighbours differ; for later channels, how much the channel before does.
template <class Pixel, class Coder>
std::uint32_t code_difference(Coder* coder, PixelModel* model, std::uint32_t activity, std::uint32_t predicted,
                              std::uint32_t pixel) {
  std::uint32_t result = 0, signs = 0;
  bool any = false;
  for (int i = 0; i < 3; ++i) {
    const std::uint32_t levels = 1u << Pixel::kBits[i], from = channel_of<Pixel>(predicted, i);
    std::uint32_t up = (channel_of<Pixel>(pixel, i) - from) & (levels - 1);  // encoder only
    bool falls = up > levels / 2;
    const bool must_differ = i == 2 && !any;
    signs *= 3;
    if (must_differ || coder->bit(&model->channel_differs[i][signs / 3][activity], up != 0)) {
      any = true;
      falls = coder->bit(&model->sign[i][signs / 3], falls) != 0;
      // At most levels / 2, which has the bit length of levels − 1.
      const std::uint32_t size =
          code_number(coder, &model->difference[i][activity], Pixel::kBits[i], falls ? levels - up : up);
      up = falls ? 0u - size : size;
      activity = size < 2 ? 1 : size < 4 ? 2 : 3;
      signs += falls ? 1 : 2;
    } else {
      up = 0;
      activity = i == 0 ? 0 : activity;
    }
    result |= ((from + up) & (levels - 1)) << Pixel::kShift[i];
  }
  return result;
}

}  // namespace pocketray
