#include "shade/media.h"

#include <initializer_list>

#include "base/check.h"

namespace pocketray {
namespace {

bool is_body(const Material& m) { return !is_zero(m.transmission) && !m.thin; }

}  // namespace

void cross_contact(const Scene& scene, const Contact& contact, MediumStack* stack) {
  for (bool entering : {false, true})
    for (std::uint32_t i = 0; i < contact.count; ++i) {
      const Face& face = contact.face[i];
      if (face.front != entering || !is_body(scene.materials[face.material])) continue;
      entering ? enter_medium(stack, face.material) : exit_medium(stack, face.material);
    }
}

MediumStack media_at(const FrameData& frame, const Vec3& eye, const Vec3& direction) {
  CHECK(frame.scene != nullptr && frame.geometry.accel_info != nullptr && frame.kernels.surface != nullptr);
  // Walking outward, an exit without its entry belongs to a body that contains the eye; the first such is the
  // innermost.
  std::uint32_t exits[kMediumDepthMax];
  std::uint32_t exit_count = 0;
  MediumStack open;
  Ray ray{eye, direction, __builtin_inff()};
  TraceStats stats;
  for (std::uint32_t layer = 0; layer < kTransparentLayerMax; ++layer) {
    Hit hit;
    frame.geometry.accel_info->closest(frame.geometry.accel, ray, nullptr, &hit, &stats);
    if (hit.triangle == kNoTriangle) break;
    Surface s;
    frame.kernels.surface(frame, ray, hit, &s);
    Contact contact;
    gather_contact(frame, s, hit, nullptr, &contact, &stats);
    for (bool entering : {false, true})
      for (std::uint32_t i = 0; i < contact.count; ++i) {
        const Face& face = contact.face[i];
        if (face.front != entering || !is_body(frame.scene->materials[face.material])) continue;
        std::uint32_t depth = open.depth;
        entering ? enter_medium(&open, face.material) : exit_medium(&open, face.material);
        if (!entering && open.depth == depth && exit_count < kMediumDepthMax) exits[exit_count++] = face.material;
      }
    ray.origin = safe_origin(s, -1);
  }
  MediumStack stack;
  while (exit_count > 0) enter_medium(&stack, exits[--exit_count]);
  return stack;
}

}  // namespace pocketray
