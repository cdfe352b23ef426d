// Codes the rows of a chunk in blocks, bottom row first, since servers send the lowest rows first. A block is predicted
// from the previous frame, shifted by a motion vector, or from its neighbours in the current one.
#pragma once
#include <cstring>

#include "wire/codec_state.h"
#include "wire/pixel_model.h"

namespace pocketray {

struct Block {
  std::uint32_t column, width;       // in the picture
  std::uint32_t row_begin, row_end;  // in the picture
};

// Returns whether the moved block lies within the picture.
inline bool may_move(const CodecShape& shape, const Block& block, BlockMotion motion) {
  const std::int32_t x = static_cast<std::int32_t>(block.column) + motion.x;
  const std::int32_t y = static_cast<std::int32_t>(block.row_begin) + motion.y;
  return x >= 0 && x + static_cast<std::int32_t>(block.width) <= static_cast<std::int32_t>(shape.width) && y >= 0 &&
         y + static_cast<std::int32_t>(block.row_end - block.row_begin) <= static_cast<std::int32_t>(shape.height);
}

// Pixels of the previous frame from which a row of the block is predicted.
template <class Pixel>
const std::uint8_t* moved_row(const CodecState& s, const Block& block, BlockMotion motion, std::uint32_t row) {
  const std::int32_t from = static_cast<std::int32_t>(row) + motion.y;
  const std::int32_t column = static_cast<std::int32_t>(block.column) + motion.x;
  return row_before(s, static_cast<std::uint32_t>(from)) + static_cast<std::uint32_t>(column) * Pixel::kBytes;
}

template <class Coder>
std::int32_t code_motion(Coder* coder, BlockModel* model, int axis, bool other_differs, std::int32_t from,
                         std::int32_t to) {
  std::int32_t by = to - from;
  if (!coder->bit(&model->motion_differs[axis][other_differs], by != 0)) return from;
  const bool falls = coder->bit(&model->motion_sign[axis], by < 0) != 0;
  const auto size = static_cast<std::int32_t>(
      code_number(coder, &model->motion[axis], kLengthsMax, static_cast<std::uint32_t>(falls ? -by : by)));
  return falls ? from - size : from + size;
}

// Returns false if the block would leave the picture. `beside` and `below` are already coded: their kinds are the
// context, and `beside` predicts the motion.
template <class Coder>
bool code_choice(Coder* coder, BlockModel* model, const CodecShape& shape, const Block& block,
                 const BlockChoice& beside, BlockKind below, BlockChoice* choice) {
  auto context = [&](BlockKind kind) { return (beside.kind == kind) + (below == kind); };
  if (coder->bit(&model->is_spatial[context(BlockKind::spatial)], choice->kind == BlockKind::spatial)) {
    *choice = {BlockKind::spatial, beside.motion};
    return true;
  }
  const bool same = choice->motion == beside.motion;
  BlockMotion motion = beside.motion;
  if (!coder->bit(&model->is_same_motion[context(BlockKind::exact)], same)) {
    const std::int32_t x = code_motion(coder, model, 0, false, beside.motion.x, choice->motion.x);
    const std::int32_t y = code_motion(coder, model, 1, x != beside.motion.x, beside.motion.y, choice->motion.y);
    motion = {static_cast<std::int16_t>(x), static_cast<std::int16_t>(y)};
  }
  choice->motion = motion;
  if (!may_move(shape, block, motion)) return false;
  const bool exact = coder->bit(&model->is_exact[context(BlockKind::exact)], choice->kind == BlockKind::exact) != 0;
  choice->kind = exact ? BlockKind::exact : BlockKind::temporal;
  return true;
}

// Already coded neighbours of a pixel. Outside the picture, and right of the block, they repeat other neighbours.
struct Neighbours {
  std::uint32_t left, below, corner, beyond;  // beyond: right of `below`
};

// A row of a block: its pixels in the picture, the row below, the previous frame and, `from`, an encoder's source.
struct BlockRow {
  std::uint8_t* here;
  const std::uint8_t *below, *before, *from;
  std::uint32_t width;
  bool has_left, has_beyond;  // pixels exist left of the row, in the block beside, and right of the row below
};

// Walks the pixels of a row from left to right: first_neighbours(), then next_neighbours() after each pixel.
template <class Pixel>
std::uint32_t pixel_beyond(const BlockRow& row, std::uint32_t i, std::uint32_t below) {
  return i + 1 < row.width || row.has_beyond ? Pixel::load(row.below + (i + 1) * Pixel::kBytes) : below;
}
template <class Pixel>
Neighbours first_neighbours(const BlockRow& row) {
  Neighbours n;
  n.below = Pixel::load(row.below);
  n.left = row.has_left ? Pixel::load(row.here - Pixel::kBytes) : n.below;
  n.corner = row.has_left ? Pixel::load(row.below - Pixel::kBytes) : n.below;
  n.beyond = pixel_beyond<Pixel>(row, 0, n.below);
  return n;
}
template <class Pixel>
void next_neighbours(const BlockRow& row, std::uint32_t i, std::uint32_t pixel, Neighbours* n) {
  n->left = pixel, n->corner = n->below, n->below = n->beyond;
  n->beyond = pixel_beyond<Pixel>(row, i, n->below);
}

// Fills a row with its predicted pixels.
template <class Pixel>
void predict_row(const BlockRow& row) {
  if (row.before) {
    std::memcpy(row.here, row.before, row.width * Pixel::kBytes);
    return;
  }
  Neighbours n = first_neighbours<Pixel>(row);
  for (std::uint32_t i = 0;;) {
    const std::uint32_t pixel = predict<Pixel>(n.left, n.below, n.corner);
    Pixel::store(row.here + i * Pixel::kBytes, pixel);
    if (++i == row.width) return;
    next_neighbours<Pixel>(row, i, pixel, &n);
  }
}

// Returns whether a pixel of the row is beyond the tolerance of its prediction, if all pixels before it equal theirs.
template <class Pixel>
bool row_differs(const BlockRow& row, std::uint32_t tolerance) {
  predict_row<Pixel>(row);
  for (std::uint32_t i = 0; i < row.width * Pixel::kBytes; i += Pixel::kBytes)
    if (!is_close<Pixel>(Pixel::load(row.here + i), Pixel::load(row.from + i), tolerance)) return true;
  return false;
}

// Codes the pixels of a row with differences. `differs` holds the row below's flags and receives this row's.
template <class Pixel, class Coder>
void code_row(Coder* coder, PixelModel* model, const BlockRow& row, std::uint32_t beside, std::uint32_t tolerance,
              std::uint8_t* differs) {
  Neighbours n = first_neighbours<Pixel>(row);
  for (std::uint32_t i = 0;;) {
    const std::uint32_t history = beside | std::uint32_t(differs[i]) << 1 | std::uint32_t(differs[i + 1]) << 2;
    std::uint32_t predicted, context, activity;
    if (row.before) {
      predicted = Pixel::load(row.before + i * Pixel::kBytes);
      const std::uint32_t a = predicted != n.left, b = predicted != n.below, c = n.left != n.below;
      context = history | a << 3 | b << 4 | c << 5;
      activity = (history & 1) + (history >> 1 & 1) + (history >> 2);
    } else {
      predicted = predict<Pixel>(n.left, n.below, n.corner);
      const std::uint32_t a = n.left != n.corner, b = n.below != n.corner, c = n.beyond != n.below;
      context = history | a << 3 | b << 4 | c << 5;
      activity = a + b + c;
    }
    std::uint32_t pixel = 0;
    if (Coder::kEncodes) {
      pixel = Pixel::load(row.from + i * Pixel::kBytes);
      if (is_close<Pixel>(pixel, predicted, tolerance)) pixel = predicted;
    }
    beside = coder->bit(&model->differs[context], pixel != predicted);
    pixel = beside ? code_difference<Pixel>(coder, model, activity, predicted, pixel) : predicted;
    Pixel::store(row.here + i * Pixel::kBytes, pixel);
    differs[i] = static_cast<std::uint8_t>(beside);
    if (++i == row.width) return;
    next_neighbours<Pixel>(row, i, pixel, &n);
  }
}

// Codes a block's pixels into the state's picture. An encoder reads them from `source`, which points at the block's
// first pixel; they may deviate by the tolerance.
template <class Pixel, class Coder>
void code_pixels(Coder* coder, CodecState* s, const Block& block, const BlockChoice& choice, const std::uint8_t* source,
                 std::uint32_t tolerance) {
  const bool temporal = choice.kind == BlockKind::temporal;
  PixelModel* model = temporal ? &s->models.temporal : &s->models.spatial;
  const std::size_t stride = std::size_t(s->shape.width) * Pixel::kBytes, first = block.column * Pixel::kBytes;
  std::uint32_t below_differs = 1;
  for (std::uint32_t i = block.row_end - block.row_begin; i-- > 0;) {
    const std::uint32_t y = block.row_begin + i;
    BlockRow row = {
        picture_row(*s, y) + first, row_below(*s, y) + first, nullptr, nullptr, block.width, block.column > 0, false};
    row.has_beyond = y + 1 == block.row_end && block.column + block.width < s->shape.width;
    if (temporal) row.before = moved_row<Pixel>(*s, block, choice.motion, y);
    if (Coder::kEncodes) row.from = source + i * stride;
    std::uint8_t* beside = &s->rows_differ[i];
    bool differs = false;
    if (Coder::kEncodes) differs = row_differs<Pixel>(row, tolerance);
    below_differs = coder->bit(&model->row_differs[below_differs | (*beside & 2u)], differs);
    if (below_differs) {
      code_row<Pixel>(coder, model, row, *beside & 1u, tolerance, s->differs.data + 1 + block.column);
    } else {
      if (!Coder::kEncodes) predict_row<Pixel>(row);
      std::memset(s->differs.data + 1 + block.column, 0, block.width);
    }
    *beside = static_cast<std::uint8_t>(s->differs[block.column + block.width] | below_differs << 1);
  }
}

template <class Pixel>
void copy_block(CodecState* s, const Block& block, BlockMotion motion) {
  for (std::uint32_t row = block.row_begin; row < block.row_end; ++row) {
    std::memcpy(picture_row(*s, row) + block.column * Pixel::kBytes, moved_row<Pixel>(*s, block, motion, row),
                block.width * Pixel::kBytes);
    s->rows_differ[row - block.row_begin] = 0;
  }
  std::memset(s->differs.data + 1 + block.column, 0, block.width);
}

// Codes the rows. An encoder asks `choose(block, beside, below, &choice)` how to predict each block. A decoder returns
// false if no encoder could have written these bytes.
template <class Pixel, class Coder, class Choose>
bool code_blocks(Coder* coder, CodecState* s, std::uint32_t row_begin, std::uint32_t row_end,
                 const std::uint8_t* source, std::uint32_t tolerance, const Choose& choose) {
  std::memset(s->differs.data, 0, s->differs.bytes());
  for (std::uint32_t end = row_end; end > row_begin;) {
    const std::uint32_t begin = end > row_begin + kBlockRows ? end - kBlockRows : row_begin;
    BlockChoice beside = s->blocks[0];
    std::memset(s->rows_differ, 0, sizeof s->rows_differ);
    for (std::uint32_t column = 0; column < s->shape.width; column += kBlockColumns) {
      const std::uint32_t width = s->shape.width - column < kBlockColumns ? s->shape.width - column : kBlockColumns;
      const Block block = {column, width, begin, end};
      BlockChoice* below = &s->blocks[column / kBlockColumns];
      BlockChoice choice;
      choose(block, beside, *below, &choice);
      if (!code_choice(coder, &s->models.block, s->shape, block, beside, below->kind, &choice)) return false;
      if (choice.kind == BlockKind::exact)
        copy_block<Pixel>(s, block, choice.motion);
      else
        code_pixels<Pixel>(coder, s, block, choice,
                           Coder::kEncodes
                               ? source + (std::size_t(begin - row_begin) * s->shape.width + column) * Pixel::kBytes
                               : nullptr,
                           tolerance);
      beside = *below = choice;
    }
    end = begin;
  }
  return true;
}

}  // namespace pocketray
