// Validates a stored radiosity solution.
#include "base/check.h"
#include "scene/baked.h"
#include "scene/validate_checks.h"

namespace pocketray {
namespace {

Status check_light(const char* array, std::uint32_t index, const Vec3& value, float low, float high) {
  for (int axis = 0; axis < 3; ++axis)
    if (!(value[axis] >= low && value[axis] <= high))
      return failure("%s[%u] has light of %g, it must lie in %g to %g", array, index, static_cast<double>(value[axis]),
                     static_cast<double>(low), static_cast<double>(high));
  return success();
}

Status validate_grid(const Scene& scene, std::uint32_t index) {
  const RadiosityGrid& grid = scene.radiosity_grids[index];
  if (!is_coordinate(grid.origin) || !is_coordinate(grid.along_s) || !is_coordinate(grid.along_t))
    return failure("radiosity_grids[%u] is not finite or too large", index);
  if (grid.columns < 2 || grid.rows < 2 || grid.columns > kRadiositySideMax || grid.rows > kRadiositySideMax)
    return failure("radiosity_grids[%u] has %u by %u nodes, its sides must lie in 2 to %u", index, grid.columns,
                   grid.rows, kRadiositySideMax);
  if (!is_range(grid.node_begin, std::uint64_t(grid.columns) * grid.rows, scene.radiosity_nodes.count))
    return failure("radiosity_grids[%u] extends beyond the scene's %u nodes", index, scene.radiosity_nodes.count);
  return success();
}

// Descents end because indices rise.
Status validate_cut(const Scene& scene, std::uint32_t index) {
  CHECK_LT(index, scene.radiosity_cuts.count);
  const RadiosityCut& cut = scene.radiosity_cuts[index];
  if (!is_coordinate(cut.origin) || !is_coordinate(cut.across))
    return failure("radiosity_cuts[%u] is not finite or too large", index);
  for (std::uint32_t part : cut.part) {
    const bool divided = is_cut(part);
    const std::uint32_t at = part & (divided ? ~kRadiosityCutBits : ~kRadiosityGridBit),
                        limit = divided ? scene.radiosity_cuts.count : scene.radiosity_grids.count;
    if (!(part & kRadiosityGridBit) || at >= limit || (divided && at <= index))
      return failure("radiosity_cuts[%u] has part %#x of %u %s", index, part, limit, divided ? "cuts" : "grids");
  }
  return success();
}

Status validate_nodes_of_grids(const Scene& scene) {
  for (std::uint32_t i = 0; i < scene.radiosity_nodes.count; ++i) {
    const RadiosityNode& node = scene.radiosity_nodes[i];
    RETURN_IF_ERROR(check_light("radiosity_nodes", i, node.value, 0, kRadianceMax));
    for (const Vec3& tangent : {node.ds, node.dt, node.dst})
      RETURN_IF_ERROR(check_light("radiosity_nodes", i, tangent, -9 * kRadianceMax, 9 * kRadianceMax));
  }
  return success();
}

// Descents end because levels rise, up to kRadiosityLevelMax.
Status validate_split(const Scene& scene, std::uint32_t index) {
  const RadiositySplit& split = scene.radiosity_splits[index];
  for (std::uint32_t part : split.part) {
    const bool is_whole = !(part & kRadiositySplitBit);
    const std::uint32_t at = part & kRadiosityPartMax,
                        limit = is_whole ? scene.radiosity_corners.count : scene.radiosity_splits.count;
    if (part & kRadiosityGridBit || at >= limit || turn_of(part) > (is_whole ? 0 : 2))
      return failure("radiosity_splits[%u] has part %#x of %u %s", index, part, limit, is_whole ? "corners" : "splits");
    if (!is_whole && level_of(scene.radiosity_splits[at]) <= level_of(split))
      return failure("radiosity_splits[%u] has a part of no higher level", index);
  }
  return success();
}

}  // namespace

Status validate_radiosity(const Scene& scene) {
  const std::uint32_t count = scene.radiosity_triangles.count;
  if (count != 0 && count != scene.triangles.count && count != 2 * std::uint64_t(scene.triangles.count))
    return failure("radiosity for %u sides of %u triangles: there must be one or two for each or none", count,
                   scene.triangles.count);
  if (scene.radiosity_info.count != (count ? 1u : 0u))
    return failure("%u radiosity_info, not %u", scene.radiosity_info.count, count ? 1u : 0u);
  if (count) RETURN_IF_ERROR(check_light("radiosity_info", 0, scene.radiosity_info[0].value_max, 0, kRadianceMax));
  for (std::uint32_t i = 0; i < scene.radiosity_grids.count; ++i) RETURN_IF_ERROR(validate_grid(scene, i));
  for (std::uint32_t i = 0; i < scene.radiosity_cuts.count; ++i) RETURN_IF_ERROR(validate_cut(scene, i));
  RETURN_IF_ERROR(validate_nodes_of_grids(scene));
  for (std::uint32_t i = 0; i < scene.radiosity_values.count; ++i)
    RETURN_IF_ERROR(check_light("radiosity_values", i, scene.radiosity_values[i], 0, kRadianceMax));
  for (std::uint32_t i = 0; i < scene.radiosity_corners.count; ++i)
    for (std::uint32_t value : scene.radiosity_corners[i].value)
      if (value >= scene.radiosity_values.count)
        return failure("radiosity_corners[%u] has value %u of %u", i, value, scene.radiosity_values.count);
  for (std::uint32_t i = 0; i < scene.radiosity_splits.count; ++i) RETURN_IF_ERROR(validate_split(scene, i));
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::uint32_t place = scene.radiosity_triangles[i];
    if (place == kNone) continue;
    if (place == kRadiosityAtVertices) {
      if (scene.radiosity_values.count >= scene.positions.count) continue;
      return failure("%u radiosity_values for %u vertices", scene.radiosity_values.count, scene.positions.count);
    }
    if (is_split(place)) {
      const bool has_level = place >> kRadiosityLevelShift & kRadiosityLevelMax;
      if ((place & kRadiosityPartMax) < scene.radiosity_splits.count && turn_of(place) <= 2 && !has_level) continue;
      return failure("radiosity_triangles[%u] refers to split %#x of %u", i, place, scene.radiosity_splits.count);
    }
    if (is_cut(place)) {
      if ((place & ~kRadiosityCutBits) < scene.radiosity_cuts.count) continue;
      return failure("radiosity_triangles[%u] refers to cut %u of %u", i, place & ~kRadiosityCutBits,
                     scene.radiosity_cuts.count);
    }
    const bool on_grid = place & kRadiosityGridBit;
    const std::uint32_t index = place & ~kRadiosityGridBit,
                        limit = on_grid ? scene.radiosity_grids.count : scene.radiosity_corners.count;
    if (index >= limit)
      return failure("radiosity_triangles[%u] refers to %s %u of %u", i, on_grid ? "grid" : "corners", index, limit);
  }
  return success();
}

}  // namespace pocketray
