// The shadow rays of interleaved sources.
#pragma once
#include "base/check.h"
#include "shade/filters.h"
#include "shade/interleaved.h"

namespace pocketray {

constexpr std::uint32_t kSourcesOfPixelMax = (kVirtualLightRoom + kPatternPixels - 1) / kPatternPixels;
static_assert(kEnvironmentLightMax <= kVirtualLightRoom, "virtual lights are the most sources");
// A source that reaches a pixel if nothing is in the way.
struct InterleavedRay {
  Vec3 light;
  float most;  // its brightest channel
  Ray ray;
};

// Source:
//   count
//   kFaint: of a pixel's sources, those that give less than this share of their mean get no ray, and as much of their
//       light arrives as of the others'
//   arrives(index, surface, origin, &light, &ray): false if the surface is turned away from it
// Rays run to a point each, so that no shaft would hold many: each is traced by itself.
template <class Source>
void gather_interleaved(const FrameData& frame, const InterleavedPoints& points, const Source& source,
                        bool casts_shadows, TraceStats* stats, std::uint64_t* rays, InterleavedLight* light) {
  CHECK_LE(points.count, kPacketMax);
  CHECK_LE(source.count, kSourcesOfPixelMax * kPatternPixels);
  ShadowContext context = {&frame, kNone};
  const HitFilter opaque = {frame.accept_opaque, &context, frame.filters_read_point};
  const HitFilter* filter = frame.filter_every_shadow ? &opaque : nullptr;
  InterleavedRay sent[kSourcesOfPixelMax];
  for (std::uint32_t i = 0; i < points.count; ++i) {
    const Surface& surface = *points.surface[i];
    InterleavedLight* sum = &light[i];
    *sum = InterleavedLight();
    if (is_zero(surface.diffuse)) continue;
    const Vec3 origin = safe_origin(surface, 1);
    std::uint32_t count = 0;
    float all = 0;
    for (std::uint32_t index = points.place[i]; index < source.count; index += kPatternPixels) {
      InterleavedRay* r = &sent[count];
      if (!source.arrives(index, surface, origin, &r->light, &r->ray)) continue;
      r->most = max_component(r->light);
      all += r->most, sum->open += r->light;
      ++count;
    }
    if (!casts_shadows) {
      sum->lit = sum->open;
      continue;
    }
    const float least = count > 0 ? Source::kFaint * all / static_cast<float>(count) : 0;
    Vec3 faint = {0, 0, 0};
    float traced = 0, arrived = 0;
    for (const InterleavedRay* r = sent; r < sent + count; ++r) {
      if (r->most < least) {
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

}  // namespace pocketray
