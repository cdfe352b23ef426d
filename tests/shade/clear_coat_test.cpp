// Clear coats over other materials.
#include <cstring>

#include "brdf/brdf_list.h"
#include "indirect/environment.h"
#include "shade/cell.h"
#include "sunlit_sheet.h"
#include "support/test_environment.h"

using namespace pocketray;

namespace {

double fresnel_of(double cosine) { return 0.04 + 0.96 * std::pow(1 - std::fabs(cosine), 5); }
double mirror_share(double r) { return r < 0.3 ? (1 - r / 0.3) * (1 - r / 0.3) : 0; }

Material shiny() {
  Material m;
  m.diffuse = {0.2f, 0.3f, 0.4f}, m.specular = {0.5f, 0.4f, 0.3f}, m.exponent = 30;
  return m;
}

ClearCoat coat_of(float strength, float roughness) {
  ClearCoat coat;
  coat.strength = strength, coat.roughness = coat.roughness_low = roughness;
  return coat;
}

struct Sheet : SunlitSheet {
  Sheet(const Material& base, const ClearCoat& coat, bool lit = true) : SunlitSheet(base, lit) {
    scene.clear_coats = {coat};
  }
  ClearCoat& coat() { return scene.clear_coats[0]; }
  void add_ceiling(float radiance, bool half = false) {
    add_ceiling_to_sheet(radiance, half);
    scene.clear_coats.emplace_back();
  }
};

// Value × cosine of the coat's lobe of strength 1, by the lobe in double precision.
double lobe_of(double r, const Vec3d& n, const Vec3d& v, const Vec3d& l) {
  const double rest = 1 - mirror_share(r), f = 0.04 * rest;
  Material m;
  m.brdf = kGgx, m.roughness = static_cast<float>(r * r), m.grazing = static_cast<float>(rest);
  return kGgxBrdf.exact_value(m, {f, f, f}, {0, 0, 0}, {n, {0, 0, 0}}, v, l).x * std::fmax(dot(n, l), 0);
}

}  // namespace

// Goal: a lit surface shows its base × (1 − strength × F) and the coat's lobe × strength, from either side. Method: all
// lobes in double precision, F by hand; matte, Phong's and GGX bases, views from steep to grazing.
TEST_CASE("clear_coat_lies_over_its_base") {
  for (const Material& base : {matte(0.8f), shiny(), plastic()})
    for (float strength : {1.0f, 0.4f})
      for (float roughness : {0.15f, 0.5f, 1.0f})
        for (const Vec3& eye : {Vec3{0.4f, 0.1f, 3}, Vec3{-1, -2, 1.5f}, Vec3{4, 1, 0.4f}})
          for (double side : {1.0, -1.0}) {
            Sheet s(base, coat_of(strength, roughness));
            if (side < 0) s.scene.lights[0].direction.z *= -1;
            const Vec3 from = {eye.x, eye.y, eye.z * static_cast<float>(side)};
            const Vec3d n = {0, 0, side}, v = normalize(to_double(from - kPoint)),
                        l = -normalize(to_double(s.scene.lights[0].direction));
            Vec3d f = to_double(base.diffuse) * (1 / kPiD);
            if (!is_zero(base.specular))
              f = kBrdfList[base.brdf]->exact_value(base, to_double(base.specular), f, {n, {0, 0, 0}}, v, l);
            const double c = static_cast<double>(strength), coat = c * lobe_of(static_cast<double>(roughness), n, v, l);
            CAPTURE(strength);
            CAPTURE(roughness);
            CAPTURE(eye.z);
            CAPTURE(side);
            check_near(seen(&s.scene, from),
                       f * ((1 - c * fresnel_of(dot(n, v))) * dot(n, l)) + Vec3d{coat, coat, coat});
          }
}

