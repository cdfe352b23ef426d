// Finds rays of compensation that meet something different than in the last frame, or find it in different shadow.
// Their ends are kept, so that narrow beams enclose them: a beam that meets no change rules out its ray, and rays that
// meet one are traced again.
#include <algorithm>

#include "base/check.h"
#include "temporal/tile_search.h"

namespace pocketray {
namespace {

// Beam of rays from points to ends; both may be offset as far as shadow rays may start from their points.
Beam path_beam(const Box& points, const Box& ends, float room) {
  const Vec3 around = {room, room, room};
  return {points.low - around, points.high + around, ends.low - points.low, ends.high - points.high, 1};
}

// Largest offset of a shadow ray from a ray's end, in each coordinate, as in measure_tile().
float room_at_end(const FrameData& frame) {
  return max_component(max(abs(frame.geometry.accel.bounds.low), abs(frame.geometry.accel.bounds.high))) * 0x1p-15f;
}

const LightRun& run_of(const FrameData& frame, std::uint32_t light) {
  int r = 0;
  while (r < frame.lights.run_count && light >= frame.lights.runs[r].end) ++r;
  CHECK_LT(r, frame.lights.run_count);
  return frame.lights.runs[r];
}

bool lights_meet_change(const ChangeSearch& search, std::uint32_t light, const Box& ends) {
  const FrameData& frame = *search.frame;
  return meets_change(*search.moving,
                      shadow_beam(run_of(frame, light), frame.lights.points[light], ends, room_at_end(frame)));
}

bool virtual_lights_meet_change(const ChangeSearch& search, std::uint32_t light, const Box& ends) {
  const FrameData& frame = *search.frame;
  return meets_change(*search.moving, source_beam(kVirtualLightSource, kVirtualLightSource.place(frame, light), ends,
                                                  room_at_end(frame)));
}

}  // namespace

PathSuspects suspect_paths(const ChangeSearch& search, const TileHits& hits, const Box& ends,
                           const PathSuspects* among) {
  PathSuspects suspects;
  const FrameData& frame = *search.frame;
  if (!search.paths || is_empty(ends) || is_empty(hits.points) || !search.moving->changed) return suspects;
  const float room = std::max(hits.room, room_at_end(frame));
  suspects.first = (!among || among->first) && meets_change(*search.moving, path_beam(hits.points, ends, room));
  suspects.any = suspects.first;
  if (!has(frame.mask, Effect::shadow)) return suspects;
  for (std::uint32_t i = 0; i < std::min(frame.lights.points.count, kSuspectLights); ++i)
    if ((!among || among->lights >> i & 1) && lights_meet_change(search, i, ends))
      suspects.lights |= std::uint64_t(1) << i;
  const std::uint32_t count = kVirtualLightSource.count(frame);
  for (std::uint32_t i = 0; i < count; ++i)
    if ((!among || among->virtual_lights.has(i)) && virtual_lights_meet_change(search, i, ends))
      suspects.virtual_lights.add(i, i % kPatternPixels);
  suspects.any =
      suspects.first || suspects.lights || suspects.virtual_lights.places || frame.lights.points.count > kSuspectLights;
  return suspects;
}

Box measure_path_ends(const FrameData& frame, const Hit* first_hits, const KeptPath* paths, const PixelRect& tile,
                      std::uint64_t known) {
  const Settings& settings = frame.settings;
  Box ends = empty_box();
  const std::uint32_t right = std::min(tile.column + tile.width, settings.width),
                      bottom = std::min(tile.row + tile.height, settings.height);
  for (std::uint32_t sample = 0; sample < settings.samples_per_pixel; ++sample)
    for (std::uint32_t y = tile.row; y < bottom; ++y) {
      const std::size_t line = (std::size_t(sample) * settings.height + y) * settings.width;
      for (std::uint32_t x = tile.column; x < right; ++x)
        if (known >> (kChangeTileSide * (y - tile.row) + x - tile.column) & 1 &&
            first_hits[line + x].triangle != kNoTriangle)
          ends = merge(ends, load(paths[line + x]).end);
    }
  return ends;
}

void find_other_paths(TileSearch* t, std::uint32_t sample, const TileHits& hits, const PathSuspects& suspects) {
  const ChangeSearch& search = t->search;
  const Settings& settings = t->frame.settings;
  const float room = std::max(hits.room, room_at_end(t->frame));
  const KeptPath* paths = search.paths + std::size_t(sample) * settings.width * settings.height;
  for (std::uint32_t k = 0; k < t->receiver_count; ++k) {
    const std::uint32_t i = t->receiver[k];
    if (t->given & bit_of(t->pixels, i)) continue;
    const CompensationPath path = load(paths[index_of(settings, t->pixels, i)]);
    const Box point = {t->point[k], t->point[k]}, end = {path.end, path.end};
    const std::uint32_t light = path.light, virtual_light = path.virtual_light;
    const bool is_suspect = light < kSuspectLights ? suspects.lights >> light & 1 : light != kNoPathLight;
    if ((suspects.first && meets_change(*search.moving, path_beam(point, end, room))) ||
        (is_suspect && lights_meet_change(search, light, end)) ||
        (virtual_light != kNoPathLight && suspects.virtual_lights.has(virtual_light) &&
         virtual_lights_meet_change(search, virtual_light, end)))
      t->given |= bit_of(t->pixels, i);
  }
  t->changed |= t->given;
}

}  // namespace pocketray
