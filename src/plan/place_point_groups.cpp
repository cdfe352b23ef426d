#include "plan/place_point_groups.h"

#include <algorithm>

#include "base/check.h"
#include "base/limits.h"
#include "shade/frame_data.h"
#include "shade/lights.h"
#include "shade/point_groups.h"

namespace pocketray {
namespace {

struct GroupBuilder {
  const LightPoint* points;  // of one light
  std::uint8_t* order;
  PointGroup* groups;
  std::uint32_t count = 0;

  // In double precision, since fourth powers of lengths exceed the range of float.
  Vec3d position(std::uint32_t point) const { return to_double(points[point].position); }
};

// Returns the group's point with the greatest value; on ties, the one with the lowest number.
template <class Value>
std::uint8_t greatest(const GroupBuilder& b, const PointGroup& group, Value value) {
  std::uint8_t best = b.order[group.begin];
  for (std::uint32_t i = group.begin + 1u; i < group.end; ++i) {
    const std::uint8_t point = b.order[i];
    const double is = value(b.position(point)), was = value(b.position(best));
    if (is > was || (is == was && point < best)) best = point;
  }
  return best;
}

double square(const Vec3d& v) { return dot(v, v); }

// Finds the corners of a rectangle in any orientation: the point farthest from the middle, its opposite, the point
// farthest from their diagonal, and its opposite.
void find_probes(const GroupBuilder& b, PointGroup* group) {
  Vec3d middle = {0, 0, 0};
  for (std::uint32_t i = group->begin; i < group->end; ++i) middle += b.position(b.order[i]);
  middle = middle / static_cast<double>(group->end - group->begin);
  auto farthest_from = [&](const Vec3d& from) {
    return greatest(b, *group, [&](const Vec3d& p) { return square(p - from); });
  };
  std::uint8_t* probes = group->probes;
  probes[0] = farthest_from(middle);
  const Vec3d first = b.position(probes[0]), opposite = b.position(probes[1] = farthest_from(first));
  const Vec3d diagonal = opposite - first;
  probes[2] = greatest(b, *group, [&](const Vec3d& p) { return square(cross(p - first, diagonal)); });
  probes[3] = farthest_from(b.position(probes[2]));
  probes[4] = greatest(b, *group, [&](const Vec3d& p) { return -square(p - middle); });
}

// The longest edge of the group's corners.
Vec3d longest_edge(const GroupBuilder& b, const PointGroup& group) {
  const Vec3d corner = b.position(group.probes[2]);
  const Vec3d one = b.position(group.probes[0]) - corner, other = b.position(group.probes[1]) - corner;
  return square(one) >= square(other) ? one : other;
}

// Finds where to divide the sorted points, with at least a third of them in either half: at a wide gap near the middle,
// so that rows of a grid stay whole.
std::uint32_t find_half(const GroupBuilder& b, std::uint32_t begin, std::uint32_t end, const Vec3d& along) {
  const std::uint32_t third = (end - begin + 2) / 3, first = begin + third, last = end - third;
  auto gap = [&](std::uint32_t i) { return dot(b.position(b.order[i]) - b.position(b.order[i - 1]), along); };
  double widest = 0;
  for (std::uint32_t i = first; i <= last; ++i) widest = std::max(widest, gap(i));
  auto off_middle = [&](std::uint32_t i) { return 2 * i > begin + end ? 2 * i - begin - end : begin + end - 2 * i; };
  std::uint32_t half = begin + (end - begin) / 2;
  bool is_wide = false;
  for (std::uint32_t i = first; i <= last; ++i)
    if (gap(i) * 2 > widest && (!is_wide || off_middle(i) < off_middle(half))) half = i, is_wide = true;
  return half;
}

std::uint16_t build(GroupBuilder* b, std::uint32_t begin, std::uint32_t end) {
  const std::uint16_t index = static_cast<std::uint16_t>(b->count++);
  PointGroup group = {{}, static_cast<std::uint16_t>(begin), static_cast<std::uint16_t>(end), 0};
  find_probes(*b, &group);
  if (end - begin > kUndividedMax) {
    const Vec3d along = longest_edge(*b, group);
    std::sort(b->order + begin, b->order + end, [&](std::uint8_t i, std::uint8_t k) {
      const double a = dot(b->position(i), along), c = dot(b->position(k), along);
      return a < c || (a == c && i < k);
    });
    const std::uint32_t half = find_half(*b, begin, end, along);
    build(b, begin, half);
    group.second = build(b, half, end);
  }
  b->groups[index] = group;
  return index;
}

}  // namespace

void place_point_groups(Array<PointGroup> groups, Array<std::uint8_t> order, Array<std::uint8_t> place,
                        FrameData* frame) {
  CHECK(frame != nullptr);
  frame->lights.point_groups = {};
  const std::uint32_t n = frame->settings.points_per_area_light;
  if (frame->settings.area_shadows == AreaShadows::every || n <= kUndividedMax || frame->lights.run_count == 0 ||
      has(frame->mask, Effect::source_selection))
    return;
  const LightRun& run = frame->lights.runs[frame->lights.run_count - 1];
  if (run.sample != find_light_sampler(Effect::area_light)) return;
  PointGroups& all = frame->lights.point_groups;
  const std::uint32_t point_count = run.end - run.begin;
  CHECK(n <= kPointsPerAreaLightMax && point_count % n == 0);
  CHECK(point_count <= groups.count && point_count <= order.count && point_count <= place.count);
  for (std::uint32_t first = 0; first < point_count; first += n) {
    GroupBuilder b = {&frame->lights.points[run.begin + first], &order[first], &groups[first]};
    for (std::uint32_t i = 0; i < n; ++i) b.order[i] = static_cast<std::uint8_t>(i);
    build(&b, 0, n);
    for (std::uint32_t i = 0; i < n; ++i) place[first + b.order[i]] = static_cast<std::uint8_t>(i);
    CHECK_LE(b.count, n);
  }
  all.groups = {groups.data, point_count};
  all.order = {order.data, point_count}, all.place = {place.data, point_count};
  all.first_point = run.begin, all.points_of_light = n;
}

}  // namespace pocketray