// Goal: a coat dims ambient light and emission, and what its base mirrors and transmits; as smooth as can be, it
// mirrors by Fresnel alone. Method: closed forms: a mirror, glass and a lamp below a ceiling; mirrors and glass share
// the coat's ray.
TEST_CASE("clear_coat_mirrors_by_fresnel_and_dims_the_rest") {
  const Vec3 eye = {2, 0.5f, 1};
  const double cosine = normalize(to_double(eye - kPoint)).z, f = 0.6 * fresnel_of(cosine);
  Material lamp = matte(0.5f), mirror = matte(0), pane = glass(1.5f);
  lamp.emission = {0.75f, 0.5f, 0.25f}, mirror.mirror = {0.7f, 0.6f, 0.5f}, pane.thin = 1;
  const Vec3d above = {3, 1.5, 0.75};
  {
    Sheet s(lamp, coat_of(0.6f, 0), false);
    s.scene.scene.info.ambient = {0.2f, 0.4f, 0.8f};
    check_near(seen(&s.scene, eye), Vec3d{0.75 + 0.1, 0.5 + 0.2, 0.25 + 0.4} * (1 - f));
    s.add_ceiling(3);
    s.scene.scene.info.ambient = {0, 0, 0};
    check_near(seen(&s.scene, eye), Vec3d{0.75, 0.5, 0.25} * (1 - f) + above * f);
  }
  for (float roughness : {0.0f, 0.1f}) {
    Sheet s(mirror, coat_of(0.6f, roughness), false);
    s.add_ceiling(3);
    auto t = ray_renderer(&s.scene);
    Tracer tracer = make_tracer(t->renderer.frame);
    const Vec3 found = trace_ray(t->renderer, eye, normalize(kPoint - eye), &tracer);
    const double k = mirror_share(static_cast<double>(roughness));
    check_near(found, above * (Vec3d{0.7, 0.6, 0.5} * (1 - f) + Vec3d{f, f, f} * k));
    CHECK(tracer.rays[static_cast<int>(RayKind::mirror)] == 1);
  }
  Sheet s(pane, coat_of(0.6f, 0), false);
  s.add_ceiling(3);
  s.scene.scene.info.background = {0.25f, 0.5f, 1};
  const double sine = std::sqrt(1 - cosine * cosine), inner = std::sqrt(1 - sine * sine / 2.25);
  const double a = (cosine - 1.5 * inner) / (cosine + 1.5 * inner), b = (inner - 1.5 * cosine) / (inner + 1.5 * cosine);
  const double once = (a * a + b * b) / 2, sheet = 2 * once / (1 + once);
  auto t = ray_renderer(&s.scene);
  Tracer tracer = make_tracer(t->renderer.frame);
  check_near(trace_ray(t->renderer, eye, normalize(kPoint - eye), &tracer),
             (above * sheet + Vec3d{0.25, 0.5, 1} * (1 - sheet)) * (1 - f) + above * f);
  CHECK(tracer.rays[static_cast<int>(RayKind::mirror)] == 1);
  CHECK(tracer.rays[static_cast<int>(RayKind::refraction)] == 1);
  s.coat().strength = 1;  // lets nothing through where Fresnel rounds to 1
  check_near(seen(&s.scene, {3, 0.2f, 1e-9f}), {0.25, 0.5, 1});
}

