// Groups of an area light's points.
#pragma once
#include "base/array.h"

namespace pocketray {

// Points of an area light whose shadows are tested together, see point_groups.h.
struct PointGroup {
  std::uint8_t probes[5];    // points at the corners and in the middle, by index in the light
  std::uint16_t begin, end;  // in PointGroups::order
  std::uint16_t second;      // second half; the first half is the next group; 0: not divided
};
// Groups of all area lights, at most one per point of a light. The first group holds all points.
struct PointGroups {
  Array<const PointGroup> groups;          // one slot per point; empty: each point is tested
  Array<const std::uint8_t> order, place;  // the light's points in the order of the groups, and the inverse
  std::uint32_t first_point;               // index in Lights::points of the first area light
  std::uint32_t points_of_light;
};

}  // namespace pocketray
