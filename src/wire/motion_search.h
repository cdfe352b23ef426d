// The sender's choice of how to predict a block.
#pragma once
#include "wire/block_coder.h"

namespace pocketray {

struct MotionSearch {
  const CodecState* state;
  const std::uint8_t* pixels;  // of the chunk
  std::uint32_t row_begin;     // its first row
  std::uint32_t tolerance;     // levels by which a channel may differ from what is sent
};

// Follows the motion of the blocks around from better to better neighbours, as blocks of a picture seen by a moving
// camera move nearly alike.
template <class Pixel>
void choose_block(const MotionSearch& search, const Block& block, const BlockChoice& beside, const BlockChoice& below,
                  BlockChoice* choice);

extern template void choose_block<Pixel565>(const MotionSearch&, const Block&, const BlockChoice&, const BlockChoice&,
                                            BlockChoice*);
extern template void choose_block<Pixel888>(const MotionSearch&, const Block&, const BlockChoice&, const BlockChoice&,
                                            BlockChoice*);

}  // namespace pocketray
