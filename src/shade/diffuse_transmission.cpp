#include "shade/diffuse_transmission.h"

#include "base/check.h"
#include "effect/effect_probe.h"
#include "shade/indirect_light.h"
#include "shade/texture.h"

namespace pocketray {
namespace {

const DiffuseTransmission* passing_of(const FrameData& frame, const Surface& s) {
  const Scene& scene = *frame.scene;
  return diffuse_transmission_of(scene, static_cast<std::uint32_t>(s.material - scene.materials.data));
}

float strength_at(const FrameData& frame, const DiffuseTransmission& passing, const Surface& s) {
  const TextureUse& texture = passing.strength_texture;
  return texture.texture == kNone ? passing.strength : passing.strength * frame.kernels.color(frame, texture, s).alpha;
}

// Fraction of light that enters by Schlick's formula, of the brightest channel.
float entering(const Surface& s, const Material& lobes, const Ray& ray) {
  if (is_zero(lobes.specular) && is_zero(lobes.mirror)) return 1;
  const Vec3 reflectance =
      reflectance_at(s, lobes.specular, lobes.specular_tinted) + reflectance_at(s, lobes.mirror, lobes.mirror_tinted);
  const float cosine = -dot(s.normal, ray.direction) / length(ray.direction);
  const float away = 1 - (cosine > 0 ? cosine : 0), square = away * away;
  const float enters = (1 - max_component(reflectance)) * (1 - square * square * away);
  return enters > 0 ? enters : 0;
}

}  // namespace

void dim_by_passing(const FrameData& frame, Surface* s) {
  CHECK(s != nullptr && s->material != nullptr);
  if (!has(frame.mask, Effect::diffuse_transmission)) return;
  if (const DiffuseTransmission* passing = passing_of(frame, *s))
    s->diffuse = s->diffuse * (1 - strength_at(frame, *passing, *s));
}

bool find_other_side(const FrameData& frame, const Ray& ray, const Surface& s, const Material& lobes, Surface* other) {
  CHECK(other != nullptr && other != &s);
  const DiffuseTransmission* passing = passing_of(frame, s);
  if (!passing) return false;
  effect_entered<Effect::diffuse_transmission>();
  Vec3 albedo = passing->color * (strength_at(frame, *passing, s) * s.coat.passes * entering(s, lobes, ray));
  if (passing->color_texture.texture != kNone) albedo *= frame.kernels.color(frame, passing->color_texture, s).rgb;
  if (is_zero(albedo)) return false;
  *other = s;
  other->front = !s.front, other->is_tinted = false;
  other->normal = -s.normal, other->geometric = -s.geometric, other->offset = -s.offset;
  other->diffuse = albedo;
  other->coat = {1, 0, 0, 0, {0, 0, 0}}, other->sheen = {{0, 0, 0}, albedo, 0}, other->film.strength = 0;
  other->glow = albedo * stored_light(frame, *other);
  if (frame.kernels.surroundings) {
    static constexpr Material kMatte;
    other->glow += frame.kernels.surroundings(frame, ray, kMatte, *other);
  }
  return true;
}

}  // namespace pocketray
