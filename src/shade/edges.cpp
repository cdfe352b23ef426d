#include "shade/edges.h"

#include <algorithm>
#include <cmath>

#include "base/check.h"
#include "effect/effect_probe.h"
#include "shade/even_points.h"
#include "shade/filters.h"
#include "shade/pixel.h"
#include "shade/sample_points.h"
#include "shade/tile.h"
#include "shade/tile_shadows.h"

namespace pocketray {
namespace {

// The largest bend that is no edge, as a share of white on a display of gamma 2. Measured with 8 samples in ten scenes:
// see tests/accuracy/FIGURES.md.
constexpr float kBendMax = 12 / 255.0f;

constexpr std::uint32_t kBlockSide = kTileSide + 2;
constexpr std::uint32_t kBlockValues = 32;  // of a row: three for each pixel, and two for nothing
static_assert(3 * kBlockSide <= kBlockValues, "a block's row");

// Displayed values of a tile's pixels and of those around them; at the picture's border the last ones are repeated.
struct DisplayBlock {
  float value[kBlockSide][kBlockValues];
};

// Fills the block with radiances as shares of white. Returns whether they may bend enough for an edge.
bool fill_block(const OpenWindow& window, std::uint32_t left, std::uint32_t top, DisplayBlock* block) {
  CHECK(block != nullptr);
  const Settings& settings = window.settings();
  const float exposure = 1 / window.tracer->frame->selection.white;
  Vec3 low = {1, 1, 1}, high = {0, 0, 0};
  for (std::uint32_t y = 0; y < kBlockSide; ++y) {
    const std::uint32_t row = std::min(std::max(top + y, 1u) - 1, settings.height - 1);
    float* to = block->value[y];
    for (std::uint32_t x = 0; x < kBlockSide; ++x, to += 3) {
      const std::uint32_t column = std::min(std::max(left + x, 1u) - 1, settings.width - 1);
      Vec3 share = {0, 0, 0};
      if (window.state(column, row) == kKnown) {  // otherwise it is not around a wanted pixel
        const Vec3 radiance = toned(window.rows.at(column, row) * exposure, settings.tone);
        for (int c = 0; c < 3; ++c) share[c] = radiance[c] > 0 ? (radiance[c] < 1 ? radiance[c] : 1) : 0;  // 0 for NaN
      }
      low = min(low, share), high = max(high, share);
      to[0] = share.x, to[1] = share.y, to[2] = share.z;
    }
    to[0] = to[1] = 0;
  }
  // A bend is at most twice √high − √low, which is below kHalf if high − low is below kHalf² + 2 kHalf √low, and √low
  // is at least low. A little less than half, so that rounding leaves out no edge.
  constexpr float kHalf = 0.49f * kBendMax;
  const Vec3 range = high - low - low * (2 * kHalf);
  return max_component(range) > kHalf * kHalf;
}

// Replaces shares of white by displayed values.
void display(DisplayBlock* block) {
  for (auto& row : block->value)
    for (float& value : row) value = std::sqrt(value);
}

bool bends(float a, float b, float c) { return std::fabs((a - b) - (b - c)) > kBendMax; }

// Returns whether the values bend at the tile's pixel in one of four directions.
bool is_edge(const DisplayBlock& block, std::uint32_t column, std::uint32_t row) {
  const float *above = &block.value[row][3 * column], *here = &block.value[row + 1][3 * column],
              *below = &block.value[row + 2][3 * column];
  for (int c = 0; c < 3; ++c) {
    const float value = here[3 + c];
    if (bends(here[c], value, here[6 + c]) || bends(above[3 + c], value, below[3 + c]) ||
        bends(above[c], value, below[6 + c]) || bends(above[6 + c], value, below[c]))
      return true;
  }
  return false;
}

// Marks the pixels on which a tile's pixels in the mask depend.
void want_tile(OpenWindow* window, std::uint32_t left, std::uint32_t top, std::uint64_t mask) {
  CHECK(window != nullptr);
  const Settings& settings = window->settings();
  auto want = [&](std::uint32_t column_begin, std::uint32_t column_end, std::uint32_t row_begin,
                  std::uint32_t row_end) {
    column_begin -= std::min(column_begin, 1u), column_end = std::min(column_end + 1, settings.width);
    row_begin -= std::min(row_begin, 1u), row_end = std::min(row_end + 1, settings.height);
    for (std::uint32_t row = row_begin; row < row_end; ++row)
      for (std::uint32_t column = column_begin; column < column_end; ++column)
        if (window->state(column, row) == kUnknown) window->state(column, row) = kWanted;
    want_columns(window, column_begin, column_end);
  };
  if (mask == ~std::uint64_t(0)) return want(left, left + kTileSide, top, top + kTileSide);
  for (; mask; mask &= mask - 1) {
    const auto m = static_cast<std::uint32_t>(__builtin_ctzll(mask));
    const std::uint32_t column = left + morton_column(m), row = top + morton_row(m);
    want(column, column + 1, row, row + 1);
  }
}

// Pixels at edges, whose samples are traced in packets: all samples of some pixels, or, where samples have light points
// of their own, one sample of more pixels.
struct EdgePixels {
  std::uint32_t count = 0;
  std::uint16_t column[kPacketMax], row[kPacketMax];
  Ray ray[kPacketMax];
  RayPacket packet;  // the rays; not set if they are traced one by one
  Hit hit[kPacketMax];
};

// Some samples of the pixels, those of a pixel one after the other.
struct SampleRange {
  std::uint32_t begin, count;  // of a pixel
};

// Pixels of several tiles share a packet up to this number; more are so far apart that their rays pass other boxes:
// packets of up to 64 took 10 % more instructions (cornell, statue; 8 samples).
constexpr std::uint32_t kPixelsTogether = 8;

std::uint32_t samples_together(const FrameData& frame) {
  return frame.lights.sample_points.count > 0 ? 1 : frame.settings.edge_samples;
}

bool traces_packets(const FrameData& frame) { return !frame.geometry.ray_by_ray && frame.view.camera.has_one_origin; }

void find_hits(Tracer* tracer, const SampleRange& samples, EdgePixels* pixels) {
  CHECK(tracer->frame != nullptr && pixels != nullptr);
  const FrameData& frame = *tracer->frame;
  const std::uint32_t count = pixels->count * samples.count;
  CHECK_LE(count, kPacketMax);
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::uint32_t k = i / samples.count, sample = samples.begin + i % samples.count;
    pixels->ray[i] =
        pixel_ray(frame, pixels->column[k], pixels->row[k], rook_point(sample, frame.settings.edge_samples));
  }
  if (traces_packets(frame)) {
    RayPacket& packet = pixels->packet;
    packet.origin = frame.view.camera.eye, packet.t_max = __builtin_inff(), packet.count = count;
    for (std::uint32_t i = 0; i < count; ++i)
      for (int axis = 0; axis < 3; ++axis) packet.direction[axis][i] = pixels->ray[i].direction[axis];
    frame.geometry.first_rays->closest_packet(frame.geometry.accel, packet, visible_filter(frame), pixels->hit,
                                              &tracer->stats);
  } else {
    for (std::uint32_t i = 0; i < count; ++i)
      frame.geometry.first_rays->closest(frame.geometry.accel, pixels->ray[i], visible_filter(frame), &pixels->hit[i],
                                         &tracer->stats);
  }
  if (frame.kept.first_hits)
    for (std::uint32_t i = 0; i < count; ++i)
      keep_first_hit(tracer, 1 + samples.begin + i % samples.count, pixels->column[i / samples.count],
                     pixels->row[i / samples.count], pixels->hit[i]);
}

// Adds the samples, given their hits, to their pixels.
void add_hits(Tracer* tracer, const SampleRange& samples, EdgePixels* pixels, const PixelRows& image) {
  const FrameData& frame = *tracer->frame;
  TileShadows shadows;
  const bool knows_shadows = traces_packets(frame) && frame.kernels.find_shadows != nullptr;
  if (knows_shadows) frame.kernels.find_shadows(tracer, pixels->packet, pixels->hit, &shadows);
  tracer->tile_shadows = knows_shadows ? &shadows : nullptr;
  for (std::uint32_t i = 0; i < pixels->count * samples.count; ++i) {
    const std::uint32_t column = pixels->column[i / samples.count], row = pixels->row[i / samples.count];
    Surface* s = pixels->hit[i].triangle != kNoTriangle ? &shadows.surface[i] : nullptr;
    observe_pixel(tracer, column, row);
    if (s && !knows_shadows) frame.kernels.surface(frame, pixels->ray[i], pixels->hit[i], s);
    if (s && is_interleaved(frame.mask)) take_shared_light(tracer, column, row, s);
    tracer->tile_pixel = i;
    tracer->first_surface = s;
    image.at(column, row) += sample_radiance(tracer, pixels->ray[i], pixels->hit[i], s);
  }
  tracer->first_surface = nullptr;
  tracer->tile_shadows = nullptr;
}

// Adds all samples of the pixels, which have the values of their centres, and takes the means.
void add_samples(Tracer* tracer, EdgePixels* pixels, const PixelRows& image) {
  const FrameData& frame = *tracer->frame;
  const std::uint32_t all = frame.settings.edge_samples, together = samples_together(frame);
  for (std::uint32_t begin = 0; begin < all && pixels->count > 0; begin += together) {
    use_points_of(tracer, 1 + begin);
    find_hits(tracer, {begin, together}, pixels);
    add_hits(tracer, {begin, together}, pixels, image);
  }
  for (std::uint32_t i = 0; i < pixels->count; ++i) {
    Vec3& pixel = image.at(pixels->column[i], pixels->row[i]);
    pixel = pixel * (1 / static_cast<float>(all + 1));
  }
  pixels->count = 0;
}

// Writes a tile's pixels in the mask to the image, and lists those at edges.
void take_tile(const OpenWindow& window, std::uint32_t left, std::uint32_t top, std::uint64_t mask, EdgePixels* pixels,
               const PixelRows& image) {
  const std::uint32_t together = samples_together(*window.tracer->frame);
  const bool keeps_hits = window.tracer->frame->kept.first_hits != nullptr && window.settings().edge_samples > 0;
  DisplayBlock block;
  const bool has_edges = fill_block(window, left, top, &block);
  if (has_edges) display(&block);
  for (; mask; mask &= mask - 1) {
    const auto m = static_cast<std::uint32_t>(__builtin_ctzll(mask));
    const std::uint32_t column = left + morton_column(m), row = top + morton_row(m);
    image.at(column, row) = window.rows.at(column, row);
    if (!has_edges || !is_edge(block, morton_column(m), morton_row(m))) {
      if (keeps_hits) keep_first_hit(window.tracer, 1, column, row, {0, 0, 0, kNotTraced});
      continue;
    }
    CHECK_LT(pixels->count, kPacketMax);
    pixels->column[pixels->count] = static_cast<std::uint16_t>(column);
    pixels->row[pixels->count++] = static_cast<std::uint16_t>(row);
    if ((pixels->count + 1) * together > kPacketMax) add_samples(window.tracer, pixels, image);
  }
}

}  // namespace

