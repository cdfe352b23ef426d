#include "shade/even_points.h"

#include "base/check.h"
#include "base/limits.h"

namespace pocketray {
namespace {

// For each count, the row of the point in each column. Found by simulated annealing: least mean square error, over all
// straight edges across the square, of the area on one side, which is half the energy distance between the points and
// the square [Székely & Rizzo 2013, "Energy statistics", eq. 4.5]. `build/test_shade -tc='even_points_*'` verifies that
// exchanging no two points reduces it.
constexpr std::uint8_t kRook[] = {0,                                                             //
                                  0, 1,                                                          //
                                  0, 2,  1,                                                      //
                                  1, 3,  0,  2,                                                  //
                                  1, 4,  2,  0,  3,                                              //
                                  1, 4,  2,  5,  0,  3,                                          //
                                  2, 5,  0,  3,  6,  1,  4,                                      //
                                  1, 4,  7,  2,  5,  0,  3,  6,                                  //
                                  2, 7,  4,  0,  6,  3,  8,  1,  5,                              //
                                  2, 8,  4,  7,  0,  3,  6,  9,  1,  5,                          //
                                  3, 9,  5,  0,  8,  2,  6,  10, 4,  1,  7,                      //
                                  4, 9,  1,  6,  11, 3,  8,  0,  5,  10, 2, 7,                   //
                                  2, 8,  12, 5,  1,  9,  6,  3,  11, 7,  0, 4,  10,              //
                                  2, 8,  12, 5,  1,  10, 7,  3,  13, 9,  4, 0,  11, 6,           //
                                  3, 10, 13, 7,  0,  4,  11, 8,  2,  14, 5, 9,  1,  12, 6,       //
                                  3, 11, 7,  15, 1,  9,  5,  13, 2,  10, 6, 14, 0,  8,  4, 12};  //
static_assert(sizeof kRook == kSampleCountMax * (kSampleCountMax + 1) / 2, "a row for each count");

// (index + ½) / count, rounded once.
float middle(std::uint32_t index, std::uint32_t count) {
  return static_cast<float>(2 * index + 1) / static_cast<float>(2 * count);
}

}  // namespace

Vec2 rook_point(std::uint32_t index, std::uint32_t count) {
  CHECK_LE(count, kSampleCountMax);
  CHECK_LT(index, count);
  return {middle(index, count), middle(kRook[count * (count - 1) / 2 + index], count)};
}

UnitCell equal_cell(std::uint32_t index, std::uint32_t count) {
  CHECK_LT(index, count);
  std::uint32_t rows = 1, begin = 0, end = 0;
  while (rows * (rows + 1) < count) ++rows;  // (rows + ½)² < count
  for (std::uint32_t row = 1; end <= index; ++row) {
    begin = end;
    end = (2 * row * count + rows - 1) / (2 * rows);  // row · count / rows, halves rounded down
  }
  CHECK(begin <= index && index < end && end <= count);
  double width = end - begin, column = index - begin;
  return {column / width, (column + 1) / width, (static_cast<double>(begin) + end) / (2.0 * count), width / count};
}

}  // namespace pocketray
