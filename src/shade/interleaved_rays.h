// Shadow rays to many sources: to a sixteenth of them for interleaved pixels, or to all.
#pragma once
#include <cstring>
#include <limits>

#include "base/check.h"
#include "shade/filters.h"
#include "shade/interleaved.h"

namespace pocketray {

// The indices first, first + 16, … below a count, or all.
template <std::uint32_t step>
struct SteppedIndices {
  std::uint32_t first, count;
  SteppedIndices(std::uint32_t begin, std::uint32_t end)
      : first(begin), count(begin < end ? (end - begin - 1) / step + 1 : 0) {}
  std::uint32_t operator[](std::uint32_t k) const { return first + step * k; }
};

// A source that reaches a surface if nothing is in the way.
struct SentLight {
  Vec3 light;
  float most;  // its brightest channel
  std::uint32_t source;
};

// Unblocked light from the sources that reach a surface.
template <std::uint32_t capacity>
struct SentLights {
  std::uint32_t count = 0;
  float least = 0;        // sources fainter than this have no ray of their own
  float enough = 0;       // light of a complete group
  float place = .5f;      // position within a group of the source that represents it
  Vec3 open = {0, 0, 0};  // sum of their light
  Vec3 origin;            // of their shadow rays
  SentLight sent[capacity];
  SentLights() {}  // skips initialization
};
using PixelLights = SentLights<kSourcesOfPixelMax>;

// Random number in [0, 1), uniform over surfaces but fixed at each point.
inline float random_place(const SurfacePlace& hit) {
  std::uint32_t u, v;
  std::memcpy(&u, &hit.u, sizeof u), std::memcpy(&v, &hit.v, sizeof v);
  std::uint32_t hash = (u * 0x9E3779B1u ^ v) * 0x85EBCA77u ^ hit.triangle * 0xC2B2AE3Du;
  hash = (hash ^ hash >> 15) * 0x2C1B3C6Du;
  hash = (hash ^ hash >> 12) * 0x297A2D39u;
  return static_cast<float>((hash ^ hash >> 15) >> 8) * 0x1p-24f;
}

// A Source has:
//   kFaint: sources below this fraction of the mean over a surface's sources share a ray
//       if the tolerance is smaller
//   tolerance: neighbouring sources form groups, see each_group()
//   arrives(index, surface, &light): false if the surface faces away from the source
//   ray(index, surface, origin): the shadow ray to it from the surface's safe origin
//   of_place(place): the sources of a pixel by its source_place(), with their count and, by [], indices
// Finds which of the sources `indices` light the surface.
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

// Sources that share one shadow ray.
struct RayGroup {
  const SentLight* sent;
  Vec3 light;  // total of the group
  float most;
};

// Selects the sources of a group: those below `most`. The others have rays of their own.
struct GroupRange {
  float most;
  bool contains(const SentLight& r) const { return r.most < most; }
};

// Picks the source whose ray represents a group that begins at `first` and has `all` light: each in
// proportion to its share of the light. Picking the brightest would favour nearby sources over hidden ones:
// in a room whose lamp also lights the gap between it and the ceiling, the error grew with the number of
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

// Calls visit(group) for groups of consecutive sources, which lie close together. A group holds the tolerance's
// share of the surface's light; without a tolerance, each source forms a group, and so do all faint ones. A group
// arrives whole if its ray does, which is right on average: a cluster of Lightcuts [Walter05, sec. 3] with a random
// representative. A surface traces at most one ray plus the inverse of the tolerance, however many sources there
// are.
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

// Light that arrives; `is_blocked(ray)` tests shadow rays.
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

// Each ray goes to a different point, so few would share a shaft: each is traced by itself.
template <class Source>
void gather_interleaved(const FrameData& frame, const InterleavedPoints& points, const Source& source,
                        bool casts_shadows, TraceStats* stats, std::uint64_t* rays, InterleavedLight* light) {
  CHECK_LE(points.count, kPacketMax);
  ShadowContext context = {&frame, nullptr};
  const HitFilter opaque = {frame.filters.accept_opaque, &context, frame.filters.read_point};
  const HitFilter* filter = frame.filters.every_shadow ? &opaque : nullptr;
  PixelLights found;
  for (std::uint32_t i = 0; i < points.count; ++i) {
    find_sources(source, *points.surface[i], source.of_place(points.place[i]), &found);
    light[i] = InterleavedLight();
    light[i].open = light[i].lit = found.open;
    if (!casts_shadows) continue;
    light[i].lit = arriving_light(source, *points.surface[i], found, [&](const Ray& ray) {
      ++*rays;
      return frame.geometry.first_rays->occluded(frame.geometry.accel, ray, filter, stats);
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
