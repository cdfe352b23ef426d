#include "engine/progressive.h"

#include <algorithm>

#include "base/check.h"
#include "engine/trace_frame.h"
#include "shade/strip.h"

namespace pocketray {
namespace {

// Chosen: a batch of 256 pixels takes an ARM926 about 22 ms (`cornell`) and has little overhead. Several threads take
// single tiles, and more of them, since they wait for each other at the end of the batch.
constexpr std::uint32_t kTilesAlone = 4, kTilesPerThread = 8;
constexpr std::uint32_t kTileSpansMax = kTileRows * kTileSide / 2;  // excludes the pixels of a coarser grid

std::uint32_t batch_tiles(const Settings& settings) {
  std::uint32_t tiles = settings.threads > 1 ? kTilesPerThread * settings.threads : kTilesAlone;
  return std::min(tiles, grid_side(settings.width, kTileSide));
}

struct Refinement {
  Renderer* renderer;
  Array<Span> tile_spans;
  Progressive* progressive;
  std::uint32_t batch_end = 0;  // end column of the batch
};

// Returns whether each pixel costs as much without its neighbours as with them.
bool are_pixels_separate(const FrameData& frame) {
  if (frame.kernels.trace_strip) return false;
  return frame.geometry.ray_by_ray || frame.geometry.accel_info->packets_by_rays || !frame.view.camera.has_one_origin;
}
bool leaves_out_coarser(const Refinement& r) {
  return r.progressive->step < kCoarsestStep && !r.progressive->is_afresh && are_pixels_separate(r.renderer->frame);
}

std::uint32_t band_end(const Renderer& renderer, const Progressive& p) {
  return std::min(p.row + kTileRows, grid_side(renderer.settings.height, p.step));
}

// Lists the pixels of a row of the grid, optionally without those on a coarser grid.
std::uint32_t list_row(std::uint32_t row, std::uint32_t begin, std::uint32_t end, bool without_coarser, Span* spans) {
  const auto y = static_cast<std::uint16_t>(row);
  if (!without_coarser || row % 2 == 1) {
    *spans = {y, static_cast<std::uint16_t>(begin), static_cast<std::uint16_t>(end)};
    return 1;
  }
  std::uint32_t count = 0;
  for (std::uint32_t x = begin | 1; x < end; x += 2)
    spans[count++] = {y, static_cast<std::uint16_t>(x), static_cast<std::uint16_t>(x + 1)};
  return count;
}

// Takes the next tiles of a band, in the order in which threads take them.
void next_tiles(void* context, SpanBatch* batch) {
  Refinement* r = static_cast<Refinement*>(context);
  const Progressive& p = *r->progressive;
  const Settings& settings = r->renderer->settings;
  const std::uint32_t width = grid_side(settings.width, p.step), bottom = band_end(*r->renderer, p);
  const std::uint32_t packed = kTileRows / (bottom - p.row);  // tiles of few rows share a packet
  const std::uint32_t tiles = batch_tiles(settings) * packed, taken_tiles = settings.threads > 1 ? packed : tiles;
  const bool without_coarser = leaves_out_coarser(*r);
  r->batch_end = std::min(p.column + tiles * kTileSide, width);
  batch->spans = r->tile_spans.data;
  batch->pitch = p.step;
  for (std::uint32_t left = p.column, right; left < r->batch_end; left = right) {
    right = std::min(left + taken_tiles * kTileSide, r->batch_end);
    for (std::uint32_t row = p.row; row < bottom; ++row)
      batch->span_count += list_row(row, left, right, without_coarser, r->tile_spans.data + batch->span_count);
    if (batch->spans_at_once == 0) batch->spans_at_once = batch->span_count;
  }
  CHECK_LE(batch->span_count, r->tile_spans.count);
}

// Copies each traced pixel to its whole cell.
void fill_cells(void* context, const SpanBatch& batch) {
  const Renderer& renderer = *static_cast<Refinement*>(context)->renderer;
  const std::uint32_t step = batch.pitch;
  if (step == 1) return;
  const Settings& settings = renderer.settings;
  for (std::uint32_t i = 0; i < batch.span_count; ++i) {
    const Span& span = batch.spans[i];
    const std::uint32_t top = span.row * step, bottom = std::min(top + step, settings.height);
    for (std::uint32_t left = span.column_begin * step; left < span.column_end * step; left += step) {
      const Vec3 value = renderer.image[static_cast<std::size_t>(top) * settings.width + left];
      const std::uint32_t right = std::min(left + step, settings.width);
      for (std::uint32_t y = top; y < bottom; ++y)
        std::fill_n(renderer.image.data + static_cast<std::size_t>(y) * settings.width + left, right - left, value);
    }
  }
}

// Rows traced together get equal shares.
void add_row_costs(const Renderer& renderer, const Progressive& p, std::uint64_t took_ns) {
  if (!p.row_ns) return;
  const std::uint32_t bottom = band_end(renderer, p), count = bottom - p.row;
  for (std::uint32_t row = p.row; row < bottom; ++row)
    p.row_ns[row * p.step] += took_ns / count + (row == p.row ? took_ns % count : 0);
}

void mark_dirty(Progressive* p, std::uint32_t begin, std::uint32_t end) {
  if (p->dirty_begin == p->dirty_end) p->dirty_begin = begin;
  p->dirty_begin = std::min(p->dirty_begin, begin);
  p->dirty_end = std::max(p->dirty_end, end);
}

// Pixels of the batch that the coarsest grid has already shown: one per tile.
std::uint32_t known_pixels(const Refinement& r) {
  if (r.progressive->step == kCoarsestStep || r.progressive->is_afresh || leaves_out_coarser(r)) return 0;
  return grid_side(r.batch_end, kTileSide) - grid_side(r.progressive->column, kTileSide);
}

bool finish_tiles(void* context, const SpanBatch& batch) {
  const Refinement& r = *static_cast<Refinement*>(context);
  const Renderer& renderer = *r.renderer;
  Progressive* p = r.progressive;
  CHECK_GT(p->step, 0u);
  p->pixels_traced += span_pixel_count(batch.spans, batch.span_count) - known_pixels(r);
  p->trace_ns += batch.took_ns;
  add_row_costs(renderer, *p, batch.took_ns);
  const std::uint32_t bottom = band_end(renderer, *p);
  mark_dirty(p, p->row * p->step, std::min(bottom * p->step, renderer.settings.height));
  p->column = r.batch_end;
  if (p->column < grid_side(renderer.settings.width, p->step)) return false;
  p->column = 0;
  p->row = bottom;
  if (p->row < grid_side(renderer.settings.height, p->step)) return false;
  p->row = 0;
  p->shown_coarse = true;
  p->step = p->step == 1 ? 0 : are_pixels_separate(renderer.frame) ? p->step / 2 : 1;
  return p->step == 0;
}

}  // namespace

std::uint32_t progressive_spans_max(const Settings& settings) { return kTileSpansMax * batch_tiles(settings); }

bool advance_progressive(Renderer* renderer, Array<Span> tile_spans, std::uint64_t deadline_ns,
                         Progressive* progressive) {
  CHECK_GE(tile_spans.count, progressive_spans_max(renderer->settings));
  if (progressive->step == 0) return true;
  CHECK_LE(progressive->step, kCoarsestStep);
  CHECK_LT(progressive->row * progressive->step, renderer->settings.height);
  CHECK_LT(progressive->column * progressive->step, renderer->settings.width);
  Refinement refinement = {renderer, tile_spans, progressive};
  SpanSource source = {&refinement, next_tiles, finish_tiles, fill_cells};
  source.deadline_ns = deadline_ns;
  return trace_frame(renderer, source);
}

std::uint32_t finished_rows(const Renderer& renderer, const Progressive& progressive) {
  if (progressive.step == 0) return renderer.settings.height;
  return progressive.step == 1 ? progressive.row : 0;
}

bool take_dirty_rows(Progressive* progressive, std::uint32_t* begin, std::uint32_t* end) {
  CHECK(begin != nullptr && end != nullptr);
  if (progressive->dirty_begin >= progressive->dirty_end) return false;
  *begin = progressive->dirty_begin;
  *end = progressive->dirty_end;
  progressive->dirty_begin = progressive->dirty_end = 0;
  return true;
}

}  // namespace pocketray
