// The shadow rays of many sources: of a sixteenth, which interleaved pixels have, or of all.
#pragma once
#include <cstring>
#include <limits>

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
  float least = 0;        // fainter ones have no rays of their own
  float enough = 0;       // of the light of a group
  float place = .5f;      // in a group, of the source that stands for it
  Vec3 open = {0, 0, 0};  // the sum of their light
  Vec3 origin;            // of shadow rays
  SentLight sent[capacity];
  SentLights() {}  // leaves them as they are
};
using PixelLights = SentLights<kSourcesOfPixelMax>;

// Uniform in [0, 1), at random over surfaces, but fixed on them.
inline float random_place(const SurfacePlace& hit) {
  std::uint32_t u, v;
  std::memcpy(&u, &hit.u, sizeof u), std::memcpy(&v, &hit.v, sizeof v);
  std::uint32_t hash = (u * 0x9E3779B1u ^ v) * 0x85EBCA77u ^ hit.triangle * 0xC2B2AE3Du;
  hash = (hash ^ hash >> 15) * 0x2C1B3C6Du;
  hash = (hash ^ hash >> 12) * 0x297A2D39u;
  return static_cast<float>((hash ^ hash >> 15) >> 8) * 0x1p-24f;
}

// Source:
//   kFaint: of a surface's sources, those that give less than this share of their mean share a ray if the tolerance is
//       less
//   tolerance: neighbours form groups, see each_group()
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
  rays->place = random_place(surface.hit);
}

// Sources that share the ray of one of them.
struct RayGroup {
  const SentLight* sent;
  Vec3 light;  // of all of them
  float most;
};

// Sources of a group: those below `most`. The others have rays of their own.
struct GroupRange {
  float most;
  bool contains(const SentLight& r) const { return r.most < most; }
};

// The source whose ray stands for a group, which begins at `first` and has `all` light: the one at a place in it, so
// that each is picked by its share of the light. The brightest would favour what a surface sees close by over what is
// hidden: in a room whose lamp also lights the gap between it and the ceiling, the error grew with the number of
// sources.
template <std::uint32_t capacity>
const SentLight* representative(const SentLights<capacity>& rays, const GroupRange& range, const SentLight* first,
                                float all) {
  float left = rays.place * all;
  const SentLight *found = first, *end = rays.sent + rays.count;
  for (const SentLight* r = first; r < end; ++r) {
    if (!range.contains(*r)) continue;
    found = r;
    if (left < r->most) break;
    left -= r->most;
  }
  return found;
}

// Sources that follow each other lie close together. Calls visit(group) for groups of them that have the tolerance's
// share of the surface's light; without a tolerance, for each and for a group of the faint. All light of a group is
// taken to arrive if its ray does, on average as much as does: a cluster's of Lightcuts [Walter05, sec. 3], whose
// representative is picked at random. A surface traces no more than one ray and the inverse of the tolerance, however
// many sources there are.
template <std::uint32_t capacity, class Visit>
void each_group(const SentLights<capacity>& rays, Visit visit) {
  constexpr float kAll = std::numeric_limits<float>::infinity();
  const bool by_tolerance = rays.enough > rays.least;
  const GroupRange range = {by_tolerance ? rays.enough : rays.least};
  const float enough = by_tolerance ? rays.enough : kAll;
  const SentLight *r = rays.sent, *end = r + rays.count;
  while (r < end) {
    RayGroup group = {nullptr, {0, 0, 0}, 0};
    for (; r < end && group.most < enough; ++r) {
      if (!range.contains(*r)) {
        visit(RayGroup{r, r->light, r->most});
        continue;
      }
      if (!group.sent) group.sent = r;
      group.light += r->light, group.most += r->most;
    }
    if (!group.sent) continue;
    group.sent = representative(rays, range, group.sent, group.most);
    visit(group);
  }
}

// The light that arrives, `is_blocked(ray)` telling what does not.
template <class Source, std::uint32_t capacity, class IsBlocked>
[[gnu::always_inline]] inline Vec3 arriving_light(const Source& source, const Surface& surface,
                                                  const SentLights<capacity>& found, IsBlocked is_blocked) {
  Vec3 lit = {0, 0, 0};
  bool all = true;
  each_group(found, [&](const RayGroup& group) {
    if (is_blocked(source.ray(group.sent->source, surface, found.origin)))
      all = false;
    else
      lit += group.light;
  });
  return all ? found.open : lit;
}

// Rays run to a point each, so that no shaft would hold many: each is traced by itself.
template <class Source>
void gather_interleaved(const FrameData& frame, const InterleavedPoints& points, const Source& source,
                        bool casts_shadows, TraceStats* stats, std::uint64_t* rays, InterleavedLight* light) {
  CHECK_LE(points.count, kPacketMax);
  ShadowContext context = {&frame, nullptr};
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
