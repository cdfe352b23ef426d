#include "shade/material_maps.h"

#include <cstring>

#include "base/check.h"
#include "effect/effect_probe.h"
#include "scene/metallic_roughness.h"
#include "shade/clear_coat.h"
#include "shade/diffuse_transmission.h"
#include "shade/film.h"
#include "shade/instances.h"
#include "shade/normal_map.h"
#include "shade/rough_glass.h"
#include "shade/sheen.h"
#include "shade/texture.h"
#include "shade/transmission.h"

namespace pocketray {
namespace {

const MaterialMaps* maps_of(const Scene& scene, const Surface& s) {
  return scene.material_maps.count ? &scene.material_maps[static_cast<std::uint32_t>(s.material - scene.materials.data)]
                                   : nullptr;
}

std::uint32_t material_of(const Scene& scene, const Surface& s) {
  return static_cast<std::uint32_t>(s.material - scene.materials.data);
}
const GlassMap* glass_of(const Scene& scene, const Surface& s) { return glass_map_of(scene, material_of(scene, s)); }

float within(float x, float low, float high) { return x > low ? (x < high ? x : high) : low; }

// The last lookup at a point: many files store occlusion in the red channel of their metallic-roughness texture.
struct LookUp {
  const TextureUse* use = nullptr;
  Vec3 numbers;
};

// `uv` are the first texture coordinates.
template <EffectMask mask>
Vec3 numbers_of(const FrameData& frame, const TextureUse& use, const Surface& s, Vec2 uv) {
  if constexpr (has(mask, Effect::second_uv)) return frame.kernels.numbers(frame, use, s);
  return numbers_at<has(mask, Effect::mip_map)>(*frame.scene, use, uv, frame.settings.texture_filter, s.footprint);
}

template <EffectMask mask>
const Vec3& look_up(const FrameData& frame, const TextureUse& use, const Surface& s, Vec2 uv, LookUp* last) {
  if (!last->use || std::memcmp(last->use, &use, sizeof use) != 0) *last = {&use, numbers_of<mask>(frame, use, s, uv)};
  return last->numbers;
}

// `use`: the texture, or none.
template <EffectMask mask>
void apply_metallic_roughness(const FrameData& frame, const MaterialMaps& maps, const TextureUse& use, Vec2 uv,
                              LookUp* last, Surface* s) {
  Vec3 numbers = {255, 255, 255};
  if (use.texture != kNone) numbers = look_up<mask>(frame, use, *s, uv, last);
  const float metallic = within(maps.metallic * (numbers.z / 255), maps.metallic_low, maps.metallic_high);
  s->metallic = static_cast<std::uint16_t>(metallic * 65535 + 0.5f);
  s->roughness = within(maps.roughness * (numbers.y / 255), maps.roughness_low, maps.roughness_high);
  s->diffuse = maps.model.base * (1 - metallic);
  if (s->is_tinted) s->diffuse *= s->tint;
}

void apply_specular(const FrameData& frame, const MaterialMaps& maps, const Surface& s, MetallicRoughness* model) {
  if (maps.specular.texture != kNone) {
    const float share = frame.kernels.color(frame, maps.specular, s).alpha;
    model->dielectric = model->dielectric * share, model->grazing *= share;
  }
  if (maps.specular_color.texture != kNone) model->dielectric *= frame.kernels.color(frame, maps.specular_color, s).rgb;
}

// Fraction of ambient light left by the map.
template <EffectMask mask>
float openness(const FrameData& frame, const MaterialMaps& maps, const Surface& s, Vec2 uv, LookUp* last) {
  effect_entered<Effect::occlusion>();
  const float open = look_up<mask>(frame, maps.occlusion, s, uv, last).x / 255;
  return 1 + maps.occlusion_strength * (open - 1);
}

// An instance that holds the code of all maps asks the plan for the effect.
template <EffectMask mask>
bool takes_part(const FrameData& frame, Effect effect) {
  return !(mask & kHoldingMaps & kEffectsBuilt) || has(frame.mask, effect);
}

// Attenuates the base by its sheen, and both by a coat. `normal`: at the vertices, `open`: unoccluded fraction of
// ambient light.
void add_layers(const FrameData& frame, const Ray& ray, const Vec3& normal, float passes, float open, Surface* s) {
  s->glow = s->glow * passes, s->diffuse = s->diffuse * passes, s->sheen.base = s->sheen.base * passes;
  find_coat(frame, ray, normal, s);
  const float through_coat = s->coat.passes;
  if (through_coat < 1) {
    add_coat(frame, ray, open, s);
    s->sheen.color = s->sheen.color * through_coat, s->sheen.base = s->sheen.base * through_coat;
  }
  s->coat.passes = through_coat * passes;
}

template <EffectMask mask>
void mapped_surface(const FrameData& frame, const Ray& ray, const Hit& hit, Surface* s) {
  frame.kernels.plain_surface(frame, ray, hit, s);
  const Scene& scene = *frame.scene;
  float open = 1;
  LookUp last;
  const Vec3 unmapped = s->normal;
  if (const MaterialMaps* maps = maps_of(scene, *s)) {
    const Vec2 uv = scene.uvs.count ? hit_uv(scene, hit.triangle, hit.u, hit.v) : Vec2{0, 0};
    if constexpr (has(mask, Effect::normal_map)) {
      if (maps->normal.texture != kNone && takes_part<mask>(frame, Effect::normal_map)) {
        s->normal = mapped_normal(frame, maps->normal_scale, numbers_of<mask>(frame, maps->normal, *s, uv), ray, *s);
      }
    }
    if constexpr (has(mask, Effect::metallic_roughness)) {
      if (has_lobe_map(*maps) && takes_part<mask>(frame, Effect::metallic_roughness)) {
        effect_entered<Effect::metallic_roughness>();
        apply_metallic_roughness<mask>(frame, *maps, maps->metallic_roughness, uv, &last, s);
      }
    }
    if constexpr (has(mask, Effect::transmission_map)) {
      const GlassMap* glass = has(frame.mask, Effect::transmission_map) ? glass_of(scene, *s) : nullptr;
      if (glass) {
        if (!has(frame.mask, Effect::metallic_roughness) || !has_lobe_map(*maps))
          apply_metallic_roughness<mask>(frame, *maps, TextureUse(), uv, &last, s);
        find_transmission(frame, *glass, s);
      }
    }
    if constexpr (has(mask, Effect::occlusion)) {
      if (maps->occlusion.texture != kNone && takes_part<mask>(frame, Effect::occlusion))
        open = openness<mask>(frame, *maps, *s, uv, &last);
    }
  }
  if constexpr (has(mask, Effect::anisotropy)) {
    s->grain = {0, 0, 0};
    if (scene.grains.count && (!has(mask, Effect::second_uv) || has(frame.mask, Effect::anisotropy)))
      s->grain = surface_grain(frame, scene.grains[s->material - scene.materials.data], *s);
  }
  if constexpr (has(mask, Effect::iridescence)) {
    s->film.strength = 0;
    if (has(frame.mask, Effect::iridescence) && iridescence_of(scene, material_of(scene, *s))) {
      Material mapped;
      const Material& lobes = lobes_at(frame, *s, &mapped);
      find_film(frame, ray, lobes, s);
    }
  }
  float passes = 1;  // through the sheen
  const bool has_layers = (mask & kLayerEffects & kEffectsBuilt) != 0 && (frame.mask & kLayerEffects) != 0;
  if (has_layers) dim_by_passing(frame, s), passes = find_sheen(frame, ray, s);
  frame.kernels.glow(frame, s);
  if constexpr (has(mask, Effect::occlusion)) {
    if (has(frame.mask, Effect::ambient) && takes_part<mask>(frame, Effect::occlusion))
      s->glow += AmbientIndirect::radiance({scene, nullptr, s->point, s->normal, s->diffuse}) * open;
  }
  if (frame.kernels.surroundings) {
    Material mapped;
    s->glow += frame.kernels.surroundings(frame, ray, lobes_at(frame, *s, &mapped), *s) * open;
  }
  if (has_layers) add_layers(frame, ray, unmapped, passes, open, s);
}

struct MapsPart {
  using Function = SurfaceFunction;
  static constexpr auto kTable = kMapsTable;
  template <EffectMask mask>
  static constexpr Function instance() {
    return mapped_surface<mask>;
  }
};

}  // namespace

const Material& lobes_at(const FrameData& frame, const Surface& s, Material* mapped) {
  const MaterialMaps* maps = maps_of(*frame.scene, s);
  const bool varies = maps && has(frame.mask, Effect::metallic_roughness) && has_lobe_map(*maps);
  const bool is_glass = has(frame.mask, Effect::transmission_map) && glass_of(*frame.scene, s);
  const bool has_film = has(frame.mask, Effect::iridescence) && s.film.strength > 0;
  const bool is_inside = has(frame.mask, Effect::rough_refraction) && leaves_body(s) && is_rough_glass(*s.material);
  if (!varies && !is_glass && !has_film && !is_inside) return *s.material;
  *mapped = *s.material;
  if (varies || is_glass) {
    MetallicRoughness model = maps->model;
    if (varies && (maps->specular.texture != kNone || maps->specular_color.texture != kNone))
      apply_specular(frame, *maps, s, &model);
    set_lobes(model, static_cast<float>(s.metallic) / 65535, s.roughness, is_glass ? s.transmission : 0, mapped);
  }
  if (has_film) put_film_on(s, mapped);
  if (is_inside) mapped->specular = mapped->specular_tinted = {0, 0, 0}, mapped->grazing = 0;
  return *mapped;
}

void add_material_maps(FrameData* frame) {
  CHECK(frame != nullptr && frame->scene != nullptr);
  CHECK((frame->mask & kMapEffects) != 0);
  EffectMask glow = frame->mask;
  if (has(glow, Effect::occlusion)) glow &= ~bit(Effect::ambient);  // mapped_surface() adds it
  frame->kernels.plain_surface = find_surface_function(frame->mask & ~bit(Effect::emission) & ~kIndirectEffects);
  frame->kernels.glow = find_glow_function(glow);
  frame->kernels.surface = Instantiations<MapsPart>::find(frame->mask);
}

}  // namespace pocketray
