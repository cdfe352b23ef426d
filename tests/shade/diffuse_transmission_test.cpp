// Light that passes thin surfaces diffusely.
#include "shade/diffuse_transmission.h"

#include "base/color.h"
#include "indirect/environment.h"
#include "shade/cell.h"
#include "sunlit_sheet.h"
#include "support/test_environment.h"

using namespace pocketray;

namespace {

const Vec3 kLeaf = {0.5f, 0.9f, 0.25f};
const Vec3d kWhiteD = {1, 1, 1};

struct Sheet : SunlitSheet {
  Sheet(const Material& base, float strength, bool lit = true) : SunlitSheet(base, lit) {
    scene.diffuse_transmissions.resize(1);
    passing().strength = strength, passing().color = kLeaf;
  }
  DiffuseTransmission& passing() { return scene.diffuse_transmissions[0]; }
  void turn_sun() { scene.lights[0].direction.z *= -1; }
};

double schlick(double normal, double cosine) { return normal + (1 - normal) * std::pow(1 - cosine, 5); }

}  // namespace

// Goal: from behind, a sun shows the colour × its strength; from the front, the rest of the diffuse lobe; a boundary
// reflects its share. Method: closed forms, from both sides of the sheet, matte, black and glossy.
TEST_CASE("diffuse_transmission_shows_light_from_behind") {
  for (const Material& base : {matte(0.8f), matte(0), plastic()})
    for (float strength : {0.25f, 1.0f})
      for (double side : {1.0, -1.0}) {
        const Vec3 eye = {0.4f, 0.1f, static_cast<float>(3 * side)};
        const Vec3d n = {0, 0, side}, v = normalize(to_double(eye - kPoint)), l = normalize(to_double(kSun));
        const double cosine = std::fabs(l.z), share = static_cast<double>(strength);
        Sheet behind(base, strength), front(base, strength);
        (side > 0 ? behind : front).turn_sun();
        const double enters = is_zero(base.specular) ? 1 : 1 - schlick(static_cast<double>(base.specular.z), dot(n, v));
        CAPTURE(strength);
        CAPTURE(side);
        check_near(seen(&behind.scene, eye), to_double(kLeaf) * (share * enters * cosine / kPiD), 1e-3);
        const Vec3d diffuse = to_double(base.diffuse) * ((1 - share) / kPiD);
        const Vec3d towards = {l.x, l.y, l.z * side};
        const Vec3d value = is_zero(base.specular)
                                ? diffuse
                                : kBrdfList[base.brdf]->exact_value(base, to_double(base.specular), diffuse,
                                                                    {n, {0, 0, 0}}, v, towards);
        check_near(seen(&front.scene, eye), value * cosine, 1e-3);
      }
}

// Goal: a body behind the sheet hides the sun from it, and one before it does not. Method: a wall on either side.
TEST_CASE("diffuse_transmission_casts_shadows_on_the_other_side") {
  const Vec3 eye = {0.4f, 0.1f, 3};
  for (float height : {-1.0f, 1.0f}) {
    Sheet s(matte(0.8f), 1);
    s.turn_sun();
    add_quad(&s.scene, {-9, -9, height}, {-0.5f, -9, height}, {-0.5f, 9, height}, {-9, 9, height},
             add_material(&s.scene, matte(0)));  // clear of the view
    s.scene.diffuse_transmissions.emplace_back();
    CHECK(max_component(seen(&s.scene, eye)) > 0.2f);
    add_quad(&s.scene, {-9, -9, 2 * height}, {9, -9, 2 * height}, {9, 9, 2 * height}, {-9, 9, 2 * height}, 1);
    Settings settings;
    if (height < 0) CHECK(seen(&s.scene, eye) == Vec3{0, 0, 0});
  }
}

// Goal: light from everywhere passes as it is reflected: a white leaf in uniform light stays white, whatever it passes;
// an environment is read about the other side's normal; sheen and coat dim what passes. Method: closed forms.
TEST_CASE("diffuse_transmission_passes_light_from_everywhere") {
  const Vec3 eye = {2, 0.5f, 1};
  for (float strength : {0.3f, 1.0f}) {
    Sheet s(matte(1), strength, false);
    s.passing().color = {1, 1, 1};
    s.scene.scene.info.ambient = {0.2f, 0.4f, 0.8f};
    check_near(seen(&s.scene, eye), Vec3d{0.2, 0.4, 0.8});
    const TestEnvironment sky(16, 8, {0.5f, 0.6f, 0.7f}, [](const Vec3d& d, int) {
      return Vec3d{1 + d.x, 1 + d.y, 1 + d.z};
    });
    Sheet under(matte(0.5f), strength, false);
    sky.give(&under.scene.scene);
    under.scene.bind();
    const EnvironmentInfo& info = under.scene.scene.environment_info[0];
    const double share = static_cast<double>(strength);
    check_near(seen(&under.scene, eye),
               to_double(environment_irradiance(info, Vec3{0, 0, 1})) * (0.5 * (1 - share)) +
                   to_double(kLeaf) * to_double(environment_irradiance(info, Vec3{0, 0, -1})) * share);
    Sheet coated(matte(0), strength);
    coated.turn_sun();
    coated.scene.clear_coats.resize(1);
    coated.scene.clear_coats[0].strength = 0.8f, coated.scene.clear_coats[0].roughness = 0.5f;
    coated.scene.clear_coats[0].roughness_low = 0.5f;
    const double v = normalize(to_double(eye - kPoint)).z, l = std::fabs(normalize(to_double(kSun)).z);
    check_near(seen(&coated.scene, eye), to_double(kLeaf) * (share * (1 - 0.8 * schlick(0.04, v)) * l / kPiD), 1e-3);
  }
}

