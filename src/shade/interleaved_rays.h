// The shadow rays of many sources: of a sixteenth, which interleaved pixels have, or of all.
#pragma once
#include "base/check.h"
#include "shade/filters.h"
#include "shade/interleaved.h"

namespace pocketray {

// A source that reaches a surface if nothing is in the way.
// The indices first, first + 16, … below a count, or all.
template <std::uint32_t step>
struct SteppedIndices {
  std::uint32_t first, count;
  SteppedIndices(std::uint32_t begin, std::uint32_t end)
      : first(begin), count(begin < end ? (end - begin - 1) / step + 1 : 0) {}
  std::uint32_t operator[](std::uint32_t k) const { return first + step * k; }
};

struct SentLight {
  Vec3 light;
  float most;  // its brightest channel
  std::uint32_t source;
};

// Those of a surface.
template <std::uint32_t capacity>
struct SentLights {
  std::uint32_t count = 0;
  float least = 0;        // fainter ones are not traced
  float enough = 0;       // of the light of a group
  Vec3 open = {0, 0, 0};  // the sum of their light
  Vec3 origin;            // of shadow rays
  SentLight sent[capacity];
  SentLights() {}  // leaves them as they are
};
using PixelLights = SentLights<kSourcesOfPixelMax>;

// Source:
//   kFaint: of a surface's sources, those that give less than this share of their mean get no ray, and as much of their
//       light arrives as of the others'
//   tolerance: of the rest, neighbours form groups, see each_group()
//   arrives(index, surface, &light): false if the surface is turned away from it
//   ray(index, surface, origin): the shadow ray to it from the surface's safe origin
//   of_place(place): the sources of a place in the pattern, with their count and, by [], indices
// Finds those of the indices that light the surface.
template <class Source, class Indices, std::uint32_t capacity>
void find_sources(const Source& source, const Surface& surface, const Indices& indices, SentLights<capacity>* rays) {
  CHECK_LE(indices.count, capacity);
  rays->count = 0, rays->least = rays->enough = 0, rays->open = {0, 0, 0};
  if (is_zero(surface.diffuse)) return;
  rays->origin = safe_origin(surface, 1);
  float all = 0;
  for (std::uint32_t k = 0; k < indices.count; ++k) {
    const std::uint32_t index = indices[k];
    SentLight* r = &rays->sent[rays->count];
    if (!source.arrives(index, surface, &r->light)) continue;
    r->most = max_component(r->light), r->source = index;
    all += r->most, rays->open += r->light;
    ++rays->count;
  }
  if (rays->count > 0) rays->least = Source::kFaint * all / static_cast<float>(rays->count);
  rays->enough = source.tolerance * all;
}

// Sources that share a ray: the brightest one's.
struct RayGroup {
  const SentLight* sent;
  Vec3 light;  // of all of them
  float most;
};

// Sources that follow each other lie close together. Calls visit(group) for groups of them that have the tolerance's
// share of the surface's light. All light of a group is taken to arrive if its ray does: it is known, and the error is
// less than the tolerance, as a cluster's of Lightcuts [Walter05, sec. 3], since the others have less. A surface traces
// no more than one ray and the inverse of the tolerance, however many sources there are. Returns the light of the
// fainter ones.
template <std::uint32_t capacity, class Visit>
Vec3 each_group(const SentLights<capacity>& rays, Visit visit) {
  Vec3 faint = {0, 0, 0};
  const SentLight *r = rays.sent, *end = r + rays.count;
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
      if (r->most > group.sent->most) group.sent = r;
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

// The light that arrives, `is_blocked(ray)` telling what does not.
template <class Source, std::uint32_t capacity, class IsBlocked>
[[gnu::always_inline]] inline Vec3 arriving_light(const Source& source, const Surface& surface,
                                                  const SentLights<capacity>& found, IsBlocked is_blocked) {
  Vec3 lit = {0, 0, 0};
  float traced = 0, arrived = 0;
  const Vec3 faint = each_group(found, [&](const RayGroup& group) {
    traced += group.most;
    if (is_blocked(source.ray(group.sent->source, surface, found.origin))) return;
    lit += group.light, arrived += group.most;
  });
  if (arrived == traced) return found.open;
  return arrived > 0 ? lit + faint * (arrived / traced) : lit;
}

// Rays run to a point each, so that no shaft would hold many: each is traced by itself.
template <class Source>
void gather_interleaved(const FrameData& frame, const InterleavedPoints& points, const Source& source,
                        bool casts_shadows, TraceStats* stats, std::uint64_t* rays, InterleavedLight* light) {
  CHECK_LE(points.count, kPacketMax);
  ShadowContext context = {&frame, kNone};
  const HitFilter opaque = {frame.accept_opaque, &context, frame.filters_read_point};
  const HitFilter* filter = frame.filter_every_shadow ? &opaque : nullptr;
  PixelLights found;
  for (std::uint32_t i = 0; i < points.count; ++i) {
    find_sources(source, *points.surface[i], source.of_place(points.place[i]), &found);
    light[i] = InterleavedLight();
    light[i].open = light[i].lit = found.open;
    if (!casts_shadows) continue;
    light[i].lit = arriving_light(source, *points.surface[i], found, [&](const Ray& ray) {
      ++*rays;
      return frame.first_rays->occluded(frame.accel, ray, filter, stats);
    });
  }
}

template <class Source>
std::uint32_t list_source_rays(const Source& source, const Surface& surface, std::uint32_t place, SourceRay* rays) {
  PixelLights found;
  find_sources(source, surface, source.of_place(place), &found);
  std::uint32_t count = 0;
  each_group(found, [&](const RayGroup& group) {
    rays[count++] = {group.sent->source, source.ray(group.sent->source, surface, found.origin)};
  });
  return count;
}

}  // namespace pocketray
