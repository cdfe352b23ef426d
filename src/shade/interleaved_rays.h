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
  float enough = 0;       // of the light of a group
  Vec3 open = {0, 0, 0};  // the sum of their light
  InterleavedRay sent[kSourcesOfPixelMax];
  InterleavedRays() {}  // leaves them as they are
};

// Source:
//   count
//   kFaint: of a pixel's sources, those that give less than this share of their mean get no ray, and as much of their
//       light arrives as of the others'
//   tolerance: of the rest, neighbours form groups, see each_group()
//   arrives(index, surface, origin, &light, &ray): false if the surface is turned away from it
template <class Source>
void find_sources(const Source& source, const Surface& surface, std::uint32_t place, InterleavedRays* rays) {
  CHECK_LE(source.count, kInterleavedSourceMax);
  rays->count = 0, rays->least = rays->enough = 0, rays->open = {0, 0, 0};
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
  rays->enough = source.tolerance * all;
}

// Sources that share a ray: the brightest one's.
struct RayGroup {
  const InterleavedRay* ray;
  Vec3 light;  // of all of them
  float most;
};

// Sources that follow each other lie close together. Calls visit(group) for groups of them that have the tolerance's
// share of the pixel's light. All light of a group is taken to arrive if its ray does: it is known, and the error is
// less than the tolerance, as a cluster's of Lightcuts [Walter05, sec. 3], since the others have less. A pixel traces
// no more than one ray and the inverse of the tolerance, however many sources there are. Returns the light of the
// fainter ones.
template <class Visit>
Vec3 each_group(const InterleavedRays& rays, Visit visit) {
  Vec3 faint = {0, 0, 0};
  const InterleavedRay *r = rays.sent, *end = r + rays.count;
  if (!(rays.enough > rays.least)) {  // each is a group
    for (; r < end; ++r) {
      if (r->most < rays.least)
        faint += r->light;
      else
        visit(RayGroup{r, r->light, r->most});
    }
    return faint;
  }
  while (r < end) {
    RayGroup group = {r, {0, 0, 0}, 0};
    for (; r < end; ++r) {
      if (r->most < rays.least) {
        faint += r->light;
        continue;
      }
      if (r->most > group.ray->most) group.ray = r;
      group.light += r->light, group.most += r->most;
      if (!(group.most < rays.enough)) {
        ++r;
        break;
      }
    }
    if (group.most > 0) visit(group);
  }
  return faint;
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
    float traced = 0, arrived = 0;
    const Vec3 faint = each_group(found, [&](const RayGroup& group) {
      ++*rays;
      traced += group.most;
      if (frame.first_rays->occluded(frame.accel, group.ray->ray, filter, stats)) return;
      sum->lit += group.light, arrived += group.most;
    });
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
  each_group(found, [&](const RayGroup& group) { rays[count++] = {group.ray->source, group.ray->ray}; });
  return count;
}

}  // namespace pocketray