// Goal: the alpha of one texture scales the strength, another the colour; what emits glows once. Method: sheets without
// textures; an emissive one.
TEST_CASE("diffuse_transmission_takes_its_textures") {
  const Vec3 eye = {1, 0.5f, 2};
  for (bool behind : {false, true}) {
    Sheet textured(plastic(), 0.9f), plain(plastic(), 0.9f * 102 / 255);
    textured.passing().strength_texture.texture = textured.texture(9, 7, 200, 102);
    textured.passing().color_texture.texture = textured.texture(255, 128, 0);
    plain.passing().color = {kLeaf.x, kLeaf.y * srgb_to_linear(128), 0};
    if (behind) textured.turn_sun(), plain.turn_sun();
    check_near(seen(&textured.scene, eye), to_double(seen(&plain.scene, eye)), 1e-5);
  }
  Material lamp = matte(0);
  lamp.emission = {0.75f, 0.5f, 0.25f};
  Sheet glowing(lamp, 1, false);
  check_near(seen(&glowing.scene, eye), Vec3d{0.75, 0.5, 0.25});
}

// Goal: without the effect, nothing passes and nothing is dimmed. Method: bits of the bare base.
TEST_CASE("diffuse_transmission_is_left_out_on_request") {
  auto picture = [](float strength, EffectMask off) {
    Sheet s(matte(0.8f), strength);
    aim(&s.scene, kPoint + Vec3{0.06f, -1, 2}, kPoint, 1);
    s.scene.bind();
    Settings settings;
    settings.width = settings.height = 4, settings.forced_off = off;
    return render_picture(s.scene.scene, settings, 0);
  };
  const Picture bare = picture(0, 0);
  CHECK(same_picture(picture(0.5f, bit(Effect::diffuse_transmission)), bare));
  CHECK_FALSE(same_picture(picture(0.5f, 0), bare));
}

// Goal: tiles, single rays and the selection of lights give the same light. Method: leaves below lamps near and far and
// many small lights, lit from both sides.
TEST_CASE("diffuse_transmission_is_lit_alike_by_all_ways") {
  GeneratedScene s;
  add_three_below_lamps(plastic(), &s);
  s.diffuse_transmissions.resize(4);
  for (std::size_t i = 0; i < 3; ++i) {
    s.diffuse_transmissions[i].strength = 0.3f + 0.3f * static_cast<float>(i), s.diffuse_transmissions[i].color = kLeaf;
  }
  check_lit_alike_by_all_ways(&s);
}

// Goal: selective rendering does not guess what the textures change. Method: corners of one radiance.
TEST_CASE("diffuse_transmission_is_traced_where_it_is_not_smooth") {
  for (int kind = 0; kind < 3; ++kind) {
    Sheet s(plastic(), 0.5f);
    if (kind == 1) s.passing().strength_texture.texture = s.texture(200, 90, 0, 77);
    if (kind == 2) s.passing().color_texture.texture = s.texture(200, 200, 0);
    auto t = ray_renderer(&s.scene);
    FrameData frame = t->renderer.frame;
    frame.selection = {0.1f, 1, 0.05f};
    Surface surface;
    const Ray ray = {{0.1f, 0.2f, 3}, {0, 0, -1}, 10};
    frame.kernels.surface(frame, ray, {3, 0.25f, 0.25f, 0}, &surface);
    CellCorner corner = {{1, 1, 1}, surface.diffuse, surface.glow, surface.normal, surface.material, true, true};
    CAPTURE(kind);
    CHECK(is_flat(frame, {{&corner, &corner, &corner, &corner}, 0.25f, 0.25f}, 0.1f) == (kind == 0));
  }
}

// Goal: nothing that a ray finds exceeds the bound that rays are left out by. Method: suns on both sides and light from
// everywhere, on leaves that reflect and pass all of it; the bound is not absurd.
TEST_CASE("diffuse_transmission_stays_within_the_radiance_bound") {
  for (float strength : {0.2f, 0.7f, 1.0f}) {
    Sheet s(matte(1), strength);
    s.passing().color = {1, 1, 1};
    s.scene.materials[0].mirror = {0.1f, 0.1f, 0.1f};
    s.scene.lights.push_back(s.scene.lights[0]);
    s.scene.lights[1].direction.z *= -1;
    s.scene.scene.info.ambient = {1, 1, 1};
    auto t = ray_renderer(&s.scene, 3);
    const float bound = t->renderer.frame.cut_off.radiance_bounds.after[3];
    float most = 0;
    for (int i = 1; i < 200; ++i) {
      const double angle = 3.14159 * i / 200;
      const Vec3d eye = Vec3d{std::cos(angle), 0, std::sin(angle)} * 3.0;
      most = std::fmax(most, max_component(look(*t, to_float(eye) + kPoint, kPoint)));
    }
    CAPTURE(strength);
    CHECK(most > 1);
    CHECK(most <= bound);
    CHECK(bound < 10);
  }
}
