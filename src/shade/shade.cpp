// From a ray to radiance: recursive ray tracing after [Whitted 1980], [Aranha07] sec. 3.1, instantiated for the effects
// of the plan: an absent effect has no code at all, not even a branch.
#include "shade/shade.h"

#include <algorithm>
#include <type_traits>

#include "base/check.h"
#include "indirect/environment.h"
#include "shade/branches.h"
#include "shade/contact.h"
#include "shade/diffuse_transmission.h"
#include "shade/direct.h"
#include "shade/film.h"
#include "shade/instances.h"
#include "shade/interleaved.h"
#include "shade/material_maps.h"
#include "shade/rough_glass.h"
#include "shade/selected_light.h"
#include "shade/transmission.h"

namespace pocketray {
namespace {

// Without refraction there are no media, and the width of beams is the business of the instance of coats.
struct NoMedia {};
template <EffectMask mask>
using Media = std::conditional_t<has(mask, Effect::refraction), MediumStack, NoMedia>;
struct NoWidth {};
template <EffectMask mask>
using Width = std::conditional_t<has(mask, Effect::clear_coat), BeamWidth, NoWidth>;

template <EffectMask mask, bool has_footprints = has(mask, Effect::mip_map)>
struct Path {
  Vec3 weight;          // throughput of the path so far; bounds the contribution of a ray to the sample
  std::uint32_t depth;  // reflections and refractions so far
  Media<mask> media;
  Width<mask> width;
};
template <EffectMask mask>
struct Path<mask, true> {
  Vec3 weight;
  std::uint32_t depth;
  Media<mask> media;
  Width<mask> width;
  float distance = 0;  // along the path from the eye to its last surface
};

// The hit with the distance along the path, as surface functions expect it.
template <EffectMask mask>
Hit on_path(Hit hit, const Path<mask>& path) {
  if constexpr (has(mask, Effect::mip_map)) hit.t = path.distance;
  return hit;
}

template <EffectMask mask>
Vec3 radiance(Tracer* tracer, const Ray& ray, const Path<mask>& path);

// True if a surface can both reflect and transmit, or has a reflecting coat as well.
template <EffectMask mask>
constexpr bool kBranches = has(mask, Effect::refraction) || has(mask, Effect::clear_coat);

// Counts a ray ended by the maximum depth and replaced by radiance `seen`. Its true radiance is bounded for
// kRayDepthMax further reflections and refractions.
inline void end_ray(Tracer* tracer, float weight, const Vec3& seen) {
  ++tracer->rays_ended;
  tracer->ended_weight_max = std::max(tracer->ended_weight_max, weight);
  const float bound = tracer->frame->cut_off.radiance_bounds.after[kRayDepthMax];
  const float least = std::min(seen.x, std::min(seen.y, seen.z));
  if (weight > 0) tracer->branching.ended += weight * std::max(max_component(seen), bound - least);
}

// True if the frame has an environment: --effects can force the effect on without one.
template <EffectMask mask>
bool has_environment(const FrameData& frame) {
  if constexpr (has(mask, Effect::environment)) return environment_of(*frame.scene) != nullptr;
  return false;
}

// Radiance of a ray that hits nothing.
template <EffectMask mask>
Vec3 radiance_behind(const FrameData& frame, const Vec3& direction) {
  if (!has_environment<mask>(frame)) return frame.scene->info.background;
  effect_entered<Effect::environment>();
  return environment_radiance(*frame.scene, direction);
}
template <EffectMask mask>
Vec3 radiance_behind(const FrameData& frame, const Vec3& direction, const Path<mask>& path) {
  if constexpr (has(mask, Effect::clear_coat))
    if (path.width.alpha > 0 && has_environment<mask>(frame)) {
      effect_entered<Effect::environment>();
      return environment_in_beam(*frame.scene, direction, path.width.alpha);
    }
  return radiance_behind<mask>(frame, direction);
}

// Radiance along a spawned ray: zero if it cannot matter, the surroundings' radiance beyond the path's maximum depth.
template <EffectMask mask>
Vec3 spawn(Tracer* tracer, RayKind kind, const Surface& s, const Vec3& direction, float side, const Path<mask>& path,
           const Vec3& weight) {
  const FrameData& frame = *tracer->frame;
  if (path.depth >= frame.settings.ray_depth) {
    const Vec3 seen =
        has_environment<mask>(frame) ? radiance_behind<mask>(frame, direction, path) : frame.cut_off.beyond_depth;
    end_ray(tracer, max_component(path.weight * weight), seen);
    return weight * seen;
  }
  Path<mask> next = path;
  next.weight = path.weight * weight;
  next.depth = path.depth + 1;
  float most = max_component(next.weight);
  const std::uint32_t further = frame.settings.ray_depth - next.depth;
  if (!(most > 0) || leave_out(tracer, most * frame.cut_off.radiance_bounds.after[further])) return {0, 0, 0};
  ++tracer->rays[static_cast<int>(kind)];
  return weight * radiance<mask>(tracer, {safe_origin(s, side), direction, __builtin_inff()}, next);
}

// Perfect mirror. If the normal would reflect the ray below the surface, the geometric normal is used.
template <EffectMask mask>
Vec3 mirror(Tracer* tracer, RayKind kind, const Ray& ray, const Surface& s, const Vec3& normal, const Path<mask>& path,
            const Vec3& weight) {
  Vec3 direction = reflect(ray.direction, normal);
  if (!(dot(direction, s.geometric) > 0)) direction = reflect(ray.direction, s.geometric);
  return spawn<mask>(tracer, kind, s, normalize(direction), 1, path, weight);
}

// Transmission by the facets of a rough boundary with the normal n: one ray, which looks up environments and textures
// as widely as its beam. Four rays at the first surface took 2.7 times as long and were farther from the reference.
template <EffectMask mask>
Vec3 scattered(Tracer* tracer, const Ray& ray, const Surface& s, const Material& lobes, const Vec3& n, float eta,
               Path<mask> beyond, const Vec3& weight) {
  effect_entered<Effect::rough_refraction>();
  const FacetPassage<float> passage = through_facets(lobes, ray.direction, n, eta);
  beyond.width.alpha = widened_beam(lobes, beyond.width.alpha, eta);
  if (!(passage.share > 0) || !(dot(passage.direction, s.geometric) < 0)) return {0, 0, 0};
  return spawn<mask>(tracer, RayKind::refraction, s, passage.direction, -1, beyond, weight * passage.share);
}

// A dielectric boundary: reflects by Fresnel; the rest is transmitted, refracted by Snell. A metallic reflection of the
// surface shares the reflected ray, so that the tree of rays has two branches, not three.
template <EffectMask mask>
Vec3 dielectric(Tracer* tracer, const Ray& ray, const Surface& s, const Material& lobes, const Contact& contact,
                const Path<mask>& path, const Vec3& mirrored) {
  effect_entered<Effect::refraction>();
  const Scene& scene = *tracer->frame->scene;
  const Material& m = *s.material;
  Path<mask> beyond = path;
  float eta;
  if (m.thin) {
    eta = 1 / m.ior;
  } else {
    float from = medium_ior(scene, path.media);
    cross_contact(scene, contact, &beyond.media);
    eta = from / medium_ior(scene, beyond.media);
  }
  Vec3 n = -dot(ray.direction, s.normal) > 0 ? s.normal : s.geometric;
  float cos_i = -dot(ray.direction, n), cos_t;
  float reflected = fresnel(cos_i, eta, &cos_t);
  if (eta == 1) reflected = 0, cos_t = cos_i;  // touching bodies of equal index: no reflection from rounding
  if (m.thin && reflected < 1) reflected = 2 * reflected / (1 + reflected);  // both faces of the sheet, all orders
  Vec3 turned = Vec3{reflected, reflected, reflected}, passing = {1 - reflected, 1 - reflected, 1 - reflected};
  bool is_rough = false;
  if constexpr (has(mask, Effect::clear_coat)) {
    const EffectMask plan = tracer->frame->mask;
    if (has(plan, Effect::iridescence) && s.film.strength > 0) {
      turned = film_at_boundary(s.film, m.ior, reflected, eta < 1 ? cos_i : cos_t);
      passing = Vec3{1, 1, 1} - turned;
    }
    is_rough = has(plan, Effect::rough_refraction) && is_rough_glass(m) && lobes.roughness > kAlphaMin;
    if (is_rough) divide_at_facets(s, lobes, &turned, &passing);
  }
  turned += mirrored;
  Vec3 by_mirror = {0, 0, 0}, passed = {0, 0, 0};
  const bool mirror_first = max_component(turned) > 1 - reflected;
  for (bool mirrors : {mirror_first, !mirror_first}) {  // the stronger branch first
    if (mirrors) {
      if (!is_zero(turned)) by_mirror = mirror<mask>(tracer, RayKind::mirror, ray, s, s.normal, path, turned);
      continue;
    }
    if (!(reflected < 1)) continue;
    Vec3 tint = {1, 1, 1};
    for (std::uint32_t i = 0; i < contact.count; ++i) {
      const Material& entered = scene.materials[contact.face[i].material];
      if (!transmits(entered, plan_of<mask>(*tracer->frame)) || !(contact.face[i].front || entered.thin)) continue;
      if constexpr (has(mask, Effect::clear_coat))
        tint *= transmission_of(*tracer->frame, ray, contact.face[i], s);
      else
        tint *= entered.transmission;
    }
    if constexpr (has(mask, Effect::clear_coat)) {
      if (is_rough) {
        passed = scattered<mask>(tracer, ray, s, lobes, n, eta, beyond, tint * passing);
        continue;
      }
      if (!m.thin) beyond.width.alpha *= eta;
    }
    Vec3 direction = m.thin ? ray.direction : normalize(refract(ray.direction, n, eta, cos_i, cos_t));
    if (!(dot(direction, s.geometric) < 0)) direction = ray.direction;  // the shading normal deviates too far
    passed = spawn<mask>(tracer, RayKind::refraction, s, direction, -1, beyond, tint * passing);
  }
  return by_mirror + passed;
}

// Mirror reflection and transmission of a coated surface. Where base and coat have one normal, they share the reflected
// ray, so that coated glass has two branches, not three.
template <EffectMask mask>
Vec3 pass_coat(Tracer* tracer, const Ray& ray, const Surface& s, const Material& m, const Contact* contact,
               const Path<mask>& path, const Vec3& mirrored) {
  const SurfaceCoat& coat = s.coat;
  const Vec3 by_coat = {coat.mirror, coat.mirror, coat.mirror};
  const bool together = coat.normal == s.normal && (is_zero(m.transmission) || coat.passes > 0);
  Vec3 sum = {0, 0, 0};
  if (coat.mirror > 0 && !together) sum = mirror<mask>(tracer, RayKind::mirror, ray, s, coat.normal, path, by_coat);
  if (!is_zero(m.transmission)) {
    Path<mask> under = path;
    under.weight = path.weight * coat.passes;
    const Vec3 besides = together ? mirrored + by_coat * (1 / coat.passes) : mirrored;
    return sum + dielectric<mask>(tracer, ray, s, m, *contact, under, besides) * coat.passes;
  }
  const Vec3 turned = together ? mirrored * coat.passes + by_coat : mirrored * coat.passes;
  if (!is_zero(turned)) sum += mirror<mask>(tracer, RayKind::mirror, ray, s, s.normal, path, turned);
  return sum;
}

// Radiance towards the viewer directly from the lights.
template <EffectMask mask>
inline Vec3 received_light(Tracer* tracer, const Surface& s, const Material& m, const Vec3& to_viewer,
                           const Vec3& weight) {
  if constexpr (has(mask, Effect::source_selection)) return selected_light<mask>(tracer, s, m, to_viewer, weight);
  return direct_light<mask>(tracer, s, m, to_viewer, weight);
}

// Adds tile lighting to a secondary hit.
template <EffectMask mask>
void add_later_light(Tracer* tracer, const Path<mask>& path, Surface* s) {
  if constexpr ((kInterleavedEffects & kEffectsBuilt) != 0 && (mask & kGoesOn) != 0)
    if (tracer->frame->kernels.add_later_light) tracer->frame->kernels.add_later_light(tracer, path.weight, s);
}

// Light that passes the surface from its other side.
template <EffectMask mask>
[[gnu::noinline]] Vec3 light_from_behind(Tracer* tracer, const Ray& ray, const Surface& s, const Material& m,
                                         const Path<mask>& path) {
  static constexpr Material kMatte;
  Surface behind;
  if (!find_other_side(*tracer->frame, ray, s, m, &behind)) return {0, 0, 0};
  add_later_light<mask>(tracer, path, &behind);
  return behind.glow + received_light<mask>(tracer, behind, kMatte, -ray.direction, path.weight);
}

// Radiance leaving the surface back along the ray; `m` has the lobes at the point.
template <EffectMask mask>
inline Vec3 shade_lobes(Tracer* tracer, const Ray& ray, const Surface& s, const Material& m, const Contact* contact,
                        const Path<mask>& path) {
  Vec3 sum = s.glow;
  bool scatters = !is_zero(s.diffuse);
  if constexpr (has(mask, Effect::specular)) scatters |= !is_zero(m.specular);
  if constexpr (has(mask, Effect::clear_coat)) scatters |= s.coat.lobe > 0 || !is_zero(s.sheen.color);
  if (scatters) sum += received_light<mask>(tracer, s, m, -ray.direction, path.weight);
  if constexpr (has(mask, Effect::clear_coat))
    if (has(tracer->frame->mask, Effect::diffuse_transmission)) sum += light_from_behind<mask>(tracer, ray, s, m, path);
  if constexpr (kBranches<mask>) add_certain(tracer, path.weight * sum);
  Vec3 mirrored = {0, 0, 0};
  if constexpr (has(mask, Effect::mirror)) {
    if (!is_zero(m.mirror)) {
      effect_entered<Effect::mirror>();
      mirrored = reflectance_at(s, m.mirror, m.mirror_tinted);
    }
  }
  if constexpr (has(mask, Effect::clear_coat))
    if (s.coat.passes < 1) return sum + pass_coat<mask>(tracer, ray, s, m, contact, path, mirrored);
  if constexpr (has(mask, Effect::refraction)) {
    if (!is_zero(m.transmission)) return sum + dielectric<mask>(tracer, ray, s, m, *contact, path, mirrored);
  }
  if constexpr (has(mask, Effect::mirror)) {
    if (!is_zero(m.mirror)) sum += mirror<mask>(tracer, RayKind::mirror, ray, s, s.normal, path, mirrored);
  }
  return sum;
}

// True if an instance holds code of effects that its plan may lack: see kRadianceTable.
template <EffectMask mask>
constexpr bool kAsksPlan = has(mask, Effect::metallic_roughness) || has(mask, Effect::mip_map) ||
                           has(mask, Effect::refraction);

// Radiance leaving the surface back along the ray. `contact` must be set if the material transmits.
template <EffectMask mask>
Vec3 shade(Tracer* tracer, const Ray& ray, const Surface& s, const Contact* contact, const Path<mask>& path) {
  if constexpr (kAsksPlan<mask>) {
    const EffectMask plan = tracer->frame->mask;
    Material mapped;
    const Material* m = s.material;
    if constexpr (has(mask, Effect::metallic_roughness)) m = &lobes_at(*tracer->frame, s, &mapped);
    const bool shines = has(mask, Effect::specular) && !has(plan, Effect::specular) && !is_zero(m->specular);
    const bool mirrors = has(mask, Effect::mirror) && !has(plan, Effect::mirror) && !is_zero(m->mirror);
    const bool transmits = has(mask, Effect::refraction) && !has(plan, Effect::refraction) && !is_zero(m->transmission);
    if (shines || mirrors || transmits) {
      if (m != &mapped) mapped = *m;
      if (transmits) mapped.transmission = {0, 0, 0};
      if (shines) mapped.specular = {0, 0, 0};
      if (mirrors) mapped.mirror = {0, 0, 0};
      m = &mapped;
    }
    return shade_lobes<mask>(tracer, ray, s, *m, contact, path);
  } else {
    return shade_lobes<mask>(tracer, ray, s, *s.material, contact, path);
  }
}

// Adds the blending surfaces of a contact, one over the other. Returns false if nothing behind them matters.
template <EffectMask mask>
bool blend_layers(Tracer* tracer, const Ray& ray, const Contact& contact, Vec3* sum, Vec3* carried, Path<mask>* path) {
  const FrameData& frame = *tracer->frame;
  const Scene& scene = *frame.scene;
  const EffectMask plan = plan_of<mask>(frame);
  bool any = false;
  for (std::uint32_t i = 0; i < contact.count; ++i) {
    const Face& face = contact.face[i];
    const Material& m = scene.materials[face.material];
    if (!blends(m, plan) || culls(m, face.front, plan)) continue;
    any = true;
    Surface s;
    frame.kernels.surface(frame, ray, on_path(face.hit, *path), &s);
    const Footprints& footprints = has(mask, Effect::mip_map) ? s.footprint : kNoFootprints;
    float alpha =
        hit_alpha<Effect::alpha_blend>(frame, *s.material, face.hit.triangle, face.hit.u, face.hit.v, footprints);
    Path<mask> covered = *path;
    covered.weight = path->weight * alpha;
    if (alpha > 0) {
      add_later_light<mask>(tracer, covered, &s);
      *sum += *carried * alpha * shade<mask>(tracer, ray, s, &contact, covered);
    }
    *carried = *carried * (1 - alpha);
    path->weight = path->weight * (1 - alpha);
  }
  float most = max_component(path->weight);
  const std::uint32_t further = frame.settings.ray_depth - path->depth;
  return !any || (most > 0 && !leave_out(tracer, most * frame.cut_off.radiance_bounds.after[further]));
}

// Returns the face that a ray meets behind the blending surfaces of a contact: an opaque one, else a body that it
// enters or leaves, else a thin sheet; null if there is none.
const Face* face_behind_layers(const Scene& scene, const Contact& contact, EffectMask mask) {
  const Face *body = nullptr, *sheet = nullptr;
  for (std::uint32_t i = 0; i < contact.count; ++i) {
    const Face& face = contact.face[i];
    const Material& m = scene.materials[face.material];
    if (blends(m, mask) || culls(m, face.front, mask)) continue;
    if (!transmits(m, mask)) return &face;
    const Face*& kind = m.thin ? sheet : body;
    if (!kind) kind = &face;
  }
  return body ? body : sheet;
}

// Radiance along a ray with first hit `hit`; `first` is the surface there, or null.
template <EffectMask mask>
Vec3 radiance_from(Tracer* tracer, Ray ray, Hit hit, const Surface* first, Path<mask> path) {
  const FrameData& frame = *tracer->frame;
  const Scene& scene = *frame.scene;
  const HitFilter* filter = visible_filter(frame);
  const EffectMask plan = plan_of<mask>(frame);
  Vec3 sum = {0, 0, 0}, carried = {1, 1, 1};  // throughput of the blended surfaces
  for (std::uint32_t layer = 0; layer < kTransparentLayerMax; ++layer) {
    if (layer > 0) frame.geometry.accel_info->closest(frame.geometry.accel, ray, filter, &hit, &tracer->stats);
    if (hit.triangle == kNoTriangle) {
      const Vec3 behind = radiance_behind<mask>(frame, ray.direction, path);
      if constexpr (kBranches<mask>) add_certain(tracer, path.weight * behind);
      return sum + carried * behind;
    }
    if constexpr (has(mask, Effect::mip_map)) path.distance += hit.t;
    if constexpr (has(mask, Effect::mip_map) && has(mask, Effect::clear_coat))
      path.distance += widened(frame, path.width, hit.t);
    Surface found;
    const Surface* s = first;
    if (layer > 0 || !first) frame.kernels.surface(frame, ray, on_path(hit, path), &found), s = &found;
    if constexpr (has(mask, Effect::absorption)) {
      if (path.media.depth && has(plan, Effect::absorption)) {
        effect_entered<Effect::absorption>();
        Vec3 passed = transmittance(scene.materials[path.media.material[path.media.depth - 1]].absorption, hit.t);
        carried *= passed;
        path.weight *= passed;
      }
    }
    if constexpr (has(mask, Effect::refraction) || has(mask, Effect::alpha_blend) ||
                  has(mask, Effect::back_face_culling)) {
      bool culled = culls(*s->material, s->front, plan);
      if (culled) effect_entered<Effect::back_face_culling>();
      if (culled || transmits(*s->material, plan) || blends(*s->material, plan)) {
        Contact contact;
        gather_contact(frame, *s, hit, filter, &contact, &tracer->stats);
        if constexpr (has(mask, Effect::alpha_blend)) {
          if (!blend_layers<mask>(tracer, ray, contact, &sum, &carried, &path)) return sum;
        }
        const Face* next = face_behind_layers(scene, contact, plan);
        if (!next) {
          if (!culled) ++tracer->rays[static_cast<int>(RayKind::blend)];
          ray.origin = safe_origin(*s, -1);
          continue;
        }
        if (next->hit.triangle != hit.triangle)
          frame.kernels.surface(frame, ray, on_path(next->hit, path), &found), s = &found;
        if (s == &found) add_later_light<mask>(tracer, path, &found);
        return sum + carried * shade<mask>(tracer, ray, *s, &contact, path);
      }
    }
    if (s == &found) add_later_light<mask>(tracer, path, &found);
    return sum + carried * shade<mask>(tracer, ray, *s, nullptr, path);
  }
  return sum;
}

template <EffectMask mask>
Vec3 radiance(Tracer* tracer, const Ray& ray, const Path<mask>& path) {
  const FrameData& frame = *tracer->frame;
  Hit hit;
  frame.geometry.accel_info->closest(frame.geometry.accel, ray, visible_filter(frame), &hit, &tracer->stats);
  return radiance_from<mask>(tracer, ray, hit, nullptr, path);
}

template <EffectMask mask>
Vec3 primary_radiance(Tracer* tracer, const Ray& ray, const Hit& hit, const Surface* surface) {
  Path<mask> path = {};
  path.weight = {1, 1, 1};
  if constexpr (has(mask, Effect::refraction)) path.media = tracer->frame->view.eye_media;
  if constexpr (kBranches<mask>) begin_branching(tracer);
  return radiance_from<mask>(tracer, ray, hit, surface, path);
}

struct RadiancePart {
  using Function = RadianceFunction;
  static constexpr auto kTable = kRadianceTable;
  template <EffectMask mask>
  static constexpr Function instance() {
    return primary_radiance<mask>;
  }
};

}  // namespace

RadianceFunction find_radiance_function(EffectMask mask) { return Instantiations<RadiancePart>::find(as_coat(mask)); }

}  // namespace pocketray
