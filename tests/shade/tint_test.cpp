// Metals take the colour of their texture and vertices in highlights and mirrors.
#include <doctest/doctest.h>

#include "brdf/brdf_list.h"
#include "shade_helpers.h"

using namespace pocketray;

namespace {

// A sheet in the plane z = 0 of colour 0.25, 0.5, 1 times the texel and the vertex colour, under a directional light.
void make_sheet(GeneratedScene* s, Material m, bool textured, bool colored) {
  if (textured) m.diffuse_texture.texture = add_texture(s, 1, 1, {{255, 188, 99, 255}});
  add_sheet(s, 0, add_material(s, m));
  s->with_uvs = true, s->with_colors = colored;
  if (colored) s->colors.assign(s->positions.size(), Rgba16{65535, 16384, 32768, 65535});
  s->lights.resize(1);
  s->lights[0].kind = LightKind::directional;
  s->lights[0].direction = normalize(Vec3{-1, -2, -3});
}

Vec3 tint_of(bool textured, bool colored) {
  Vec3 tint = {1, 1, 1};
  if (textured) tint *= Vec3{1, 0.502886f, 0.124772f};  // sRGB 255, 188, 99
  if (colored) tint *= Vec3{1, 16384 / 65535.0f, 32768 / 65535.0f};
  return tint;
}

}  // namespace

// Goal: the colour of texture and vertices multiplies the tinted part of the reflectance at normal incidence and
// nothing else. Method: closed form: a glTF material of metallic ½ under one light, F₀ = .02 + ½ c, and the lobe's
// value in double precision, above the diffuse one of Shirley et al.; with neither, either and both.
TEST_CASE("tint_reaches_the_glossy_lobe") {
  for (int with = 0; with < 4; ++with) {
    GeneratedScene s;
    Material m;
    m.brdf = kGgx, m.roughness = 0.3f, m.grazing = 1;
    Vec3 base = {0.8f, 0.7f, 0.6f};
    m.diffuse = base * 0.5f, m.specular_tinted = base * 0.5f;
    m.specular = m.specular_tinted + Vec3{0.02f, 0.02f, 0.02f};
    make_sheet(&s, m, with & 1, with & 2);
    auto t = ray_renderer(&s);
    Vec3 eye = {1, 0.5f, 2}, tint = tint_of(with & 1, with & 2);
    Vec3 found = look(*t, eye, {0.1f, 0.2f, 0});
    Vec3d v = normalize(to_double(eye - Vec3{0.1f, 0.2f, 0})), l = -normalize(to_double(s.lights[0].direction));
    Vec3d specular = Vec3d{0.02, 0.02, 0.02} + to_double(m.specular_tinted * tint);
    Vec3d lobe = kBrdfList[kGgx]->exact_value(m, specular, {0, 0, 0}, {{0, 0, 1}, {0, 0, 0}}, v, l);
    double passes = 1.05 * 0.96 * (1 - std::pow(1 - v.z, 5)) * (1 - std::pow(1 - l.z, 5));
    CAPTURE(with);
    for (int c = 0; c < 3; ++c) {
      double expected = (static_cast<double>(m.diffuse[c] * tint[c]) / kPiD * passes + lobe[c]) * l.z;
      CHECK(static_cast<double>(found[c]) == doctest::Approx(expected).epsilon(1e-4));
    }
  }
}

// Goal: mirrors are tinted likewise; a material without a tinted part keeps its reflectance under the same texture.
// Method: closed form: the mirrored background.
TEST_CASE("tint_reaches_the_mirror_of_a_metal_only") {
  for (bool metal : {false, true})
    for (int with = 0; with < 4; ++with) {
      GeneratedScene s;
      Material m;
      m.diffuse = {0, 0, 0}, m.mirror = {0.9f, 0.8f, 0.7f};
      if (metal) m.mirror_tinted = m.mirror;
      make_sheet(&s, m, with & 1, with & 2);
      s.scene.info.background = {1, 1, 1};
      auto t = ray_renderer(&s);
      Vec3 found = look(*t, {1, 0.5f, 2}, {0.1f, 0.2f, 0}), tint = tint_of(with & 1, with & 2);
      CAPTURE(metal);
      CAPTURE(with);
      for (int c = 0; c < 3; ++c)
        CHECK(found[c] == doctest::Approx(m.mirror[c] * (metal ? tint[c] : 1.0f)).epsilon(1e-4));
    }
}