Vec2 kept_sample_offset(const Settings& settings, std::uint32_t sample) {
  const std::uint32_t count = settings.samples_per_pixel;
  return sample < count ? rook_point(sample, count) : rook_point(sample - count, settings.edge_samples);
}

void trace_edges(Tracer* tracer, const TileStrip& strip, const PixelRows& image) {
  effect_entered<Effect::edge_sampling>();
  if (strip.tile_count == 0) return;
  CHECK(strip.row_count >= 1 && strip.row_count <= kTileRows);
  AlignedTiles tiles;
  align_tiles(strip, &tiles);
  EdgePixels pixels;
  for (std::uint32_t r = 0; r < 2; ++r) {
    if (std::all_of(tiles.mask[r], tiles.mask[r] + tiles.tile_count, [](std::uint64_t mask) { return mask == 0; }))
      continue;
    const std::uint32_t top = tiles.row + r * kTileSide;
    OpenWindow window = open_window(tracer, top);
    for (std::uint32_t c = 0; c < tiles.tile_count; ++c)
      want_tile(&window, tiles.column + c * kTileSide, top, tiles.mask[r][c]);
    trace_wanted(window);
    for (std::uint32_t c = 0; c < tiles.tile_count; ++c)
      if (tiles.mask[r][c]) {
        take_tile(window, tiles.column + c * kTileSide, top, tiles.mask[r][c], &pixels, image);
        if (pixels.count >= kPixelsTogether) add_samples(tracer, &pixels, image);
      }
    add_samples(tracer, &pixels, image);
  }
}

}  // namespace pocketray
