// Indirect light: what reaches a surface from others and not from lights. A method is a struct in a file of its own and
// a line of indirect_list.h:
//
//   kName           on the command line and in plans
//   kEffects        its effect, one bit; it is compiled into the kernels of plans that have it. 0: it adds nothing
//   kReference      what the reference makes of it
//   need(scene)     bytes that prepare() takes, at most
//   prepare(scene, keep)    once, before the first frame; returns what radiance() reads, or null
//   radiance(point)         that leaves a diffuse surface towards all sides; inlined where surfaces are evaluated
//   exact(scene, diffuse)   radiance() in double precision, for the reference
//   bound(scene, material)  no radiance() of the material's is more, in any component
#pragma once
#include <cstddef>

#include "base/arena.h"
#include "effect/effect.h"
#include "scene/scene.h"

namespace pocketray {

struct IndirectPoint {
  const Scene& scene;
  const void* prepared;
  const Vec3& point;
  const Vec3& normal;   // unit, on the viewer's side
  const Vec3& diffuse;  // albedo there
};

// Whether the reference has the light of a method: never; in its lighting model, where the method stands in for the
// transport of light; always, since light comes from outside the scene.
enum class IndirectReference { nothing, model, always };

// A method as data, for what loops over the list.
struct IndirectInfo {
  const char* name;
  EffectMask effects;
  IndirectReference reference;
  std::size_t (*need)(const Scene& scene);
  const void* (*prepare)(const Scene& scene, Arena* keep);
  Vec3 (*radiance)(const IndirectPoint& point);
  Vec3d (*exact)(const Scene& scene, const Vec3d& diffuse);
  float (*bound)(const Scene& scene, const Material& material);
};

template <class... Methods>
struct IndirectMethods {
  static constexpr int kCount = sizeof...(Methods);
  static constexpr IndirectInfo kInfos[] = {{Methods::kName, Methods::kEffects, Methods::kReference, Methods::need,
                                             Methods::prepare, Methods::radiance, Methods::exact, Methods::bound}...};
  static constexpr EffectMask kEffects = (Methods::kEffects | ...);

  // Adds the radiance of the methods that the mask has; the others are not compiled. `prepared` as prepare_indirect()
  // left it.
  template <EffectMask mask>
  static void add_radiance(const Scene& scene, const void* const* prepared, const Vec3& point, const Vec3& normal,
                           const Vec3& diffuse, Vec3* sum) {
    int index = 0;
    (add<mask, Methods>({scene, prepared[index++], point, normal, diffuse}, sum), ...);
  }

 private:
  template <EffectMask mask, class Method>
  static void add(const IndirectPoint& point, Vec3* sum) {
    if constexpr ((mask & Method::kEffects) != 0) *sum += Method::radiance(point);
  }
};

}  // namespace pocketray
