#include "shade/indirect_light.h"

#include "base/check.h"
#include "indirect/indirect_list.h"
#include "shade/contact.h"
#include "shade/even_points.h"
#include "shade/filters.h"
#include "shade/instances.h"
#include "shade/interleaved.h"
#include "shade/pixel.h"

namespace pocketray {
namespace {

constexpr Vec3 kWhite = {1, 1, 1};

// Sums the whole pattern, as if all of its pixels showed this point.
Vec3 virtual_light_at(Tracer* tracer, const Surface& s) {
  const FrameData& frame = *tracer->frame;
  Surface white = s;
  white.diffuse = kWhite;
  const Surface* surface[kPatternPixels];
  std::uint8_t place[kPatternPixels];
  for (std::uint32_t i = 0; i < kPatternPixels; ++i) surface[i] = &white, place[i] = static_cast<std::uint8_t>(i);
  InterleavedLight light[kPatternPixels], sum = {{0, 0, 0}, {0, 0, 0}, 0};
  kVirtualLightSource.gather(frame, {kPatternPixels, surface, place}, &tracer->stats,
                             &tracer->rays[static_cast<int>(RayKind::shadow)], light);
  for (const InterleavedLight& l : light) add(l, &sum);
  return kVirtualLightSource.irradiance(frame, s.point, s.normal, sum, false);
}

}  // namespace

bool visible_surface(Tracer* tracer, Ray* ray, Hit* hit, Surface* s, float* passed) {
  const FrameData& frame = *tracer->frame;
  *passed = 0;
  for (std::uint32_t layer = 0; layer < kTransparentLayerMax; ++layer) {
    if (layer > 0)
      frame.geometry.accel_info->closest(frame.geometry.accel, *ray, visible_filter(frame), hit, &tracer->stats);
    if (hit->triangle == kNoTriangle) return false;
    frame.kernels.surface(frame, *ray, *hit, s);
    if (!culls(*s->material, s->front, frame.mask)) return true;
    // A face whose back touches another face may be visible.
    Contact contact;
    gather_contact(frame, *s, *hit, visible_filter(frame), &contact, &tracer->stats);
    for (std::uint32_t i = 1; i < contact.count; ++i) {
      const Face& face = contact.face[i];
      if (culls(frame.scene->materials[face.material], face.front, frame.mask)) continue;
      const float t = hit->t;
      *hit = face.hit;
      hit->t = t;
      frame.kernels.surface(frame, *ray, *hit, s);
      return true;
    }
    *passed += hit->t;
    ray->origin = safe_origin(*s, -1);
  }
  return false;
}

Vec3 stored_light(const FrameData& frame, const Surface& s) {
  Vec3 sum = {0, 0, 0};
  for (int i = 0; i < IndirectList::kCount; ++i) {
    const IndirectInfo& info = IndirectList::kInfos[i];
    if (!(frame.mask & kStoredLight & info.effects)) continue;
    sum += info.radiance({*frame.scene, frame.indirect.prepared[i], s.point, s.normal, kWhite, s.hit.triangle, s.hit.u,
                          s.hit.v, s.front, frame.settings.reconstruction});
  }
  return sum;
}

Vec3 indirect_light(Tracer* tracer, const Surface& s) {
  const FrameData& frame = *tracer->frame;
  return has(frame.mask, Effect::instant_radiosity) ? virtual_light_at(tracer, s) : stored_light(frame, s);
}

Vec3 pixel_indirect_light(Tracer* tracer, std::uint32_t column, std::uint32_t row) {
  const FrameData& frame = *tracer->frame;
  Ray ray = pixel_ray(frame, column, row, rook_point(0, frame.settings.samples_per_pixel));
  ++tracer->rays[static_cast<int>(RayKind::primary)];
  Hit hit;
  frame.geometry.first_rays->closest(frame.geometry.accel, ray, visible_filter(frame), &hit, &tracer->stats);
  Surface s;
  float passed;
  const bool shows = visible_surface(tracer, &ray, &hit, &s, &passed) && takes_indirect_light(s);
  return shows ? indirect_light(tracer, s) : Vec3{kNoIndirectLight, kNoIndirectLight, kNoIndirectLight};
}

}  // namespace pocketray