// Goal: the coat does not follow the base's normals but has its own. Method: closed forms of the lobe about either
// normal, and of what a smooth coat mirrors of a ceiling or the background.
TEST_CASE("clear_coat_has_normals_of_its_own") {
  const double x = (170 - 128) / 127.0, y = (90 - 128) / 127.0, z = (220 - 128) / 127.0;
  const Vec3d flat = {0, 0, 1}, lean = normalize(Vec3d{x, -y, z}), half = normalize(Vec3d{x / 2, -y / 2, z});
  const Vec3 eye = {1, 0.5f, 2};
  const Vec3d v = normalize(to_double(eye - kPoint)), l = normalize(to_double(kSun));
  for (int which = 0; which < 3; ++which) {
    Sheet s(matte(0.8f), coat_of(0.7f, 0.5f));
    s.scene.material_maps.resize(1);
    if (which != 1) s.scene.material_maps[0].normal.texture = s.texture(170, 90, 220);
    if (which != 0) s.coat().normal.texture = s.texture(170, 90, 220), s.coat().normal_scale = 0.5f;
    const Vec3d base = which == 1 ? flat : lean, coat = which == 0 ? flat : half;
    const double own = 0.8 / kPiD * dot(base, l) * (1 - 0.7 * fresnel_of(dot(coat, v)));
    const double all = own + 0.7 * lobe_of(0.5, coat, v, l);
    CAPTURE(which);
    check_near(seen(&s.scene, eye), {all, all, all});
  }
  // The base faces away from the sun: no light reaches the coat either.
  Sheet dark(matte(0.8f), coat_of(1, 0.5f));
  dark.scene.material_maps.resize(1);
  dark.scene.material_maps[0].normal.texture = dark.texture(1, 128, 140);
  dark.scene.lights[0].direction = -normalize(Vec3{2, 0, 1});
  CHECK(is_zero(seen(&dark.scene, {0, 0.5f, 2})));
  Material bumpy = matte(0);
  for (bool by_map : {false, true}) {
    Sheet s(bumpy, coat_of(1, 0), false);
    s.scene.material_maps.resize(1);
    s.scene.material_maps[0].normal.texture = s.texture(200, 128, 200);  // would mirror the background
    if (by_map) s.coat().normal.texture = s.texture(1, 128, 200);
    s.add_ceiling(3, true);
    s.scene.material_maps.resize(2);
    s.scene.scene.info.background = {9, 9, 9};
    const Vec3d n = by_map ? normalize(Vec3d{-1, 0, (200 - 128) / 127.0}) : flat;
    const Vec3 from = by_map ? Vec3{-2, 0.2f, 2} : eye;
    const double f = fresnel_of(dot(n, normalize(to_double(from - kPoint))));
    CAPTURE(by_map);
    check_near(seen(&s.scene, from), Vec3d{3, 1.5, 0.75} * f);
  }
}

// Goal: red of one texture scales the strength, green of another the roughness, which never falls below its least; with
// no red, there is no coat. Method: the bits of the coat without textures.
TEST_CASE("clear_coat_takes_its_textures") {
  const Vec3 eye = {1, 0.5f, 2};
  auto same = [&](Sheet* a, Sheet* b) {
    const Vec3 p = seen(&a->scene, eye), q = seen(&b->scene, eye);
    for (int c = 0; c < 3; ++c) CHECK(p[c] == doctest::Approx(q[c]).epsilon(1e-6));
  };
  Sheet textured(plastic(), coat_of(0.8f, 0.9f)), plain(plastic(), coat_of(0.8f * 51 / 255, 0.9f * 102 / 255));
  textured.coat().strength_texture.texture = textured.texture(51, 200, 7);
  textured.coat().roughness_texture.texture = textured.texture(9, 102, 7);
  textured.coat().roughness_low = 0.1f;
  same(&textured, &plain);
  Sheet bounded(plastic(), coat_of(0.8f, 0.9f)), least(plastic(), coat_of(0.8f, 0.5f));
  bounded.coat().roughness_texture.texture = bounded.texture(255, 10, 255), bounded.coat().roughness_low = 0.5f;
  same(&bounded, &least);
  Sheet none(plastic(), coat_of(0.8f, 0.9f)), bare(plastic(), coat_of(0, 0));
  none.coat().strength_texture.texture = none.texture(0, 255, 255);
  CHECK(seen(&none.scene, eye) == seen(&bare.scene, eye));
}

