#include "viewer/traced_overlay.h"

#include "base/check.h"

namespace pocketray {

void dim_kept_pixels(const Renderer& renderer, const Canvas& canvas) {
  if (!renderer.history.state.planned || renderer.history.state.whole_because) return;
  const Coherence& coherence = renderer.history.coherence;
  CHECK_EQ(static_cast<std::uint32_t>(canvas.width), coherence.plan.width);
  CHECK_EQ(static_cast<std::uint32_t>(canvas.height), coherence.plan.height);
  constexpr int kSide = kChangeTileSide;
  for (int row = 0; row < canvas.height; ++row) {
    const std::uint64_t* tiles = &coherence.changed[static_cast<std::uint32_t>(row / kSide) * coherence.tile_columns];
    for (int column = 0; column < canvas.width; ++column)
      if (!(tiles[column / kSide] >> (kSide * (row % kSide) + column % kSide) & 1)) dim_pixel(canvas, column, row, 2);
  }
}

}  // namespace pocketray
