// Checks shared by validate_*.cpp. Bounds are tested on the bits of a float, which is fast on a CPU without FPU.
#pragma once
#include <cstdint>
#include <limits>

#include "base/float_bits.h"
#include "base/limits.h"
#include "base/status.h"
#include "scene/scene.h"

namespace pocketray {

// |x| ≤ limit; false for NaN and infinities.
inline bool magnitude_at_most(float x, float limit) { return magnitude_bits(x) <= float_bits(limit); }
inline bool is_coordinate(float x) { return magnitude_at_most(x, kCoordinateMax); }
inline bool is_coordinate(const Vec2& p) { return is_coordinate(p.x) && is_coordinate(p.y); }
inline bool is_coordinate(const Vec3& p) { return is_coordinate(p.x) && is_coordinate(p.y) && is_coordinate(p.z); }
inline bool is_coordinate(const Transform& t) {
  for (const auto& row : t.m)
    for (float x : row)
      if (!is_coordinate(x)) return false;
  return true;
}

// True if unit to within 1 %, as normals and directions must be. NaN fails.
constexpr float kUnitSquareMin = 0.98f, kUnitSquareMax = 1.02f;
inline bool is_unit(const Vec3& n) {
  if (!is_coordinate(n)) return false;
  float square = dot(n, n);
  return square >= kUnitSquareMin && square <= kUnitSquareMax;
}

// True if [begin, begin + count) lies in [0, total).
inline bool is_range(std::uint64_t begin, std::uint64_t count, std::uint64_t total) {
  return begin <= total && count <= total - begin;  // no overflow: count may be a product of factors below 2^32
}
inline bool is_index_or_none(std::uint32_t index, std::uint32_t count) { return index == kNone || index < count; }

// A value and its allowed interval.
struct FieldRange {
  const char* field;
  float value, low, high;
};
template <std::size_t count>
Status check_fields(const char* array, std::uint32_t index, const FieldRange (&fields)[count]) {
  for (const FieldRange& f : fields)
    if (!(f.value >= f.low && f.value <= f.high))
      return failure("%s[%u].%s is %g, it must lie in %g to %g", array, index, f.field, static_cast<double>(f.value),
                     static_cast<double>(f.low), static_cast<double>(f.high));
  return success();
}

// Returns whether is_coordinate() holds for all these floats.
bool are_coordinates(const void* values, std::size_t count);

template <class T>
Status check_coordinates(const char* array, Array<const T> values) {
  if (are_coordinates(values.data, values.bytes() / sizeof(float))) return success();
  for (std::uint32_t i = 0; i < values.count; ++i)
    if (!is_coordinate(values[i]))
      return failure("%s[%u] is not a number or beyond %g: scale the model down", array, i,
                     static_cast<double>(kCoordinateMax));
  return success();
}
Status check_normals(const char* array, Array<const Vec3> normals);

Status validate_geometry(const Scene& scene);
Status validate_materials(const Scene& scene);
Status validate_material(const Scene& scene, std::uint32_t index);  // with its maps
Status validate_material_maps(const Scene& scene);
Status validate_maps(const Scene& scene, std::uint32_t index);  // of one material
Status validate_grains(const Scene& scene);
Status validate_clear_coats(const Scene& scene);
Status validate_sheens(const Scene& scene);
Status validate_glass_maps(const Scene& scene);
Status validate_iridescences(const Scene& scene);
Status validate_diffuse_transmissions(const Scene& scene);
Status check_texture_use(const char* array, const char* field, std::uint32_t index, const TextureUse& use,
                         const Scene& scene);
Status validate_lights_and_cameras(const Scene& scene);
Status validate_nodes(const Scene& scene);
Status validate_animations(const Scene& scene);
Status validate_moving_meshes(const Scene& scene);
Status validate_radiosity(const Scene& scene);
Status validate_environment(const Scene& scene);

}  // namespace pocketray
