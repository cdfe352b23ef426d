#include "shade/media.h"

#include "shade/surface.h"

namespace pocketray {

MediumStack media_at(const FrameData& frame, const Vec3& eye, const Vec3& direction) {
  // Walking outward, an exit without its entry belongs to a body that holds the eye; the first such is the innermost.
  std::uint32_t exits[kMediumDepthMax];
  std::uint32_t exit_count = 0;
  MediumStack open;
  Ray ray{eye, direction, __builtin_inff()};
  TraceStats stats;
  for (std::uint32_t layer = 0; layer < kTransparentLayerMax; ++layer) {
    Hit hit;
    frame.accel_info->closest(frame.accel, ray, nullptr, &hit, &stats);
    if (hit.triangle == kNoTriangle) break;
    Surface s;
    frame.surface(frame, ray, hit, &s);
    std::uint32_t material = frame.scene->triangles[hit.triangle].material;
    if (!is_zero(s.material->transmission) && !s.material->thin) {
      std::uint32_t depth = open.depth;
      if (s.front) {
        enter_medium(&open, material);
      } else {
        exit_medium(&open, material);
        if (open.depth == depth && exit_count < kMediumDepthMax) exits[exit_count++] = material;
      }
    }
    ray.origin = safe_origin(s, -1);
  }
  MediumStack stack;
  while (exit_count > 0) enter_medium(&stack, exits[--exit_count]);
  return stack;
}

}  // namespace pocketray
