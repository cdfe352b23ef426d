#include "shade/ambient_gloss.h"

#include "base/check.h"
#include "effect/effect_probe.h"
#include "indirect/environment.h"
#include "indirect/indirect_list.h"
#include "shade/surface.h"

namespace pocketray {
namespace {

Vec3 even_light(const FrameData& frame, const Ray& ray, const Material& m, const Surface& s) {
  if (!reflects_surroundings(m)) return {0, 0, 0};
  effect_entered<Effect::ambient_gloss>();
  const Vec3 specular = reflectance_at(s, m.specular, m.specular_tinted);
  const float cosine = dot(s.normal, ray.direction);
  const bool is_even = !has(frame.mask, Effect::anisotropy) || is_zero(s.grain);
  return reflected_surroundings(even_surroundings(frame, s), is_even ? m : evened(m, s), specular, cosine);
}

enum class Place { open, shadowed, indoors };

template <Place place>
Vec3 environment_light(const FrameData& frame, const Ray& ray, const Material& m, const Surface& s) {
  effect_entered<Effect::environment>();
  const Scene& scene = *frame.scene;
  const bool scatters = place == Place::open && environment_lights_diffuse(frame.mask) && !is_zero(s.diffuse),
             shines = reflects_surroundings(m);
  Vec3 sum = {0, 0, 0};
  if (!scatters && !shines) return sum;
  const Vec3 irradiance = environment_irradiance(scene.environment_info[0], s.normal);
  if (scatters) sum = s.diffuse * irradiance;
  if (!shines) return sum;
  const Vec3 specular = reflectance_at(s, m.specular, m.specular_tinted);
  const bool is_even = !has(frame.mask, Effect::anisotropy) || is_zero(s.grain);
  const Vec3 reflected = is_even ? reflected_environment(scene, m, specular, s.normal, ray.direction, irradiance)
                                 : reflected_along_grain(scene, m, specular, s, ray.direction, irradiance);
  if (place != Place::indoors) return sum + reflected;
  const IndoorLight indoors = indoor_light(frame, s, irradiance);
  return reflected * indoors.share +
         reflected_surroundings(indoors.even, is_even ? m : evened(m, s), specular, dot(s.normal, ray.direction));
}

template <SurroundingsFunction light>
void surface(const FrameData& frame, const Ray& ray, const Hit& hit, Surface* s) {
  frame.kernels.plain_surface(frame, ray, hit, s);
  s->glow += light(frame, ray, *s->material, *s);
}

template <SurroundingsFunction light>
void put_in_front(FrameData* frame) {
  frame->kernels.surface = surface<light>;
}

}  // namespace

bool stores_surroundings(const FrameData& frame) {
  return has(frame.mask, Effect::radiosity) && !frame.scene->radiosity_info.empty();
}

IndoorLight indoor_light(const FrameData& frame, const Surface& s, const Vec3& irradiance) {
  IndoorLight light = {{1, 1, 1}, {0, 0, 0}};
  const Vec3 stored = even_surroundings(frame, s);
  for (int c = 0; c < 3; ++c) {
    // Squared, as the part that arrives comes from everywhere rather than from where the sky is bright.
    const float part = stored[c] < irradiance[c] ? stored[c] / irradiance[c] : 1;
    light.share[c] = part * part;
    light.even[c] = stored[c] - light.share[c] * irradiance[c];
  }
  return light;
}

Vec3 even_surroundings(const FrameData& frame, const Surface& s) {
  if (!stores_surroundings(frame)) return radiance_of_surroundings(frame.scene->info);
  constexpr Vec3 kWhite = {1, 1, 1};
  Vec3 sum = {0, 0, 0};
  for (int i = 0; i < IndirectList::kCount; ++i) {
    const IndirectInfo& info = IndirectList::kInfos[i];
    if (info.effects & bit(Effect::radiosity))
      sum = info.radiance({*frame.scene, frame.indirect.prepared[i], s.point, s.normal, kWhite, s.hit.triangle, s.hit.u,
                           s.hit.v, s.front, frame.settings.reconstruction});
  }
  return sum;
}

void find_surroundings(FrameData* frame) {
  CHECK(frame != nullptr && frame->scene != nullptr);
  frame->kernels.surroundings = has(frame->mask, Effect::ambient_gloss) ? even_light : nullptr;
  if (!has(kAllEffects, Effect::environment) ||
      !environment_lights(*frame->scene, frame->mask, frame->settings.indirect))
    return;
  frame->kernels.surroundings = stores_surroundings(*frame)                    ? environment_light<Place::indoors>
                                : has(frame->mask, Effect::environment_shadow) ? environment_light<Place::shadowed>
                                                                               : environment_light<Place::open>;
}

void add_surroundings(FrameData* frame) {
  CHECK(frame != nullptr && frame->kernels.surface != nullptr);
  CHECK(frame->kernels.surroundings != nullptr);
  frame->kernels.plain_surface = frame->kernels.surface;
  if (frame->kernels.surroundings == even_light)
    put_in_front<even_light>(frame);
  else if (frame->kernels.surroundings == environment_light<Place::open>)
    put_in_front<environment_light<Place::open>>(frame);
  else if (frame->kernels.surroundings == environment_light<Place::shadowed>)
    put_in_front<environment_light<Place::shadowed>>(frame);
  else
    put_in_front<environment_light<Place::indoors>>(frame);
}

}  // namespace pocketray
