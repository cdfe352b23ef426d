#include "shade/ambient_gloss.h"

#include "base/check.h"
#include "effect/effect_probe.h"
#include "indirect/environment.h"
#include "shade/surface.h"

namespace pocketray {
namespace {

Vec3 even_light(const FrameData& frame, const Ray& ray, const Material& m, const Surface& s) {
  if (!reflects_surroundings(m)) return {0, 0, 0};
  effect_entered<Effect::ambient_gloss>();
  const Vec3 specular = reflectance_at(s, m.specular, m.specular_tinted);
  return reflected_surroundings(frame.scene->info, m, specular, dot(s.normal, ray.direction));
}

Vec3 environment_light(const FrameData& frame, const Ray& ray, const Material& m, const Surface& s) {
  effect_entered<Effect::environment>();
  const Scene& scene = *frame.scene;
  const bool scatters = environment_lights_diffuse(frame.mask) && !is_zero(s.diffuse),
             shines = reflects_surroundings(m);
  Vec3 sum = {0, 0, 0};
  if (!scatters && !shines) return sum;
  const Vec3 irradiance = environment_irradiance(scene.environment_info[0], s.normal);
  if (scatters) sum = s.diffuse * irradiance;
  if (!shines) return sum;
  const Vec3 specular = reflectance_at(s, m.specular, m.specular_tinted);
  return sum + reflected_environment(scene, m, specular, s.normal, ray.direction, irradiance);
}

template <SurroundingsFunction light>
void surface(const FrameData& frame, const Ray& ray, const Hit& hit, Surface* s) {
  frame.plain_surface(frame, ray, hit, s);
  s->glow += light(frame, ray, *s->material, *s);
}

template <SurroundingsFunction light>
void first_surface(const FrameData& frame, const Ray& ray, const Hit& hit, Surface* s) {
  frame.plain_first_surface(frame, ray, hit, s);
  s->glow += light(frame, ray, *s->material, *s);
}

template <SurroundingsFunction light>
void put_in_front(FrameData* frame) {
  frame->surface = surface<light>, frame->first_surface = first_surface<light>;
}

}  // namespace

SurroundingsFunction find_surroundings_function(const FrameData& frame) {
  CHECK(frame.scene != nullptr);
  if (has(kAllEffects, Effect::environment) && environment_lights(*frame.scene, frame.mask, frame.settings.indirect))
    return environment_light;
  return has(frame.mask, Effect::ambient_gloss) ? even_light : nullptr;
}

void add_surroundings(FrameData* frame) {
  CHECK(frame != nullptr && frame->surface != nullptr && frame->first_surface != nullptr);
  CHECK(frame->surroundings != nullptr);
  frame->plain_surface = frame->surface, frame->plain_first_surface = frame->first_surface;
  frame->surroundings == even_light ? put_in_front<even_light>(frame) : put_in_front<environment_light>(frame);
}

}  // namespace pocketray
