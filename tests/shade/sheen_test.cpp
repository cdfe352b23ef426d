// Sheens over other materials.
#include "shade/sheen.h"

#include <cstring>

#include "base/color.h"
#include "brdf/brdf_list.h"
#include "brdf/clear_coat.h"
#include "indirect/environment.h"
#include "shade/cell.h"
#include "sunlit_sheet.h"
#include "support/test_environment.h"

using namespace pocketray;

namespace {

const Vec3 kColor = {0.8f, 0.5f, 0.3f};

Sheen sheen_of(const Vec3& color, float roughness) {
  Sheen sheen;
  sheen.color = color, sheen.roughness = sheen.roughness_low = roughness;
  return sheen;
}

struct Sheet : SunlitSheet {
  Sheet(const Material& base, const Sheen& sheen, bool lit = true) : SunlitSheet(base, lit) { scene.sheens = {sheen}; }
  Sheen& sheen() { return scene.sheens[0]; }
  void add_ceiling(float radiance) {
    add_ceiling_to_sheet(radiance);
    scene.sheens.emplace_back();
  }
};

double passes_of(const Vec3& color, double roughness, double cosine) {
  return 1 - static_cast<double>(max_component(color)) * sheen_albedo(roughness, cosine);
}

}  // namespace

// Goal: a lit surface shows its base × (1 − max(colour) E) and colour × the sheen, from either side. Method: all lobes
// in double precision; matte, black and glossy bases, views from steep to grazing.
TEST_CASE("sheen_lies_over_its_base") {
  for (const Material& base : {matte(0.8f), matte(0), plastic()})
    for (float roughness : {0.0f, 0.2f, 0.5f, 1.0f})
      for (const Vec3& eye : {Vec3{0.4f, 0.1f, 3}, Vec3{-1, -2, 1.5f}, Vec3{4, 1, 0.4f}})
        for (double side : {1.0, -1.0}) {
          Sheet s(base, sheen_of(kColor, roughness));
          if (side < 0) s.scene.lights[0].direction.z *= -1;
          const Vec3 from = {eye.x, eye.y, eye.z * static_cast<float>(side)};
          const Vec3d n = {0, 0, side}, v = normalize(to_double(from - kPoint)),
                      l = -normalize(to_double(s.scene.lights[0].direction));
          const double r = static_cast<double>(roughness);
          Vec3d f = to_double(base.diffuse) * (1 / kPiD);
          if (!is_zero(base.specular))
            f = kBrdfList[base.brdf]->exact_value(base, to_double(base.specular), f, {n, {0, 0, 0}}, v, l);
          CAPTURE(roughness);
          CAPTURE(eye.z);
          CAPTURE(side);
          check_near(seen(&s.scene, from),
                     (f * passes_of(kColor, r, dot(n, v)) + to_double(kColor) * sheen_value(r, n, v, l)) * dot(n, l),
                     1e-3);
        }
}

// Goal: light from everywhere is reflected by the base and, as by a matte surface of albedo colour × E, by the sheen;
// emission, mirrors and glass below are dimmed. Method: closed forms, with ambient light, an environment, a ceiling.
TEST_CASE("sheen_reflects_light_from_everywhere_and_dims_the_rest") {
  const Vec3 eye = {2, 0.5f, 1};
  const double cosine = normalize(to_double(eye - kPoint)).z;
  for (float roughness : {0.3f, 0.8f}) {
    const double r = static_cast<double>(roughness), p = passes_of(kColor, r, cosine), e = sheen_albedo(r, cosine);
    const Vec3d albedo = Vec3d{0.5, 0.5, 0.5} * p + to_double(kColor) * e;
    Material lamp = matte(0.5f), mirror = matte(0), pane = glass(1.5f);
    lamp.emission = {0.75f, 0.5f, 0.25f}, mirror.mirror = {0.7f, 0.6f, 0.5f}, pane.thin = 1;
    Sheet s(lamp, sheen_of(kColor, roughness), false);
    s.scene.scene.info.ambient = {0.2f, 0.4f, 0.8f};
    check_near(seen(&s.scene, eye), Vec3d{0.75, 0.5, 0.25} * p + albedo * Vec3d{0.2, 0.4, 0.8});
    const TestEnvironment sky(16, 8, {0.5f, 0.6f, 0.7f}, [](const Vec3d& d, int) {
      return Vec3d{1 + d.x, 1 + d.y, 1 + d.z};
    });
    Sheet under(matte(0.5f), sheen_of(kColor, roughness), false);
    sky.give(&under.scene.scene);
    under.scene.bind();
    check_near(seen(&under.scene, eye),
               albedo * to_double(environment_irradiance(under.scene.scene.environment_info[0], Vec3{0, 0, 1})));
    Sheet metal(mirror, sheen_of(kColor, roughness), false);
    metal.add_ceiling(3);
    check_near(seen(&metal.scene, eye), Vec3d{3, 1.5, 0.75} * Vec3d{0.7, 0.6, 0.5} * p);
    Sheet glazed(pane, sheen_of(kColor, roughness), false);
    glazed.scene.scene.info.background = {1, 1, 1};
    check_near(seen(&glazed.scene, eye), Vec3d{p, p, p});
  }
}

