// Thin films over materials.
#include "shade/film.h"

#include "brdf/brdf_list.h"
#include "shade/dielectric.h"
#include "sunlit_sheet.h"

using namespace pocketray;

namespace {

Iridescence film_of(float strength, float ior = 1.33f, float thickness = 420) {
  Iridescence film;
  film.strength = strength, film.ior = ior, film.thickness_low = 100, film.thickness_high = thickness;
  return film;
}

struct Sheet : SunlitSheet {
  Sheet(const Material& base, const Iridescence& film, bool lit) : SunlitSheet(base, lit) {
    scene.iridescences = {film};
  }
  void add_ceiling(float radiance) {
    add_ceiling_to_sheet(radiance);
    scene.iridescences.emplace_back();
  }
};

Vec3d mixed(const Vec3d& a, const Vec3d& b, double share) { return a * (1 - share) + b * share; }

const Vec3 kEyes[] = {{0.4f, 0.1f, 3}, {-1, -2, 1.5f}, {4, 1, 0.4f}};

}  // namespace

// Goal: a mirror shows the film's reflectance, a glossy lobe that of Schlick's formula. Method: closed forms in double
// precision; several views and strengths.
TEST_CASE("film_colors_mirrors_and_lobes") {
  for (float strength : {0.5f, 1.0f})
    for (const Vec3& eye : kEyes) {
      const Vec3d v = normalize(to_double(eye - kPoint));
      Material mirror = matte(0);
      mirror.mirror = {0.7f, 0.6f, 0.5f};
      const double share = static_cast<double>(strength), ior = static_cast<double>(1.33f);
      Sheet s(mirror, film_of(strength), false);
      s.add_ceiling(3);
      const Vec3d f0 = to_double(mirror.mirror);
      check_near(seen(&s.scene, eye), mixed(f0, film_reflectance(ior, 420.0, f0, v.z), share) * Vec3d{3, 1.5, 0.75});
      Material gloss = plastic();
      gloss.diffuse = {0, 0, 0};
      Sheet lit(gloss, film_of(strength), true);
      const Vec3d base = to_double(gloss.specular), l = normalize(to_double(kSun)), n = {0, 0, 1};
      const Vec3d lobe = mixed(base, film_f0(film_reflectance(ior, 420.0, base, v.z), v.z), share);
      Material under = gloss;
      under.specular = to_float(lobe);
      check_near(seen(&lit.scene, eye), kGgxBrdf.exact_value(under, lobe, {0, 0, 0}, {n, {0, 0, 0}}, v, l) * l.z, 2e-3);
    }
}

// Goal: glass under a film reflects its colours and transmits the others. Method: a pane before a background; the sum
// is the background, and each part is the closed form, also on leaving a body.
TEST_CASE("film_divides_light_at_glass") {
  for (const Vec3& eye : kEyes) {
    Material pane = glass(1.5f);
    pane.thin = 1;
    Sheet s(pane, film_of(1), false);
    s.scene.scene.info.background = {1, 1, 1};
    check_near(seen(&s.scene, eye), {1, 1, 1});
    s.add_ceiling(0);
    const double cosine = normalize(to_double(eye - kPoint)).z, f0 = 0.04;
    const Vec3d reflected = film_reflectance(static_cast<double>(1.33f), 420.0, Vec3d{f0, f0, f0}, cosine);
    check_near(seen(&s.scene, eye), Vec3d{1, 1, 1} - reflected, 1e-3);
  }
  SurfaceFilm film;
  film.strength = 1, film.ior = 1.33f, film.thickness = 420;
  float cos_t, back;
  const float out = fresnel(0.9f, 1.5f, &cos_t), in = fresnel(cos_t, 1 / 1.5f, &back);
  const Vec3 leaving = film_at_boundary(film, 1.5f, out, cos_t), entering = film_at_boundary(film, 1.5f, in, cos_t);
  CHECK(leaving.x == doctest::Approx(entering.x).epsilon(1e-5));
  CHECK(film_at_boundary(film, 1.5f, 1, 0) == Vec3{1, 1, 1});
}

// Goal: textures set strength and thickness; black ones leave the surface as it is, bit for bit. Method: texels.
TEST_CASE("film_follows_its_textures") {
  const Vec3 eye = {-1, -2, 1.5f};
  Material mirror = matte(0);
  mirror.mirror = {0.7f, 0.6f, 0.5f};
  auto shown = [&](const Iridescence& film, int red, int green) {
    Sheet s(mirror, film, false);
    if (red >= 0) s.scene.iridescences[0].strength_texture.texture = s.texture(red, 7, 7);
    if (green >= 0) s.scene.iridescences[0].thickness_texture.texture = s.texture(7, green, 7);
    s.add_ceiling(3);
    return seen(&s.scene, eye);
  };
  CHECK(shown(film_of(1), 0, -1) == shown(film_of(0), -1, -1));
  check_near(shown(film_of(1), 102, -1), to_double(shown(film_of(0.4f), -1, -1)));
  check_near(shown(film_of(1), -1, 51), to_double(shown(film_of(1, 1.33f, 164), -1, -1)), 1e-3);
  CHECK(shown(film_of(1), -1, 51) != shown(film_of(1), -1, -1));
}
