// Indirect light: light that reaches a surface from other surfaces rather than from lights. A method is a struct in a
// file of its own and a line of indirect_list.h:
//
//   kName           on the command line and in plans: its effect's name, or "none"
//   kEffects        its effect, one bit of kIndirectEffects, or 0 if it adds nothing; compiled into the kernels of
//                   plans that have it
//   kReference      how the reference treats it
//   kPresent, kAbsent       reasons in plans: what the scene has for it, or lacks
//   use(scene)      whether the scene supports the method
//   need(scene, how)        upper bound of the bytes that prepare() allocates
//   prepare(scene, how, keep, scratch)      once, before the first frame; returns the data that radiance() reads, or
//   null; leaves `scratch` as it was
//   radiance(point)         leaving a diffuse surface, equal in all directions; inlined into surface evaluation
//   exact(scene, diffuse)   radiance() in double precision, for the reference
//   bound(scene, material)  upper bound of radiance() on the material, per component
#pragma once
#include <cstddef>

#include "base/arena.h"
#include "effect/effect_list.h"
#include "effect/settings.h"
#include "scene/scene.h"

namespace pocketray {

struct IndirectPoint {
  const Scene& scene;
  const void* prepared;
  const Vec3& point;
  const Vec3& normal;   // unit, on the viewer's side
  const Vec3& diffuse;  // albedo at the point
  std::uint32_t triangle = 0;
  float u = 0, v = 0;  // in the triangle
  bool front = true;   // the viewer's side is the triangle's front
  Reconstruction reconstruction = Reconstruction::bicubic;
  Vec3 glossy = {0, 0, 0};  // reflectance of a lobe that the surroundings do not light otherwise
};

// When the reference includes a method's light: never; only in its lighting model, where the method replaces light
// transport; always, because the light comes from outside the scene.
enum class IndirectReference { nothing, model, always };

// When a method has something to show in a scene: never; on request; also by default.
enum class IndirectUse { nothing, requested, automatic };

// Bytes of the persistent arena, and bytes while a method is prepared.
struct IndirectNeed {
  std::size_t keep = 0, scratch = 0;
};

// A method as data, for loops over the list.
struct IndirectInfo {
  const char* name;
  EffectMask effects;
  IndirectReference reference;
  const char *present, *absent;
  IndirectUse (*use)(const Scene& scene);
  IndirectNeed (*need)(const Scene& scene, const Quality& how);
  const void* (*prepare)(const Scene& scene, const Quality& how, Arena* keep, Arena* scratch);
  Vec3 (*radiance)(const IndirectPoint& point);
  Vec3d (*exact)(const Scene& scene, const Vec3d& diffuse);
  float (*bound)(const Scene& scene, const Material& material);
};

template <class... Methods>
struct IndirectMethods {
  static constexpr int kCount = sizeof...(Methods);
  static constexpr IndirectInfo kInfos[] = {{Methods::kName, Methods::kEffects, Methods::kReference, Methods::kPresent,
                                             Methods::kAbsent, Methods::use, Methods::need, Methods::prepare,
                                             Methods::radiance, Methods::exact, Methods::bound}...};
  static constexpr EffectMask kEffects = (Methods::kEffects | ...);

  // Adds the radiance of the methods in the mask; the others are not compiled. `prepared` comes from
  // prepare_indirect().
  template <EffectMask mask>
  static void add_radiance(const void* const* prepared, IndirectPoint point, Vec3* sum) {
    int index = 0;
    (add<mask, Methods>(prepared[index++], &point, sum), ...);
  }

 private:
  template <EffectMask mask, class Method>
  static void add(const void* prepared, IndirectPoint* point, Vec3* sum) {
    if constexpr ((mask & Method::kEffects) != 0) {
      point->prepared = prepared;
      *sum += Method::radiance(*point);
    }
  }
};

}  // namespace pocketray
