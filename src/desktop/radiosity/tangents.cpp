#include "desktop/radiosity/tangents.h"

#include <algorithm>
#include <cmath>

#include "base/check.h"

namespace pocketray {
namespace {

// The derivative at place `i` of `count` values `stride` apart.
float slope(const float* values, std::uint32_t i, std::uint32_t count, std::size_t stride) {
  const float* at = values + i * stride;
  if (count == 2) return values[stride] - values[0];
  if (i == 0) return (4 * at[stride] - at[2 * stride] - 3 * at[0]) * 0.5f;
  if (i == count - 1) return (3 * at[0] - 4 * *(at - stride) + *(at - 2 * stride)) * 0.5f;
  return (at[stride] - *(at - stride)) * 0.5f;
}

struct Range {
  float low, high;
};

// Returns the range of the values at a node and its neighbours.
Range range_around(const RadiosityNode* nodes, std::uint32_t columns, std::uint32_t rows, std::uint32_t column,
                   std::uint32_t row, int axis) {
  Range range = {nodes[row * columns + column].value[axis], nodes[row * columns + column].value[axis]};
  for (std::uint32_t y = row ? row - 1 : 0; y <= std::min(row + 1, rows - 1); ++y)
    for (std::uint32_t x = column ? column - 1 : 0; x <= std::min(column + 1, columns - 1); ++x) {
      const float value = nodes[y * columns + x].value[axis];
      range.low = std::min(range.low, value), range.high = std::max(range.high, value);
    }
  return range;
}

// The largest share in [0, 1] of `step` that keeps value + share·step in the range.
float share_within(const Range& range, float value, float step) {
  if (step > range.high - value) return (range.high - value) / step;
  if (step < range.low - value) return (range.low - value) / step;
  return 1;
}

// Shortens the tangents of one node until its Bézier points f ± ds/3 ± dt/3 ± dst/9 are in the range. Only the
// quadrants that have a patch count.
void limit(const Range& range, bool left, bool right, bool below, bool above, float value, float* ds, float* dt,
           float* dst) {
  const float third = 1.0f / 3;
  auto limit_one = [&](float* tangent, bool before, bool after) {
    float share = 1;
    if (before) share = std::min(share, share_within(range, value, -*tangent * third));
    if (after) share = std::min(share, share_within(range, value, *tangent * third));
    *tangent *= share;
  };
  limit_one(ds, left, right);
  limit_one(dt, below, above);
  float share = 1, twist_low = -__builtin_inff(), twist_high = __builtin_inff();
  auto each_quadrant = [&](auto visit) {
    for (int x = -1; x <= 1; x += 2)
      for (int y = -1; y <= 1; y += 2)
        if ((x < 0 ? left : right) && (y < 0 ? below : above)) visit(static_cast<float>(x), static_cast<float>(y));
  };
  each_quadrant([&](float x, float y) {
    const float step = (x * *ds + y * *dt) * third;
    // The twist may bring the point back, by as much as it has.
    share = std::min(share, share_within(range, value, step));
  });
  *ds *= share, *dt *= share;
  each_quadrant([&](float x, float y) {
    const float point = value + (x * *ds + y * *dt) * third, sign = x * y;
    const float low = (range.low - point) * 9, high = (range.high - point) * 9;
    twist_low = std::max(twist_low, sign > 0 ? low : -high), twist_high = std::min(twist_high, sign > 0 ? high : -low);
  });
  *dst = std::max(std::min(*dst, twist_high), std::min(twist_low, twist_high));
}

}  // namespace

void set_tangents(RadiosityNode* nodes, std::uint32_t columns, std::uint32_t rows, bool limited) {
  CHECK(nodes != nullptr);
  CHECK(columns >= 2 && rows >= 2);
  constexpr std::size_t kStride = sizeof(RadiosityNode) / sizeof(float);
  for (int axis = 0; axis < 3; ++axis) {
    for (std::uint32_t row = 0; row < rows; ++row)
      for (std::uint32_t column = 0; column < columns; ++column) {
        RadiosityNode& node = nodes[row * columns + column];
        node.ds[axis] = slope(&nodes[row * columns].value[axis], column, columns, kStride);
        node.dt[axis] = slope(&nodes[column].value[axis], row, rows, columns * kStride);
      }
    for (std::uint32_t row = 0; row < rows; ++row)
      for (std::uint32_t column = 0; column < columns; ++column)
        nodes[row * columns + column].dst[axis] = slope(&nodes[row * columns].dt[axis], column, columns, kStride);
    if (!limited) continue;
    for (std::uint32_t row = 0; row < rows; ++row)
      for (std::uint32_t column = 0; column < columns; ++column) {
        RadiosityNode& n = nodes[row * columns + column];
        limit(range_around(nodes, columns, rows, column, row, axis), column > 0, column + 1 < columns, row > 0,
              row + 1 < rows, n.value[axis], &n.ds[axis], &n.dt[axis], &n.dst[axis]);
      }
  }
}

}  // namespace pocketray