// Goal: a coat reflects an environment, or ambient light, as GGX lobes do, by what an occlusion texture leaves. Method:
// a black base; the look-ups of those lobes.
TEST_CASE("clear_coat_reflects_the_surroundings") {
  const TestEnvironment sky(16, 8, {0.5f, 0.6f, 0.7f}, [](const Vec3d& d, int) {
    return Vec3d{1 + d.x, 1 + d.y, 1 + d.z};
  });
  const Vec3 eye = {1, 0.5f, 2}, way = normalize(kPoint - eye), n = {0, 0, 1};
  Material lobe;
  lobe.brdf = kGgx, lobe.roughness = 0.25f, lobe.specular = {0.04f, 0.04f, 0.04f}, lobe.grazing = 1;
  for (bool occluded : {false, true})
    for (bool with_sky : {false, true}) {
      Sheet s(matte(0), coat_of(0.5f, 0.5f), false);
      s.scene.scene.info.ambient = {0.3f, 0.2f, 0.1f};
      if (with_sky) sky.give(&s.scene.scene);
      if (occluded) s.scene.material_maps.resize(1), s.scene.material_maps[0].occlusion.texture = s.texture(51, 0, 0);
      s.scene.bind();
      const Vec3 whole =
          with_sky
              ? reflected_environment(s.scene.scene, lobe, lobe.specular, n, way, {0.5f, 0.6f, 0.7f})
              : reflected_surroundings(radiance_of_surroundings(s.scene.scene.info), lobe, lobe.specular, dot(n, way));
      CAPTURE(occluded);
      CAPTURE(with_sky);
      check_near(seen(&s.scene, eye), to_double(whole) * (0.5 * (occluded ? 0.2 : 1)));
    }
}

// A sun that half a ceiling lets through just beside what a viewer opposite sees mirrored of it.
const Vec3 kLow = normalize(Vec3{0.02f, 0.5f, 1});

// Goal: without the effect, the surface has no coat; without glossy lobes, without mirrors, the coat lacks them and
// dims the base as before. Method: bits of the bare base; closed forms, close to the highlight.
TEST_CASE("clear_coat_lacks_what_the_plan_leaves_out") {
  auto picture = [](const ClearCoat& coat, EffectMask off, float ceiling) {
    Sheet s(matte(0.8f), coat);
    s.add_ceiling(ceiling, true);
    s.scene.lights[0].direction = -kLow;
    aim(&s.scene, kPoint + Vec3{0.06f, -1, 2}, kPoint, 1);
    s.scene.bind();
    Settings settings;
    settings.width = settings.height = 1, settings.forced_off = off;
    return render_picture(s.scene.scene, settings, 0);
  };
  const ClearCoat both = coat_of(1, 0.2f);
  CHECK(same_picture(picture(both, bit(Effect::clear_coat), 1), picture({}, bit(Effect::clear_coat), 1)));
  const Vec3d v = normalize(Vec3d{0.06, -1, 2}), l = to_double(kLow);
  const double base = 0.8 / kPiD * l.z * (1 - fresnel_of(v.z)), k = mirror_share(static_cast<double>(both.roughness));
  const Vec3d shown = Vec3d{1, 0.5, 0.25} * (k * fresnel_of(v.z));
  const double lobe = lobe_of(static_cast<double>(both.roughness), {0, 0, 1}, v, l);
  CHECK(lobe > 0.1);
  const EffectMask gloss = bit(Effect::specular), mirrors = bit(Effect::mirror);
  check_near(picture(both, gloss, 1)[0], Vec3d{base, base, base} + shown, 1e-3);
  check_near(picture(both, mirrors, 1)[0], Vec3d{base + lobe, base + lobe, base + lobe}, 1e-3);
  check_near(picture(both, gloss | mirrors, 1)[0], {base, base, base}, 1e-3);
}

// Goal: tiles, single rays and the selection of lights give the same light. Method: coats over matte, black and glossy
// surfaces below lamps near and far and many small lights: bits of tiles against those of single rays; a selection that
// may err by nothing against all lights.
TEST_CASE("clear_coat_is_lit_alike_by_all_ways") {
  GeneratedScene s;
  add_three_below_lamps(plastic(), &s);
  s.clear_coats = {coat_of(1, 0.3f), coat_of(0.8f, 0.5f), coat_of(1, 0.6f), {}};
  s.with_uvs = true;
  check_lit_alike_by_all_ways(&s);
}

