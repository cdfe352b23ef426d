// Finds interleaved sources (virtual and distant lights) that reach first hits where they did not, or no longer.
#include <algorithm>

#include "base/check.h"
#include "temporal/shadow_rays.h"

namespace pocketray {

Beam source_beam(const InterleavedSource& source, const Vec3& place, const Box& points, float room) {
  const Vec3 around = {room, room, room};
  const Box from = {points.low - around, points.high + around};
  if (source.is_distant) return beam_along(from, {place, place}, __builtin_inff());
  return {from.low, from.high, place - from.low, place - from.high, 1};
}

namespace {

// The beam to several distant sources.
Beam group_beam(const FrameData& frame, const InterleavedSource& source, std::uint32_t begin, std::uint32_t end,
                const TileHits& hits) {
  CHECK(source.is_distant);
  const Vec3 around = {hits.room, hits.room, hits.room};
  Box directions = empty_box();
  for (std::uint32_t i = begin; i < end; ++i) directions = merge(directions, source.place(frame, i));
  return beam_along({hits.points.low - around, hits.points.high + around}, directions, __builtin_inff());
}

}  // namespace

SourceSets suspect_sources(const ChangeSearch& search, const TileHits& hits, const SourceSets* among) {
  const FrameData& frame = *search.frame;
  SourceSets suspects;
  if (!is_interleaved(frame.mask) || is_empty(hits.points) || !search.moving->changed) return suspects;
  for (int kind = 0; kind < kInterleavedSourceCount; ++kind) {
    const InterleavedSource& source = *kInterleavedSources[kind];
    if (!has(frame.mask, source.effect) || (among && !among->of[kind].places)) continue;
    const std::uint32_t count = source.count(frame), group = source.group(frame);
    for (std::uint32_t begin = 0; begin < count; begin += group) {
      const std::uint32_t end = std::min(begin + group, count);
      if (group > 1 && !meets_change(*search.moving, group_beam(frame, source, begin, end, hits))) continue;
      for (std::uint32_t i = begin; i < end; ++i) {
        if (among && !among->of[kind].has(i)) continue;
        if (meets_change(*search.moving, source_beam(source, source.place(frame, i), hits.points, hits.room)))
          suspects.of[kind].add(i, source.place_in_pattern(frame, i));
      }
    }
  }
  return suspects;
}

namespace {

// Adds the pixels with a ray that is blocked where it was not, or no longer, to `given`; forgets the rays.
void find_blocked_otherwise(TileSearch* t, ShadowRays* s) {
  if (s->rays.count == 0) return;
  const FrameData& frame = t->frame;
  const MovingGeometry& m = *t->search.moving;
  ShadowContext shadow = {&frame, nullptr};
  const ShadowFilters filters(m, {frame.filters.every_shadow ? frame.filters.accept_opaque : nullptr, &shadow});
  const HitFilter* filter = frame.filters.every_shadow ? &filters.moving : nullptr;
  const std::uint64_t all = ~std::uint64_t(0) >> (kPacketMax - s->rays.count);
  const std::uint64_t changed =
      blocked_by_moving(m.last, *s, all, filter, t->stats) ^ blocked_by_moving(m.now, *s, all, filter, t->stats);
  const std::uint64_t hidden = blocked_by_scene(frame, *s, changed, &filters.other, t->stats);
  t->counts->moving_rays += 2 * s->rays.count;
  t->counts->static_rays += static_cast<std::uint64_t>(__builtin_popcountll(changed));
  for (std::uint32_t i = 0; i < s->rays.count; ++i)
    if ((changed & ~hidden) >> i & 1) t->given |= s->pixel[i];
  s->rays.count = 0;
}

}  // namespace

void find_other_light(TileSearch* t, const SourceSets& suspects) {
  if (!is_interleaved(t->frame.mask)) return;
  t->given |= t->changed;  // they are no receivers: their rays are not tested
  ShadowRays s;
  s.rays.count = 0;
  SourceRay ray[kSourcesOfPixelMax];
  for (int kind = 0; kind < kInterleavedSourceCount; ++kind) {
    const SourceSet& set = suspects.of[kind];
    for (std::uint32_t k = 0; set.places && k < t->receiver_count; ++k) {
      const std::uint32_t i = t->receiver[k];
      const std::uint32_t place = source_place(t->pixels.x[i], t->pixels.y[i]);
      if (!(set.places >> place_of(place) & 1) || t->given & bit_of(t->pixels, i)) continue;
      const std::uint32_t count = kInterleavedSources[kind]->list_rays(t->frame, surface_of(t, k), place, ray);
      for (std::uint32_t r = 0; r < count; ++r) {
        if (!set.has(ray[r].source)) continue;
        s.pixel[s.rays.count] = bit_of(t->pixels, i);
        set_ray(&s.rays, s.rays.count++, ray[r].ray);
        if (s.rays.count == kPacketMax) find_blocked_otherwise(t, &s);
      }
    }
  }
  find_blocked_otherwise(t, &s);
  t->changed |= t->given;
}

}  // namespace pocketray