// Goal: a glossy base reflects its surroundings through the sheen. Method: the lookups of that base.
TEST_CASE("sheen_dims_the_gloss_of_its_base") {
  const Vec3 eye = {1, 0.5f, 2}, way = normalize(kPoint - eye), n = {0, 0, 1};
  Material m = plastic();
  m.diffuse = {0, 0, 0};
  Sheet s(m, sheen_of(kColor, 0.6f), false);
  s.scene.scene.info.ambient = {0.3f, 0.2f, 0.1f};
  s.scene.bind();
  const Vec3d gloss =
      to_double(reflected_surroundings(radiance_of_surroundings(s.scene.scene.info), m, m.specular, dot(n, way)));
  const double cosine = -static_cast<double>(way.z), r = static_cast<double>(0.6f);
  check_near(seen(&s.scene, eye),
             gloss * passes_of(kColor, r, cosine) + to_double(kColor) * sheen_albedo(r, cosine) * Vec3d{0.3, 0.2, 0.1});
}

// Goal: a coat over a sheen dims it as it dims the base, and reflects as over any other surface. Method: closed forms.
TEST_CASE("sheen_lies_under_a_coat") {
  const Vec3 eye = {1, 0.5f, 2};
  Sheet s(matte(0.6f), sheen_of(kColor, 0.5f));
  s.scene.clear_coats.resize(1);
  s.scene.clear_coats[0].strength = 0.8f,
  s.scene.clear_coats[0].roughness = s.scene.clear_coats[0].roughness_low = 0.5f;
  s.scene.scene.info.ambient = {0.2f, 0.4f, 0.8f};
  const Vec3d v = normalize(to_double(eye - kPoint)), l = normalize(to_double(kSun)), n = {0, 0, 1};
  const double through = 1 - 0.8 * (0.04 + 0.96 * std::pow(1 - v.z, 5)), p = passes_of(kColor, 0.5, v.z);
  const Material lobe = coat_lobe(0.5f);
  const double coat =
      0.8 * kGgxBrdf.exact_value(lobe, to_double(lobe.specular), {0, 0, 0}, {n, {0, 0, 0}}, v, l).x * l.z;
  const Vec3d below = (Vec3d{0.6, 0.6, 0.6} * (p / kPiD) + to_double(kColor) * sheen_value(0.5, n, v, l)) * l.z;
  const Vec3d even = Vec3d{0.6, 0.6, 0.6} * p + to_double(kColor) * sheen_albedo(0.5, v.z);
  const Vec3 glow = reflected_surroundings(radiance_of_surroundings(s.scene.scene.info), lobe, lobe.specular,
                                           static_cast<float>(v.z)) *
                    0.8f;
  check_near(seen(&s.scene, eye),
             (below + even * Vec3d{0.2, 0.4, 0.8}) * through + Vec3d{coat, coat, coat} + to_double(glow), 1e-3);
}

