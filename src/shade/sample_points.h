// Light points of a pixel's samples. Each sample has points of its own on area lights, so that 4 samples of 4 points
// see a penumbra as 16 points do. The centre of a pixel with samples at edges has the points of pixels without.
#pragma once
#include "shade/frame_data.h"
#include "shade/polygon_light.h"
#include "shade/tracer.h"

namespace pocketray {

// Number of samples that have points of their own.
constexpr std::uint32_t point_set_count(const Settings& settings, EffectMask mask) {
  if (!has(mask, Effect::area_light)) return 0;
  if (settings.samples_per_pixel > 1) return settings.samples_per_pixel;
  return has(mask, Effect::edge_sampling) ? settings.edge_samples : 0;
}

// Number of points for which memory is planned: enough for any number of samples, which may change later.
constexpr std::uint32_t sample_point_count(EffectMask mask, std::uint32_t light_points) {
  return has(mask, Effect::area_light) ? kSampleCountMax * light_points : 0;
}

// Returns the points of a sample, in the order of kept_sample_offset(), among two arrays like Lights::points and
// Lights::sample_points.
inline const LightPoint* points_of_sample(const FrameData& frame, std::uint32_t sample, Array<const LightPoint> points,
                                          Array<const LightPoint> sample_points) {
  const std::uint32_t centres = frame.settings.samples_per_pixel == 1;
  if (frame.lights.sample_points.empty() || sample < centres) return points.data;
  return &sample_points[(sample - centres) * frame.lights.points.count];
}
inline const LightPoint* points_of_sample(const FrameData& frame, std::uint32_t sample) {
  return points_of_sample(frame, sample, frame.lights.points, frame.lights.sample_points);
}

// Number of points of a lamp that a sample sees. Samples at an edge, beside their pixel's centre, see few; the others
// of their lamp's points send no light.
constexpr std::uint32_t kEdgePoints = 4;
constexpr bool sees_few_points(const Settings& settings, EffectMask mask) {
  return has(mask, Effect::edge_sampling) && settings.samples_per_pixel == 1 && takes_lamps_whole(settings, mask) &&
         settings.points_per_area_light > kEdgePoints;
}
constexpr std::uint32_t points_of_lamp(const Settings& settings, EffectMask mask, std::uint32_t sample) {
  return sample > 0 && sees_few_points(settings, mask) ? kEdgePoints : settings.points_per_area_light;
}

// Returns whether the sample being traced sees all of its lamps' points, in groups.
inline bool is_grouped(const Tracer& tracer) {
  const PointGroups& groups = tracer.frame->lights.point_groups;
  return groups.groups.count > 0 && tracer.points_of_lamp == groups.points_of_light;
}

// Has the tracer use the points of a sample from now on.
inline void use_points_of(Tracer* tracer, std::uint32_t sample) {
  const LightPoint* points = points_of_sample(*tracer->frame, sample);
  tracer->points_of_lamp = points_of_lamp(tracer->frame->settings, tracer->frame->mask, sample);
  if (points == tracer->light_points) return;
  tracer->light_points = points;
  tracer->tested_points.first = ~0u;
}

}  // namespace pocketray
