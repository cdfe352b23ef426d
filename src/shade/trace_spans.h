// The sole entry: spans in, radiance out.
#pragma once
#include "base/span.h"
#include "shade/frame_data.h"

namespace pocketray {

// Which quantity --aov writes instead of colour.
enum class Aov { none, depth, normal, triangle, cost };

// Makes a tracer ready for a frame.
Tracer make_tracer(const FrameData& frame);

// Spans that are best handed over together: those of as many rows are traced in tiles of up to 8 × 8 pixels, whichever
// pixels they have of them. The picture is the same however spans are handed over.
constexpr std::uint32_t kTileRows = 8;
// How many of the spans, from the first on, lie within kTileRows rows from its row on.
std::uint32_t strip_span_count(const Span* spans, std::uint32_t span_count);

// Traces the spans into `image`: width × height linear radiances, row 0 on top, whole frame addressed. With an AOV:
// depth is the distance along the ray (0 where nothing is hit), normal the world shading normal, triangle the id + 1
// (0: none), cost the boxes and triangles visited by all rays of the pixel, each traced by itself; one value in all
// three channels.
void trace_spans(Tracer* tracer, const Span* spans, std::uint32_t span_count, Aov aov, Vec3* image);

// Sample positions inside a pixel, in [0, 1)²: the centre for one, an even pattern for more.
Vec2 sample_offset(std::uint32_t sample, std::uint32_t sample_count);

}  // namespace pocketray