// Goal: the sheen follows the base's normal texture. Method: the closed form about that normal.
TEST_CASE("sheen_has_the_normals_of_its_base") {
  const Vec3d n = normalize(Vec3d{(170 - 128) / 127.0, -(90 - 128) / 127.0, (220 - 128) / 127.0});
  const Vec3 eye = {1, 0.5f, 2};
  const Vec3d v = normalize(to_double(eye - kPoint)), l = normalize(to_double(kSun));
  Sheet s(matte(0.8f), sheen_of(kColor, 0.5f));
  s.scene.material_maps.resize(1);
  s.scene.material_maps[0].normal.texture = s.texture(170, 90, 220);
  const double base = 0.8 / kPiD * passes_of(kColor, 0.5, dot(n, v));
  check_near(seen(&s.scene, eye), (Vec3d{base, base, base} + to_double(kColor) * sheen_value(0.5, n, v, l)) * dot(n, l),
             1e-3);
}

// Goal: one texture scales the colour, the alpha of another the roughness, which never falls below its least; where the
// colour is black, there is no sheen. Method: sheens without textures.
TEST_CASE("sheen_takes_its_textures") {
  const Vec3 eye = {1, 0.5f, 2};
  auto same = [&](Sheet* a, Sheet* b) { check_near(seen(&a->scene, eye), to_double(seen(&b->scene, eye)), 1e-5); };
  Sheet textured(plastic(), sheen_of(kColor, 0.9f)),
      plain(plastic(), sheen_of({kColor.x, kColor.y * srgb_to_linear(128), 0}, 0.9f * 102 / 255));
  textured.sheen().color_texture.texture = textured.texture(255, 128, 0);
  textured.sheen().roughness_texture.texture = textured.texture(9, 7, 200, 102), textured.sheen().roughness_low = 0.1f;
  same(&textured, &plain);
  Sheet bounded(plastic(), sheen_of(kColor, 0.9f)), least(plastic(), sheen_of(kColor, 0.5f));
  bounded.sheen().roughness_texture.texture = bounded.texture(255, 255, 255, 10), bounded.sheen().roughness_low = 0.5f;
  same(&bounded, &least);
  Sheet none(plastic(), sheen_of(kColor, 0.9f)), bare(plastic(), Sheen());
  none.sheen().color_texture.texture = none.texture(0, 0, 0);
  CHECK(seen(&none.scene, eye) == seen(&bare.scene, eye));
}

// Goal: without the effect, the surface has no sheen. Method: bits of the bare base.
TEST_CASE("sheen_is_left_out_on_request") {
  auto picture = [](const Sheen& sheen, EffectMask off) {
    Sheet s(matte(0.8f), sheen);
    aim(&s.scene, kPoint + Vec3{0.06f, -1, 2}, kPoint, 1);
    s.scene.bind();
    Settings settings;
    settings.width = settings.height = 4, settings.forced_off = off;
    return render_picture(s.scene.scene, settings, 0);
  };
  const Picture bare = picture(Sheen(), 0);
  CHECK(same_picture(picture(sheen_of(kColor, 0.4f), bit(Effect::sheen)), bare));
  CHECK_FALSE(same_picture(picture(sheen_of(kColor, 0.4f), 0), bare));
}

// Goal: tiles, single rays and the selection of lights give the same light. Method: sheens over matte, black and glossy
// surfaces, one of them coated, below lamps near and far and many small lights: bits of tiles against those of single
// rays; a selection that may err by nothing against all lights.
TEST_CASE("sheen_is_lit_alike_by_all_ways") {
  for (bool coated : {false, true}) {
    GeneratedScene s;
    add_three_below_lamps(plastic(), &s);
    s.sheens = {sheen_of(kColor, 0.3f), sheen_of({1, 1, 1}, 0.6f), sheen_of(kColor, 0.9f), Sheen()};
    if (coated) {
      s.clear_coats.resize(4);
      s.clear_coats[0].strength = 0.5f, s.clear_coats[0].roughness = s.clear_coats[0].roughness_low = 0.5f;
    }
    check_lit_alike_by_all_ways(&s);
  }
}

