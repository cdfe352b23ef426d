#include "shade/sheen.h"

#include "base/check.h"
#include "effect/effect_probe.h"
#include "shade/texture.h"

namespace pocketray {

float find_sheen(const FrameData& frame, const Ray& ray, Surface* s) {
  CHECK(s != nullptr && s->material != nullptr);
  const Scene& scene = *frame.scene;
  s->sheen = {{0, 0, 0}, s->diffuse, 0};
  if (!has(frame.mask, Effect::sheen)) return 1;
  const Sheen* sheen = sheen_of(scene, static_cast<std::uint32_t>(s->material - scene.materials.data));
  if (!sheen) return 1;
  effect_entered<Effect::sheen>();
  Vec3 color = sheen->color;
  if (sheen->color_texture.texture != kNone) color *= frame.kernels.color(frame, sheen->color_texture, *s).rgb;
  if (is_zero(color)) return 1;
  float roughness = sheen->roughness;
  if (sheen->roughness_texture.texture != kNone) {
    roughness *= frame.kernels.color(frame, sheen->roughness_texture, *s).alpha;
    if (roughness < sheen->roughness_low) roughness = sheen->roughness_low;
  }
  s->sheen.color = color, s->sheen.roughness = roughness;
  const float albedo = sheen_albedo(roughness, dot(s->normal, ray.direction) / length(ray.direction));
  const float passes = 1 - max_component(color) * albedo;
  s->diffuse += color * (albedo / passes);
  return passes;
}

}  // namespace pocketray
