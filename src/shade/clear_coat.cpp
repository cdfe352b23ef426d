#include "shade/clear_coat.h"

#include "effect/effect_probe.h"
#include "indirect/environment.h"
#include "indirect/surroundings.h"
#include "shade/ambient_gloss.h"
#include "shade/normal_map.h"
#include "shade/texture.h"

namespace pocketray {
namespace {

Vec3 coat_normal(const FrameData& frame, const ClearCoat& coat, const Ray& ray, const Vec3& normal, Surface* s) {
  if (coat.normal.texture == kNone || !has(frame.mask, Effect::normal_map)) return normal;
  const Vec3 own = s->normal, texel = frame.kernels.numbers(frame, coat.normal, *s);
  s->normal = normal;
  const Vec3 mapped = mapped_normal(frame, coat.normal_scale, texel, ray, *s);
  s->normal = own;
  return mapped;
}

}  // namespace

void find_coat(const FrameData& frame, const Ray& ray, const Vec3& normal, Surface* s) {
  const Scene& scene = *frame.scene;
  s->coat = {1, 0, 0, 0, normal};
  if (!has(frame.mask, Effect::clear_coat)) return;
  const ClearCoat* coat = coat_of(scene, static_cast<std::uint32_t>(s->material - scene.materials.data));
  if (!coat) return;
  effect_entered<Effect::clear_coat>();
  float strength = coat->strength, roughness = coat->roughness;
  if (coat->strength_texture.texture != kNone)
    strength *= frame.kernels.numbers(frame, coat->strength_texture, *s).x / 255;
  if (!(strength > 0)) return;
  if (coat->roughness_texture.texture != kNone) {
    roughness *= frame.kernels.numbers(frame, coat->roughness_texture, *s).y / 255;
    if (roughness < coat->roughness_low) roughness = coat->roughness_low;
  }
  s->coat.normal = coat_normal(frame, *coat, ray, normal, s);
  const float reflected = strength * coat_fresnel(dot(s->coat.normal, ray.direction) / length(ray.direction));
  s->coat.passes = 1 - reflected;
  s->coat.roughness = roughness;
  const float mirrored = coat_mirror_share(roughness);
  if (has(frame.mask, Effect::specular) && mirrored < 1) s->coat.lobe = strength;
  if (has(frame.mask, Effect::mirror)) s->coat.mirror = reflected * mirrored;
  if (s->coat.mirror > 0) effect_entered<Effect::mirror>();
}

void add_coat(const FrameData& frame, const Ray& ray, float open, Surface* s) {
  const SurfaceCoat& coat = s->coat;
  s->glow = s->glow * coat.passes;
  s->diffuse = s->diffuse * coat.passes;
  if (!frame.kernels.surroundings || !(coat.lobe > 0)) return;
  const Scene& scene = *frame.scene;
  const Material m = coat_lobe(coat.roughness);
  Vec3 reflected;
  if (environment_lights(scene, frame.mask, frame.settings.indirect)) {
    effect_entered<Effect::environment>();
    const Vec3 irradiance = environment_irradiance(scene.environment_info[0], coat.normal);
    reflected = reflected_environment(scene, m, m.specular, coat.normal, ray.direction, irradiance);
    if (stores_surroundings(frame)) {
      const IndoorLight indoors = indoor_light(frame, *s, irradiance);
      const float cosine = dot(coat.normal, ray.direction);
      reflected = reflected * indoors.share + reflected_surroundings(indoors.even, m, m.specular, cosine);
    }
  } else {
    effect_entered<Effect::ambient_gloss>();
    reflected = reflected_surroundings(even_surroundings(frame, *s), m, m.specular, dot(coat.normal, ray.direction));
  }
  s->glow += reflected * (coat.lobe * open);
}

float coat_reflection(const Surface& s, const Vec3& to_viewer, const Vec3& to_light) {
  const SurfaceCoat& coat = s.coat;
  const float cosine = dot(coat.normal, to_light);
  if (!(coat.lobe > 0) || !(cosine > 0)) return 0;
  effect_entered<Effect::specular>();
  const Material m = coat_lobe(coat.roughness);
  const LobeFrame frame = {coat.normal, {0, 0, 0}};
  return kBrdfList[kGgx]->value(m, m.specular, {0, 0, 0}, frame, to_viewer, to_light).x * (coat.lobe * cosine);
}

}  // namespace pocketray
