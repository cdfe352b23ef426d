// The lights of a frame.
#pragma once
#include "shade/light_polygon.h"
#include "shade/light_tree.h"
#include "shade/point_group.h"

namespace pocketray {

struct LightRun {
  std::uint32_t begin, end;
  LightSampler sample;
  const LightPolygon* polygons;  // one per area light; null: light comes from their points
};

struct Lights {
  Array<const LightPoint> points;
  Array<const LightPoint> sample_points;  // as many for each sample that has its own, see sample_points.h
  LightRun runs[4];
  int run_count = 0;
  std::uint32_t sun_begin = 0, sun_end = 0;  // points of the sun that the environment's map shows, too
  LightTree tree = {};                       // set with Effect::source_selection
  PointGroups point_groups = {};
  Array<const LightPolygon> polygons;  // the polygons that LightRun::polygons points into
};

}  // namespace pocketray