// Goal: a coat shows lamps so close that they give their light in closed form. Method: the mean of black and dark
// sheets below a lamp, against that of 256 points of it; the coat is a good part of it.
TEST_CASE("clear_coat_shows_lamps_close_by") {
  for (float albedo : {0.0f, 0.02f}) {
    CAPTURE(albedo);
    auto mean = [&](float strength, AreaIrradiance how, std::uint32_t points) {
      GeneratedScene s;
      add_quad(&s, {-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}, add_material(&s, matte(albedo)));
      Material lamp = matte(0);
      lamp.emission = {6, 6, 6};
      add_quad(&s, {-0.8f, 1.2f, 0.4f}, {0.8f, 1.2f, 0.4f}, {0.8f, 1.2f, 1.2f}, {-0.8f, 1.2f, 1.2f},
               add_material(&s, lamp));
      s.clear_coats = {coat_of(strength, 0.6f), {}};
      aim(&s, {0, -3, 1}, {0, 0, 0}, 20);
      s.bind();
      Settings settings;
      settings.width = 32, settings.height = 24, settings.points_per_area_light = points;
      settings.area_irradiance = how, settings.cut_off_levels = 0;
      double sum = 0;
      for (const Vec3& pixel : render_picture(s.scene, settings)) sum += static_cast<double>(pixel.x);
      return sum;
    };
    const double found = mean(1, AreaIrradiance::analytic, 16), points = mean(1, AreaIrradiance::points, 256);
    CHECK(found == doctest::Approx(points).epsilon(0.03));
    CHECK(points > 1.5 * mean(0, AreaIrradiance::points, 256));
  }
}

// Goal: selective rendering does not guess what a coat mirrors or what its textures change. Method: corners of one
// radiance on coats with and without.
TEST_CASE("clear_coat_is_traced_where_it_is_not_smooth") {
  for (int kind = 0; kind < 5; ++kind) {
    Sheet s(plastic(), coat_of(0.5f, kind == 1 ? 0.0f : 0.5f));
    if (kind == 2) s.coat().strength_texture.texture = s.texture(200, 0, 0);
    if (kind == 3) s.coat().roughness_texture.texture = s.texture(200, 200, 0);
    if (kind == 4) s.coat().normal.texture = s.texture(128, 128, 255);
    auto t = ray_renderer(&s.scene);
    FrameData frame = t->renderer.frame;
    frame.selection = {0.1f, 1, 0.05f};
    Surface surface;
    const Ray ray = {{0.1f, 0.2f, 3}, {0, 0, -1}, 10};
    frame.kernels.surface(frame, ray, {3, 0.25f, 0.25f, 0}, &surface);
    CellCorner corner = {{1, 1, 1}, surface.diffuse, surface.glow, surface.normal, surface.material, true, true};
    CAPTURE(kind);
    CHECK(has_smooth_light(frame, surface) == (kind != 1));
    CHECK(is_flat(frame, {{&corner, &corner, &corner, &corner}, 0.25f, 0.25f}, 0.1f) == (kind < 2));
  }
}

// Goal: nothing that a ray finds exceeds the bound that rays are left out by. Method: a coat in sunlight that is seen
// straight in its highlight, over black, with and without a texture of its roughness; the bound is not absurd.
TEST_CASE("clear_coat_stays_within_the_radiance_bound") {
  for (bool textured : {false, true})
    for (float roughness : {0.31f, 0.5f, 1.0f}) {
      Sheet s(matte(0), coat_of(1, roughness));
      if (textured) s.coat().roughness_texture.texture = s.texture(255, 128, 0), s.coat().roughness_low = roughness / 2;
      s.scene.materials[0].mirror = {0.1f, 0.1f, 0.1f};
      s.scene.scene.info.ambient = {0.1f, 0.1f, 0.1f};
      auto t = ray_renderer(&s.scene, 3);
      const float bound = t->renderer.frame.cut_off.radiance_bounds.after[3];
      float most = 0;
      for (int i = 0; i < 200; ++i) {
        const double low = 0.02 + 0.005 * i;
        const Vec3d eye = Vec3d{-0.3 / low, -0.5 / low, 1} * 3.0;
        most = std::fmax(most, max_component(look(*t, to_float(eye) + kPoint, kPoint)));
      }
      CAPTURE(textured);
      CAPTURE(roughness);
      CHECK(most > 0);
      CHECK(most <= bound);
      CHECK(bound < 1e5f);
    }
}
