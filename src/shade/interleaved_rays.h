// The shadow rays of interleaved sources.
#pragma once
#include "base/check.h"
#include "shade/filters.h"
#include "shade/interleaved.h"

namespace pocketray {

// A source that reaches a pixel if nothing is in the way.
struct InterleavedRay {
  Vec3 light;
  float most;  // its brightest channel
  Ray ray;
  std::uint32_t source;
};

// Those of a pixel.
struct InterleavedRays {
  std::uint32_t count = 0;
  float least = 0;        // fainter ones are not traced
  Vec3 open = {0, 0, 0};  // the sum of their light
  InterleavedRay sent[kSourcesOfPixelMax];
  InterleavedRays() {}  // leaves them as they are
};

// Source:
//   count
//   kFaint: of a pixel's sources, those that give less than this share of their mean get no ray, and as much of their
//       light arrives as of the others'
//   arrives(index, surface, origin, &light, &ray): false if the surface is turned away from it
template <class Source>
void find_sources(const Source& source, const Surface& surface, std::uint32_t place, InterleavedRays* rays) {
  CHECK_LE(source.count, kInterleavedSourceMax);
  rays->count = 0, rays->least = 0, rays->open = {0, 0, 0};
  if (is_zero(surface.diffuse)) return;
  const Vec3 origin = safe_origin(surface, 1);
  float all = 0;
  for (std::uint32_t index = place; index < source.count; index += kPatternPixels) {
    InterleavedRay* r = &rays->sent[rays->count];
    if (!source.arrives(index, surface, origin, &r->light, &r->ray)) continue;
    r->most = max_component(r->light), r->source = index;
    all += r->most, rays->open += r->light;
    ++rays->count;
  }
  if (rays->count > 0) rays->least = Source::kFaint * all / static_cast<float>(rays->count);
}

// Rays run to a point each, so that no shaft would hold many: each is traced by itself.
template <class Source>
void gather_interleaved(const FrameData& frame, const InterleavedPoints& points, const Source& source,
                        bool casts_shadows, TraceStats* stats, std::uint64_t* rays, InterleavedLight* light) {
  CHECK_LE(points.count, kPacketMax);
  ShadowContext context = {&frame, kNone};
  const HitFilter opaque = {frame.accept_opaque, &context, frame.filters_read_point};
  const HitFilter* filter = frame.filter_every_shadow ? &opaque : nullptr;
  InterleavedRays found;
  for (std::uint32_t i = 0; i < points.count; ++i) {
    find_sources(source, *points.surface[i], points.place[i], &found);
    InterleavedLight* sum = &light[i];
    *sum = InterleavedLight();
    sum->open = found.open;
    if (!casts_shadows) {
      sum->lit = sum->open;
      continue;
    }
    Vec3 faint = {0, 0, 0};
    float traced = 0, arrived = 0;
    for (const InterleavedRay* r = found.sent; r < found.sent + found.count; ++r) {
      if (r->most < found.least) {
        faint += r->light;
        continue;
      }
      ++*rays;
      traced += r->most;
      if (frame.first_rays->occluded(frame.accel, r->ray, filter, stats)) continue;
      sum->lit += r->light, arrived += r->most;
    }
    if (arrived == traced)
      sum->lit = sum->open;
    else if (arrived > 0)
      sum->lit += faint * (arrived / traced);
  }
}

template <class Source>
std::uint32_t list_source_rays(const Source& source, const Surface& surface, std::uint32_t place, SourceRay* rays) {
  InterleavedRays found;
  find_sources(source, surface, place, &found);
  std::uint32_t count = 0;
  for (const InterleavedRay* r = found.sent; r < found.sent + found.count; ++r)
    if (!(r->most < found.least)) rays[count++] = {r->source, r->ray};
  return count;
}

}  // namespace pocketray
