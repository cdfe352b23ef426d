#include "temporal/shared_script.h"

#include <algorithm>
#include <cstring>

namespace pocketray {
namespace {

struct Batch {
  SharedSpans spans;
};

void trace(Renderer* renderer, const SharedSpans& spans) {
  Batch batch = {spans};
  SpanSource source = {&batch,
                       [](void* context, SpanBatch* next) {
                         const SharedSpans& s = static_cast<Batch*>(context)->spans;
                         next->spans = s.spans, next->span_count = s.count;
                       },
                       [](void*, const SpanBatch&) { return true; }};
  trace_frame(renderer, source);
}

// Traces one row in parts, or some of them at once; returns how many, from `row` on.
std::uint32_t trace_some(Renderer* renderer, std::uint32_t row, std::uint32_t end, Rng* rng) {
  const std::uint32_t width = renderer->settings.width;
  if (next_u32(rng) % 4 != 0) {
    const std::uint32_t most = std::min(end - row, listed_rows_max(*renderer));
    const std::uint32_t count = 1 + next_u32(rng) % std::min(most, 12u);
    trace(renderer, list_rows(renderer, row, row + count));
    return count;
  }
  if (count_pixels(*renderer, row) == 0) return 1;
  for (std::uint32_t column = 0; column < width;) {
    const std::uint32_t most = 1 + next_u32(rng) % 9, part_end = end_of_part(*renderer, row, column, most);
    const SharedSpans part = list_part(renderer, row, column, part_end);
    if (part.count == 0 || span_pixel_count(part.spans, part.count) > most) return 0;  // never
    trace(renderer, part);
    column = part_end;
  }
  return 1;
}

}  // namespace

bool follow_shared(Renderer* renderer, const Renderer& whole, double seconds, Rng* rng, SharedScript* script) {
  const std::uint32_t width = renderer->settings.width, height = renderer->settings.height;
  const std::uint32_t move = next_u32(rng) % 8;
  if (move == 0) script->boundary = next_u32(rng) % height, script->below = next_u32(rng) % 2 != 0;
  if (move == 1) script->boundary = std::min(height - 1, script->boundary + next_u32(rng) % 5);
  if (move == 2) script->boundary -= std::min(script->boundary, next_u32(rng) % 5);
  std::uint32_t begin = script->below ? script->boundary : 0, end = script->below ? height : script->boundary + 1;
  // A device asks for nothing in advance: it may trace any row.
  const bool any = next_u32(rng) % 2 == 0;
  FrameTask task = {seconds, FramePurpose::shared_rows};
  if (!any) task.rows = {begin, end};
  if (!begin_frame(renderer, task).ok) return false;
  while (!search_shared_rows(renderer, next_u32(rng) % 3 == 0 ? 1 : 600))
    if (next_u32(rng) % 64 == 0) return true;  // given up
  if (next_u32(rng) % 8 == 0) end = begin + 1 + next_u32(rng) % (end - begin);
  for (std::uint32_t row = begin; row < end;) {
    const std::uint32_t count = trace_some(renderer, row, end, rng);
    if (count == 0) return false;
    finish_shared_rows(renderer, row, row + count);
    const std::size_t at = std::size_t(row) * width;
    if (std::memcmp(renderer->image.data + at, whole.image.data + at, std::size_t(count) * width * sizeof(Vec3)) != 0)
      return false;
    for (std::uint32_t i = 0; i < count; ++i) script->pixels_traced += count_pixels(*renderer, row + i);
    script->rows += count, script->pixels += std::uint64_t(count) * width;
    row += count;
  }
  return true;
}

}  // namespace pocketray
