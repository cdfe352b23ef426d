// Axis-aligned boxes.
#pragma once
#include <limits>

#include "base/vec3.h"

namespace pocketray {

struct Box {
  Vec3 low, high;
};

inline Box empty_box() {
  constexpr float inf = std::numeric_limits<float>::infinity();
  return {{inf, inf, inf}, {-inf, -inf, -inf}};
}
inline bool is_empty(const Box& b) { return !(b.low.x <= b.high.x && b.low.y <= b.high.y && b.low.z <= b.high.z); }
inline Box merge(const Box& a, const Box& b) { return {min(a.low, b.low), max(a.high, b.high)}; }
inline Box merge(const Box& a, const Vec3& p) { return {min(a.low, p), max(a.high, p)}; }
inline Vec3 extent(const Box& b) { return b.high - b.low; }
inline Vec3 center(const Box& b) { return b.low * 0.5f + b.high * 0.5f; }
// Half the surface area, as the surface-area heuristic compares it. 0 for an empty box.
inline float half_area(const Box& b) {
  if (is_empty(b)) return 0;
  Vec3 e = extent(b);
  return e.x * e.y + e.y * e.z + e.z * e.x;
}
inline bool overlaps(const Box& a, const Box& b) {
  return a.low.x <= b.high.x && a.low.y <= b.high.y && a.low.z <= b.high.z && a.high.x >= b.low.x &&
         a.high.y >= b.low.y && a.high.z >= b.low.z;
}
inline bool contains(const Box& outer, const Box& inner) {
  return outer.low.x <= inner.low.x && outer.low.y <= inner.low.y && outer.low.z <= inner.low.z &&
         outer.high.x >= inner.high.x && outer.high.y >= inner.high.y && outer.high.z >= inner.high.z;
}

}  // namespace pocketray