// Goal: a sheen shows lamps so close that they give their light in closed form. Method: the mean of a black sheet below
// a lamp, against that of 256 points of it.
TEST_CASE("sheen_shows_lamps_close_by") {
  auto mean = [&](AreaIrradiance how, std::uint32_t points) {
    GeneratedScene s;
    add_quad(&s, {-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}, add_material(&s, matte(0)));
    Material lamp = matte(0);
    lamp.emission = {6, 6, 6};
    add_quad(&s, {-0.8f, 1.2f, 0.4f}, {0.8f, 1.2f, 0.4f}, {0.8f, 1.2f, 1.2f}, {-0.8f, 1.2f, 1.2f},
             add_material(&s, lamp));
    s.sheens = {sheen_of({1, 1, 1}, 0.5f), {}};
    aim(&s, {0, -3, 1}, {0, 0, 0}, 20);
    s.bind();
    Settings settings;
    settings.width = 32, settings.height = 24, settings.points_per_area_light = points;
    settings.area_irradiance = how, settings.cut_off_levels = 0;
    double sum = 0;
    for (const Vec3& pixel : render_picture(s.scene, settings)) sum += static_cast<double>(pixel.x);
    return sum;
  };
  const double points = mean(AreaIrradiance::points, 256);
  CHECK(points > 1);
  CHECK(mean(AreaIrradiance::analytic, 16) == doctest::Approx(points).epsilon(0.03));
}

// Goal: selective rendering does not guess what a sheen's textures change. Method: corners of one radiance.
TEST_CASE("sheen_is_traced_where_it_is_not_smooth") {
  for (int kind = 0; kind < 3; ++kind) {
    Sheet s(plastic(), sheen_of(kColor, 0.5f));
    if (kind == 1) s.sheen().color_texture.texture = s.texture(200, 90, 0);
    if (kind == 2) s.sheen().roughness_texture.texture = s.texture(200, 200, 0, 77), s.sheen().roughness_low = 0.1f;
    auto t = ray_renderer(&s.scene);
    FrameData frame = t->renderer.frame;
    frame.selection = {0.1f, 1, 0.05f};
    Surface surface;
    const Ray ray = {{0.1f, 0.2f, 3}, {0, 0, -1}, 10};
    frame.kernels.surface(frame, ray, {3, 0.25f, 0.25f, 0}, &surface);
    CellCorner corner = {{1, 1, 1}, surface.diffuse, surface.glow, surface.normal, surface.material, true, true};
    CAPTURE(kind);
    CHECK(has_smooth_light(frame, surface));
    CHECK(is_flat(frame, {{&corner, &corner, &corner, &corner}, 0.25f, 0.25f}, 0.1f) == (kind == 0));
  }
}

// Goal: nothing that a ray finds exceeds the bound that rays are left out by. Method: a sheen in low sunlight, seen
// against it at all angles, with and without a texture of its roughness, and in ambient light; the bound is not absurd.
TEST_CASE("sheen_stays_within_the_radiance_bound") {
  for (bool textured : {false, true})
    for (float roughness : {0.1f, 0.4f, 1.0f})
      for (bool lit : {false, true}) {
        Sheet s(matte(0), sheen_of({1, 1, 1}, roughness), lit);
        if (textured)
          s.sheen().roughness_texture.texture = s.texture(255, 128, 0, 128), s.sheen().roughness_low = roughness / 2;
        s.scene.materials[0].mirror = {0.1f, 0.1f, 0.1f};
        s.scene.lights[0].direction = -normalize(Vec3{1, 0, 0.02f});
        if (!lit) s.scene.scene.info.ambient = {1, 1, 1};
        auto t = ray_renderer(&s.scene, 3);
        const float bound = t->renderer.frame.cut_off.radiance_bounds.after[3];
        float most = 0;
        for (int i = 1; i < 200; ++i) {
          const double angle = 3.14159 * i / 200;
          const Vec3d eye = Vec3d{std::cos(angle), 0, std::sin(angle)} * 3.0;
          most = std::fmax(most, max_component(look(*t, to_float(eye) + kPoint, kPoint)));
        }
        CAPTURE(textured);
        CAPTURE(roughness);
        CAPTURE(lit);
        CHECK(most > 0);
        CHECK(most <= bound);
        CHECK(bound < 200);
      }
}
