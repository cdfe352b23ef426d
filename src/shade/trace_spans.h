// The only entry point: spans in, radiance out.
#pragma once
#include "base/span.h"
#include "shade/frame_data.h"
#include "shade/tracer.h"

namespace pocketray {

// The quantity that --aov writes instead of colour; indirect_light is only for devices that share frames by effect.
// position: in the model's own coordinates, zero where nothing is hit.
enum class Aov { none, depth, normal, triangle, position, cost, indirect_light };

// Creates a tracer for the frame.
Tracer make_tracer(const FrameData& frame);

// Spans are best passed in groups: those within this many rows are traced in tiles of up to 8 × 8 pixels, whichever
// pixels they contain. The picture does not depend on the grouping.
constexpr std::uint32_t kTileRows = 8;
// Number of every `pitch`-th pixels along a side.
constexpr std::uint32_t grid_side(std::uint32_t side, std::uint32_t pitch) { return (side + pitch - 1) / pitch; }
// Number of leading spans that lie within kTileRows rows of the first one's row.
std::uint32_t strip_span_count(const Span* spans, std::uint32_t span_count);

// Traces the spans into `image`: width × height linear radiances, row 0 on top, indexed as the whole frame. Rows and
// columns of the spans count every `pitch`-th one of the picture, from its first pixel on. AOVs: depth is the distance
// along the ray (0 without a hit), normal the world-space shading normal, triangle the id + 1 (0: none), cost the
// number of boxes and triangles visited by all rays of the pixel, each traced separately; scalars fill all three
// channels; indirect_light as in indirect_light.h.
void trace_spans(Tracer* tracer, const Span* spans, std::uint32_t span_count, Aov aov, Vec3* image,
                 std::uint32_t pitch = 1);

// Sample position inside a pixel, in [0, 1)²: the centre for one sample, an even pattern for more.
Vec2 sample_offset(std::uint32_t sample, std::uint32_t sample_count);

}  // namespace pocketray
