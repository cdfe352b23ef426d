#include "shade/ambient_gloss.h"

#include "base/check.h"
#include "effect/effect_probe.h"
#include "indirect/surroundings.h"
#include "shade/surface.h"

namespace pocketray {

Vec3 glow_of_surroundings(const FrameData& frame, const Ray& ray, const Material& m, const Surface& s) {
  if (!reflects_surroundings(m)) return {0, 0, 0};
  effect_entered<Effect::ambient_gloss>();
  const Vec3 specular = reflectance_at(s, m.specular, m.specular_tinted);
  return reflected_surroundings(frame.scene->info, m, specular, dot(s.normal, ray.direction));
}

namespace {

void surface(const FrameData& frame, const Ray& ray, const Hit& hit, Surface* s) {
  frame.plain_surface(frame, ray, hit, s);
  s->glow += glow_of_surroundings(frame, ray, *s->material, *s);
}

void first_surface(const FrameData& frame, const Ray& ray, const Hit& hit, Surface* s) {
  frame.plain_first_surface(frame, ray, hit, s);
  s->glow += glow_of_surroundings(frame, ray, *s->material, *s);
}

}  // namespace

void add_ambient_gloss(FrameData* frame) {
  CHECK(frame != nullptr && frame->surface != nullptr && frame->first_surface != nullptr);
  frame->plain_surface = frame->surface, frame->surface = surface;
  frame->plain_first_surface = frame->first_surface, frame->first_surface = first_surface;
}

}  // namespace pocketray
