#include "wire/motion_search.h"

#include <algorithm>
#include <cstdlib>

#include "base/check.h"

namespace pocketray {
namespace {

// Estimated bits, measured by codec_frames_test: kDiffers for a pixel that differs, plus up to kChannelMost per
// channel, growing with the difference; kOtherMotion for a motion other than that of the block beside.
constexpr std::uint32_t kDiffers = 4, kChannelMost = 16, kOtherMotion = 8;
constexpr int kStepsMax = 16;  // maximum length of the search
constexpr int kSteps[4][2] = {{1, 0}, {-1, 0}, {0, 1}, {0, -1}};

template <class Pixel>
std::uint32_t pixel_cost(std::uint32_t pixel, std::uint32_t predicted, std::uint32_t tolerance) {
  if (is_close<Pixel>(pixel, predicted, tolerance)) return 0;
  const std::uint32_t a = channel_of<Pixel>(pixel, 0), b = channel_of<Pixel>(predicted, 0);
  return kDiffers + std::min(a < b ? b - a : a - b, kChannelMost);
}

template <class Pixel>
const std::uint8_t* source_row(const MotionSearch& search, const Block& block, std::uint32_t row) {
  return search.pixels +
         (std::size_t(row - search.row_begin) * search.state->shape.width + block.column) * Pixel::kBytes;
}

// Returns whether the code can express the difference from the motion of the block beside.
bool can_code(BlockMotion from, BlockMotion to) {
  return std::abs(to.x - from.x) <= kNumberMax && std::abs(to.y - from.y) <= kNumberMax;
}

// Returns early once the cost reaches `enough`.
template <class Pixel>
std::uint32_t temporal_cost(const MotionSearch& search, const Block& block, BlockMotion motion, std::uint32_t enough) {
  std::uint32_t cost = 0;
  for (std::uint32_t row = block.row_begin; row < block.row_end && cost < enough; ++row) {
    const std::uint8_t* pixels = source_row<Pixel>(search, block, row);
    const std::uint8_t* before = moved_row<Pixel>(*search.state, block, motion, row);
    if (std::memcmp(pixels, before, block.width * Pixel::kBytes) == 0) continue;
    for (std::uint32_t i = 0; i < block.width * Pixel::kBytes; i += Pixel::kBytes)
      cost += pixel_cost<Pixel>(Pixel::load(pixels + i), Pixel::load(before + i), search.tolerance);
  }
  return cost;
}

template <class Pixel>
std::uint32_t spatial_cost(const MotionSearch& search, const Block& block, std::uint32_t enough) {
  std::uint32_t cost = 0;
  for (std::uint32_t y = block.row_end; y-- > block.row_begin && cost < enough;) {
    const std::uint8_t* pixels = source_row<Pixel>(search, block, y);
    const std::uint8_t* below = y + 1 < block.row_end ? source_row<Pixel>(search, block, y + 1)
                                                      : row_below(*search.state, y) + block.column * Pixel::kBytes;
    std::uint32_t left = block.column > 0 ? Pixel::load(pixels - Pixel::kBytes) : Pixel::load(below);
    std::uint32_t corner = block.column > 0 ? Pixel::load(below - Pixel::kBytes) : left;
    for (std::uint32_t i = 0; i < block.width * Pixel::kBytes; i += Pixel::kBytes) {
      const std::uint32_t pixel = Pixel::load(pixels + i), under = Pixel::load(below + i);
      cost += pixel_cost<Pixel>(pixel, predict<Pixel>(left, under, corner), search.tolerance);
      left = pixel, corner = under;
    }
  }
  return cost;
}

}  // namespace

template <class Pixel>
void choose_block(const MotionSearch& search, const Block& block, const BlockChoice& beside, const BlockChoice& below,
                  BlockChoice* choice) {
  CHECK(search.pixels != nullptr);
  CHECK_LE(search.row_begin, block.row_begin);
  CHECK_LT(block.row_begin, block.row_end);
  CHECK_LE(block.row_end, search.state->shape.height);
  CHECK_LE(block.column + block.width, search.state->shape.width);
  BlockMotion best = beside.motion;
  std::uint32_t lowest = UINT32_MAX;
  auto try_motion = [&](int x, int y) {
    const BlockMotion motion = {static_cast<std::int16_t>(x), static_cast<std::int16_t>(y)};
    const std::uint32_t price = motion == beside.motion ? 0 : kOtherMotion;
    if (lowest <= price || !can_code(beside.motion, motion) || !may_move(search.state->shape, block, motion))
      return false;
    const std::uint32_t cost = price + temporal_cost<Pixel>(search, block, motion, lowest - price);
    if (cost >= lowest) return false;
    lowest = cost, best = motion;
    return true;
  };
  try_motion(beside.motion.x, beside.motion.y);
  if (!(below.motion == beside.motion)) try_motion(below.motion.x, below.motion.y);
  const BlockMotion still;
  if (!(still == beside.motion) && !(still == below.motion)) try_motion(0, 0);
  const std::uint32_t spatial = lowest > 0 ? spatial_cost<Pixel>(search, block, lowest) : 0;
  // Greedy descent: moves on as long as a direction is better.
  for (int step = 0, better = 1; better > 0 && lowest > kOtherMotion && spatial > kOtherMotion && step < kStepsMax;
       ++step) {
    better = 0;
    for (const auto& by : kSteps) {
      if (!try_motion(best.x + by[0], best.y + by[1])) continue;
      ++better;
      break;
    }
  }
  if (lowest == (best == beside.motion ? 0 : kOtherMotion)) {
    *choice = {BlockKind::exact, best};
  } else if (spatial < lowest) {
    choice->kind = BlockKind::spatial;
  } else {
    *choice = {BlockKind::temporal, best};
  }
  CHECK(choice->kind == BlockKind::spatial || can_code(beside.motion, choice->motion));
}

template void choose_block<Pixel565>(const MotionSearch&, const Block&, const BlockChoice&, const BlockChoice&,
                                     BlockChoice*);
template void choose_block<Pixel888>(const MotionSearch&, const Block&, const BlockChoice&, const BlockChoice&,
                                     BlockChoice*);

}  // namespace pocketray
