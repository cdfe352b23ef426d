#include "plan/interior.h"

#include <algorithm>
#include <limits>

#include "base/check.h"
#include "base/fmath.h"

namespace pocketray {
namespace {

constexpr int kPlacesPerSide = 12, kPlaces = kPlacesPerSide * kPlacesPerSide;
constexpr int kTurns = 16, kWallsMin = 12;  // chosen: a quarter of the directions may lead out through openings
constexpr float kInfinity = std::numeric_limits<float>::infinity();

// A point, or a direction, of the floor plan. All coordinates here are relative to the middle of the bounds.
struct PlanPoint {
  float x, z;
};
float cross2(const PlanPoint& a, const PlanPoint& b) { return a.x * b.z - a.z * b.x; }
PlanPoint between(const PlanPoint& from, const PlanPoint& to) { return {to.x - from.x, to.z - from.z}; }

struct FloorPlan {
  Vec3 middle, half;
  float floor[kPlaces], ceiling[kPlaces];  // heights of the next surface below the middle whose front is on top, and
                                           // of the next one above it
  float distance[kPlaces][kTurns];         // distance to the next wall, or to the bounds if there is none
  int walls[kPlaces];
  PlanPoint direction[kTurns];
};

PlanPoint place(const FloorPlan& plan, int index) {
  CHECK(index >= 0 && index < kPlaces);
  const float column = static_cast<float>(index % kPlacesPerSide), row = static_cast<float>(index / kPlacesPerSide);
  return {plan.half.x * ((2 * column + 1) / kPlacesPerSide - 1), plan.half.z * ((2 * row + 1) / kPlacesPerSide - 1)};
}

// Columns or rows of places between two coordinates along an axis of half length `half`.
struct PlaceRange {
  int begin, end;
};
PlaceRange places_between(float low, float high, float half) {
  auto index = [&](float at) {
    const float place = (at / half + 1) * (kPlacesPerSide / 2.0f) + 0.5f;
    return static_cast<int>(std::clamp(place, 0.0f, static_cast<float>(kPlacesPerSide)));
  };
  return {index(low), index(high)};
}

void add_heights(const Vec3 (&corner)[3], FloorPlan* plan) {
  CHECK(plan != nullptr);
  const Vec3 low = min(min(corner[0], corner[1]), corner[2]), high = max(max(corner[0], corner[1]), corner[2]);
  const PlanPoint a = {corner[0].x, corner[0].z};
  const PlanPoint b = between(a, {corner[1].x, corner[1].z}), c = between(a, {corner[2].x, corner[2].z});
  const float area = cross2(b, c);
  if (area == 0) return;
  const PlaceRange columns = places_between(low.x, high.x, plan->half.x),
                   rows = places_between(low.z, high.z, plan->half.z);
  for (int row = rows.begin; row < rows.end; ++row)
    for (int column = columns.begin; column < columns.end; ++column) {
      const int index = row * kPlacesPerSide + column;
      const PlanPoint p = between(a, place(*plan, index));
      const float u = cross2(p, c) / area, v = cross2(b, p) / area;
      if (!(u >= 0 && v >= 0 && u + v <= 1)) continue;
      const float height = corner[0].y + (corner[1].y - corner[0].y) * u + (corner[2].y - corner[0].y) * v;
      if (height <= 0 && area < 0) plan->floor[index] = std::max(plan->floor[index], height);
      if (height > 0) plan->ceiling[index] = std::min(plan->ceiling[index], height);
    }
}

// Intersects the triangle with the horizontal plane at `eye_height`, and the rays of all places with that segment.
void add_walls(const Vec3 (&corner)[3], float eye_height, FloorPlan* plan) {
  CHECK(plan != nullptr);
  PlanPoint ends[3];
  int count = 0;
  for (int i = 0; i < 3; ++i) {
    const Vec3 &from = corner[i], &to = corner[(i + 1) % 3];
    if ((from.y > eye_height) == (to.y > eye_height)) continue;
    const float along = (eye_height - from.y) / (to.y - from.y);
    ends[count++] = {from.x + (to.x - from.x) * along, from.z + (to.z - from.z) * along};
  }
  if (count != 2) return;
  const PlanPoint wall = between(ends[0], ends[1]);
  for (int index = 0; index < kPlaces; ++index) {
    const PlanPoint to_wall = between(place(*plan, index), ends[0]);
    const float facing = cross2(to_wall, wall);
    for (int turn = 0; turn < kTurns; ++turn) {
      const PlanPoint& direction = plan->direction[turn];
      const float slant = cross2(direction, wall), along = cross2(to_wall, direction);
      // distance = facing / slant ≥ 0 and 0 ≤ along / slant ≤ 1, without dividing in vain
      if (slant > 0 ? !(facing >= 0 && along >= 0 && along <= slant) : !(facing <= 0 && along <= 0 && along >= slant))
        continue;
      float* nearest = &plan->distance[index][turn];
      if (!(facing / slant < *nearest)) continue;
      plan->walls[index] += *nearest == kInfinity;
      *nearest = facing / slant;
    }
  }
}

float distance_to_bounds(const FloorPlan& plan, const PlanPoint& from, const PlanPoint& direction) {
  float distance = kInfinity;
  if (direction.x != 0) distance = ((direction.x > 0 ? plan.half.x : -plan.half.x) - from.x) / direction.x;
  if (direction.z != 0)
    distance = std::min(distance, ((direction.z > 0 ? plan.half.z : -plan.half.z) - from.z) / direction.z);
  return distance;
}

template <class Visit>
void for_each_triangle(const Scene& scene, const Vec3& middle, Visit visit) {
  for (const Triangle& t : scene.triangles) {
    const Vec3 corner[3] = {scene.positions[t.vertex(0)] - middle, scene.positions[t.vertex(1)] - middle,
                            scene.positions[t.vertex(2)] - middle};
    visit(corner);
  }
}

// The height that a share of the values lies below; NaN without any.
float quantile(float (&values)[kPlaces], int count, float share) {
  CHECK(count >= 0 && count <= kPlaces);
  if (count == 0) return std::numeric_limits<float>::quiet_NaN();
  float* at = values + static_cast<int>(share * static_cast<float>(count - 1));
  std::nth_element(values, at, values + count);
  return *at;
}

// Chosen: the floor that a quarter of the places are on or below, as galleries and furniture are above it.
float floor_level(const FloorPlan& plan) {
  float heights[kPlaces];
  int count = 0;
  for (float height : plan.floor)
    if (height > -kInfinity) heights[count++] = height;
  return quantile(heights, count, 0.25f);
}

bool is_on_floor(const FloorPlan& plan, int index, float level) {
  CHECK(index >= 0 && index < kPlaces);
  return std::fabs(plan.floor[index] - level) <= 0.1f * plan.half.y;
}

// Chosen: a person's eyes in a room of ordinary height, whatever the unit. Where the height is plausible in metres, the
// unit of glTF, no higher than 1.6 m, also in a hall.
float eye_height_above(float floor, float ceiling) {
  constexpr float kMetres = 1.6f, kShare = 0.55f, kHallMax = 50;
  const float height = ceiling - floor;
  return height > kMetres && height < kHallMax ? std::min(kMetres, kShare * height) : kShare * height;
}

}  // namespace

bool find_place_to_stand(const Scene& scene, const Box& bounds, Vec3* eye, Vec3* target) {
  CHECK(eye != nullptr && target != nullptr && !is_empty(bounds));
  FloorPlan plan = {};
  plan.middle = center(bounds), plan.half = extent(bounds) * 0.5f;
  if (!(plan.half.x > 0 && plan.half.y > 0 && plan.half.z > 0)) return false;
  std::fill(plan.floor, plan.floor + kPlaces, -kInfinity), std::fill(plan.ceiling, plan.ceiling + kPlaces, kInfinity);
  for_each_triangle(scene, plan.middle, [&](const Vec3(&corner)[3]) { add_heights(corner, &plan); });
  const float level = floor_level(plan);
  float ceilings[kPlaces];
  int count = 0;
  for (int i = 0; i < kPlaces; ++i)
    if (is_on_floor(plan, i, level)) ceilings[count++] = std::min(plan.ceiling[i], plan.half.y);
  if (count == 0) return false;
  const float above_floor = eye_height_above(level, quantile(ceilings, count, 0.5f)), eye_height = level + above_floor;

  for (int turn = 0; turn < kTurns; ++turn)
    plan.direction[turn] = {static_cast<float>(det_cos(2 * kPi / kTurns * turn)),
                            static_cast<float>(det_sin(2 * kPi / kTurns * turn))};
  for (auto& row : plan.distance) std::fill(row, row + kTurns, kInfinity);
  for_each_triangle(scene, plan.middle, [&](const Vec3(&corner)[3]) { add_walls(corner, eye_height, &plan); });

  const float clear = 0.3f * above_floor;  // chosen: at arm's length
  float longest = 0;
  for (int i = 0; i < kPlaces; ++i) {
    const PlanPoint here = place(plan, i);
    for (int turn = 0; turn < kTurns; ++turn)
      plan.distance[i][turn] = std::min(plan.distance[i][turn], distance_to_bounds(plan, here, plan.direction[turn]));
    const auto& distance = plan.distance[i];
    const bool is_clear =
        plan.ceiling[i] - eye_height > clear && *std::min_element(distance, distance + kTurns) > clear;
    if (!is_on_floor(plan, i, level) || plan.walls[i] < kWallsMin || !is_clear) continue;
    for (int turn = 0; turn < kTurns; ++turn) {
      // A view has a width: counts what the neighbouring directions, 22° to either side, show.
      const float view =
          distance[turn] + (distance[(turn + 1) % kTurns] + distance[(turn + kTurns - 1) % kTurns]) * 0.25f;
      if (!(view > longest)) continue;
      longest = view;
      const Vec3 way = {plan.direction[turn].x, 0, plan.direction[turn].z};
      *eye = plan.middle + Vec3{here.x, eye_height, here.z};
      *target = *eye + way * distance[turn];
    }
  }
  return longest > 0;
}

}  // namespace pocketray
