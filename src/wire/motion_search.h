// The sender's choice of how to predict a block.
#pragma once
#include "wire/block_coder.h"

namespace pocketray {

struct MotionSearch {
  const CodecState* state;
  const std::uint8_t* pixels;  // of the chunk
  std::uint32_t row_begin;     // its first row
  std::uint32_t tolerance;     // maximum deviation of a channel, in levels
};

// Starts at the motions of the surrounding blocks and descends to better ones: seen by a moving camera, neighbouring
// blocks move alike.
template <class Pixel>
void choose_block(const MotionSearch& search, const Block& block, const BlockChoice& beside, const BlockChoice& below,
                  BlockChoice* choice);

extern template void choose_block<Pixel565>(const MotionSearch&, const Block&, const BlockChoice&, const BlockChoice&,
                                            BlockChoice*);
extern template void choose_block<Pixel888>(const MotionSearch&, const Block&, const BlockChoice&, const BlockChoice&,
                                            BlockChoice*);

}  // namespace pocketray
