#include "shade/lattice.h"

#include <algorithm>
#include <cmath>

#include "base/check.h"
#include "effect/effect_probe.h"
#include "shade/window.h"

namespace pocketray {
namespace {

// A picture with one row or column has no pairs of neighbours, so all of it is traced.
bool is_traced(const OpenWindow& window, std::uint32_t column, std::uint32_t row) {
  const Settings& settings = window.settings();
  return on_lattice(settings.resolution, column, row) || settings.width < 2 || settings.height < 2;
}

// Index of a pixel's neighbour, mirrored at the picture's edges.
std::uint32_t mirrored(std::uint32_t index, int step, std::uint32_t count) {
  const int last = static_cast<int>(count) - 1, at = std::abs(static_cast<int>(index) + step);
  return static_cast<std::uint32_t>(at > last ? 2 * last - at : at);
}

// Opposite pairs of pixels around a missing one.
struct Neighbours {
  std::uint32_t column[4], row[4];
};
Neighbours neighbours_of(const Settings& settings, std::uint32_t column, std::uint32_t row) {
  constexpr int kSteps[2][4][2] = {{{-1, 0}, {1, 0}, {0, -1}, {0, 1}}, {{-1, -1}, {1, 1}, {1, -1}, {-1, 1}}};
  const bool diagonal = settings.resolution == Resolution::half && column % 2 == 1 && row % 2 == 1;
  Neighbours n;
  for (int i = 0; i < 4; ++i) {
    n.column[i] = mirrored(column, kSteps[diagonal][i][0], settings.width);
    n.row[i] = mirrored(row, kSteps[diagonal][i][1], settings.height);
  }
  return n;
}

// Marks the traced pixels on which a pixel depends.
void want(OpenWindow* window, std::uint32_t column, std::uint32_t row) {
  std::uint8_t& state = window->state(column, row);
  if (state != kUnknown) return;
  if (is_traced(*window, column, row)) {
    state = kWanted;
    return want_columns(window, column, column + 1);
  }
  const Neighbours n = neighbours_of(window->settings(), column, row);
  for (int i = 0; i < 4; ++i) want(window, n.column[i], n.row[i]);
}

// Marks the traced pixels on which a tile depends.
void want_tile(OpenWindow* window, std::uint32_t column, std::uint32_t row) {
  const Settings& settings = window->settings();
  const std::uint32_t reach = settings.resolution == Resolution::half ? 2 : 1;
  const std::uint32_t begin = column - std::min(column, reach);
  const std::uint32_t end = std::min(column + kTileSide + 1, settings.width);
  const std::uint32_t row_end = std::min(row + kTileSide + 1, settings.height);
  for (std::uint32_t y = row - std::min(row, reach); y < row_end; ++y)
    for (std::uint32_t x = begin; x < end; ++x)
      if (is_traced(*window, x, y) && window->state(x, y) == kUnknown) window->state(x, y) = kWanted;
  want_columns(window, begin, end);
}

float difference(const Vec3& a, const Vec3& b) {
  return std::fabs(a.x - b.x) + std::fabs(a.y - b.y) + std::fabs(a.z - b.z);
}

Vec3 along_edge(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const float first = difference(a, b), second = difference(c, d);
  if (first < second) return (a + b) * 0.5f;
  if (second < first) return (c + d) * 0.5f;
  return ((a + b) + (c + d)) * 0.25f;
}

const Vec3& reconstructed(const OpenWindow& window, std::uint32_t column, std::uint32_t row) {
  Vec3& pixel = window.rows.at(column, row);
  std::uint8_t& state = window.state(column, row);
  if (state == kKnown) return pixel;
  CHECK(!is_traced(window, column, row));
  const Neighbours n = neighbours_of(window.settings(), column, row);
  const Vec3* value[4];
  for (int i = 0; i < 4; ++i) value[i] = &reconstructed(window, n.column[i], n.row[i]);
  pixel = along_edge(*value[0], *value[1], *value[2], *value[3]);
  state = kKnown;
  return pixel;
}

// Calls visit(column, row) for the pixels of a tile in the mask.
template <typename Visit>
void for_each_pixel(std::uint32_t left, std::uint32_t top, std::uint64_t mask, Visit visit) {
  for (; mask; mask &= mask - 1) {
    const auto m = static_cast<std::uint32_t>(__builtin_ctzll(mask));
    visit(left + morton_column(m), top + morton_row(m));
  }
}

// Reconstructs a whole tile inside the picture row by row; its neighbours need no mirroring.
void reconstruct_tile(const OpenWindow& window, std::uint32_t left, std::uint32_t top, const PixelRows& image) {
  const auto width = static_cast<std::ptrdiff_t>(window.rows.width);
  constexpr int kSide = kTileSide;
  const bool half = window.settings().resolution == Resolution::half;
  Vec3* first = &window.rows.at(left, top);
  std::uint8_t* states = &window.state(left, top);
  if (half)
    for (int y = -1; y < kSide; y += 2)
      for (int x = -1; x < kSide; x += 2) {
        const std::ptrdiff_t at = y * width + x;
        if (states[at] == kKnown) continue;
        const Vec3* p = first + at;
        first[at] = along_edge(*(p - width - 1), *(p + width + 1), *(p - width + 1), *(p + width - 1));
        states[at] = kKnown;
      }
  for (int y = 0; y < kSide; ++y) {
    Vec3* to = &image.at(left, top + static_cast<std::uint32_t>(y));
    for (int x = 0; x < kSide; ++x) {
      const std::ptrdiff_t at = y * width + x;
      Vec3* p = first + at;
      if (states[at] != kKnown) *p = along_edge(*(p - 1), *(p + 1), *(p - width), *(p + width)), states[at] = kKnown;
      to[x] = *p;
    }
  }
}

void reconstruct(const OpenWindow& window, std::uint32_t left, std::uint32_t top, std::uint64_t mask,
                 const PixelRows& image) {
  const Settings& settings = window.settings();
  const bool inside = left > 0 && top > 0 && left + kTileSide < settings.width && top + kTileSide < settings.height;
  if (inside && mask == ~std::uint64_t(0)) return reconstruct_tile(window, left, top, image);
  for_each_pixel(left, top, mask, [&](std::uint32_t column, std::uint32_t row) {
    image.at(column, row) = reconstructed(window, column, row);
  });
}

}  // namespace

void trace_lattice(Tracer* tracer, const TileStrip& strip, const PixelRows& image) {
  effect_entered<Effect::undersampling>();
  if (strip.tile_count == 0) return;
  CHECK(strip.row_count >= 1 && strip.row_count <= kTileRows);
  AlignedTiles tiles;
  align_tiles(strip, &tiles);
  for (std::uint32_t r = 0; r < 2; ++r) {
    if (std::all_of(tiles.mask[r], tiles.mask[r] + tiles.tile_count, [](std::uint64_t mask) { return mask == 0; }))
      continue;
    OpenWindow window = open_window(tracer, tiles.row + r * kTileSide);
    for (std::uint32_t c = 0; c < tiles.tile_count; ++c) {
      const std::uint32_t left = tiles.column + c * kTileSide, top = tiles.row + r * kTileSide;
      if (tiles.mask[r][c] == ~std::uint64_t(0)) {
        want_tile(&window, left, top);
        continue;
      }
      for_each_pixel(left, top, tiles.mask[r][c],
                     [&](std::uint32_t column, std::uint32_t row) { want(&window, column, row); });
    }
    trace_wanted(window);
    for (std::uint32_t c = 0; c < tiles.tile_count; ++c)
      reconstruct(window, tiles.column + c * kTileSide, tiles.row + r * kTileSide, tiles.mask[r][c], image);
  }
}

}  // namespace pocketray
