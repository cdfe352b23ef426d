#include "shade/film.h"

#include <cmath>

#include "base/check.h"
#include "effect/effect_probe.h"
#include "scene/metallic_roughness.h"

namespace pocketray {
namespace {

constexpr Vec3 kWhite = {1, 1, 1};

float dielectric_f0(float ior) {
  const float root = (ior - 1) / (ior + 1);
  return root * root;
}

// Reflectance at normal incidence without the film. Glass keeps only the glossy lobe's share of it in its lobes.
Vec3 bare_f0(const Material& m, const Surface& s) {
  const Vec3 specular = reflectance_at(s, m.specular, m.specular_tinted);
  if (is_zero(m.transmission)) return specular + reflectance_at(s, m.mirror, m.mirror_tinted);
  const float lobe = 1 - mirror_share(m.roughness);
  return lobe > 0 ? specular / lobe : kWhite * dielectric_f0(m.ior);
}

Vec3 mixed(const Vec3& a, const Vec3& b, float share) { return a * (1 - share) + b * share; }

}  // namespace

void find_film(const FrameData& frame, const Ray& ray, const Material& m, Surface* s) {
  CHECK(s != nullptr && s->material != nullptr);
  s->film.strength = 0;
  const Iridescence* given =
      iridescence_of(*frame.scene, static_cast<std::uint32_t>(s->material - frame.scene->materials.data));
  if (!given) return;
  effect_entered<Effect::iridescence>();
  SurfaceFilm film;
  film.strength = given->strength, film.ior = given->ior, film.thickness = given->thickness_high;
  if (given->strength_texture.texture != kNone)
    film.strength *= frame.kernels.numbers(frame, given->strength_texture, *s).x / 255;
  if (given->thickness_texture.texture != kNone)
    film.thickness = given->thickness_low + (given->thickness_high - given->thickness_low) *
                                                (frame.kernels.numbers(frame, given->thickness_texture, *s).y / 255);
  if (!(film.strength > 0)) return;
  const Vec3 f0 = bare_f0(m, *s);
  film.f0 = max_component(f0);
  const float cosine = std::fabs(dot(s->normal, ray.direction)) / length(ray.direction);
  const Vec3 seen = film_reflectance(film.ior, film.thickness, f0, cosine);
  film.seen = mixed(f0, seen, film.strength), film.normal = mixed(f0, film_f0(seen, cosine), film.strength);
  s->film = film;
}

void put_film_on(const Surface& s, Material* m) {
  const SurfaceFilm& film = s.film;
  if (!(film.f0 > 0)) return;
  m->specular = film.normal * (max_component(reflectance_at(s, m->specular, m->specular_tinted)) / film.f0);
  m->mirror = film.seen * (max_component(reflectance_at(s, m->mirror, m->mirror_tinted)) / film.f0);
  m->specular = min(m->specular, kWhite), m->mirror = min(m->mirror, kWhite);
  m->specular_tinted = m->mirror_tinted = {0, 0, 0};
}

Vec3 film_at_boundary(const SurfaceFilm& film, float ior, float reflectance, float cosine) {
  const Vec3 bare = {reflectance, reflectance, reflectance};
  if (!(reflectance < 1)) return bare;
  return mixed(bare, film_reflectance(film.ior, film.thickness, kWhite * dielectric_f0(ior), cosine), film.strength);
}

}  // namespace pocketray
