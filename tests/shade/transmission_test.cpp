// Textures of glass.
#include "shade/transmission.h"

#include "brdf/brdf_list.h"
#include "shade/dielectric.h"
#include "sunlit_sheet.h"

using namespace pocketray;

namespace {

const Vec3 kBase = {0.9f, 0.7f, 0.5f};

// A sheet of glass with a map, its lobes those of a metallic value and a roughness.
struct Pane : SunlitSheet {
  explicit Pane(float transmission, float metallic = 0, float roughness = 0, bool lit = false)
      : SunlitSheet(Material(), lit) {
    Material& m = scene.materials[0];
    m.brdf = kGgx, m.thin = 1;
    scene.material_maps.resize(1), scene.glass_maps.resize(1);
    MaterialMaps& maps = scene.material_maps[0];
    maps.model = {kBase, {0.04f, 0.04f, 0.04f}, 1};
    maps.metallic = maps.metallic_low = maps.metallic_high = metallic;
    maps.roughness = maps.roughness_low = maps.roughness_high = roughness;
    scene.glass_maps[0].transmission = transmission;
    set_lobes(maps.model, metallic, roughness, transmission, &m);
  }
  Material& material() { return scene.materials[0]; }
  GlassMap& map() { return scene.glass_maps[0]; }
};

struct PaneLook {
  Vec3 seen;
  std::uint64_t passed;
};
PaneLook look_at(GeneratedScene* s, const Vec3& eye) {
  auto t = ray_renderer(s);
  Tracer tracer = make_tracer(t->renderer.frame);
  PaneLook result = {trace_ray(t->renderer, eye, normalize(kPoint - eye), &tracer), 0};
  result.passed = tracer.rays[static_cast<int>(RayKind::refraction)];
  return result;
}

double pane_reflectance(const Vec3& eye) {
  float cos_t;
  const double r = static_cast<double>(fresnel(normalize(eye - kPoint).z, 1 / 1.5f, &cos_t));
  return 2 * r / (1 + r);
}

}  // namespace

// Goal: transmission × texel passes, tinted by base colour and texture, and dims the diffuse lobe; metal transmits
// nothing. Method: closed forms under ambient light before a background; texels of all channels.
TEST_CASE("transmission_map_sets_what_passes") {
  const Vec3 eye = {0.4f, 0.1f, 3};
  for (float metallic : {0.0f, 0.4f})
    for (int texel : {255, 102, 1}) {
      Pane s(0.8f, metallic);
      s.map().transmission_texture.texture = s.texture(texel, 9, 9);
      s.material().diffuse_texture.texture = s.texture(255, 188, 0);
      s.scene.scene.info.ambient = {0.5f, 0.5f, 0.5f}, s.scene.scene.info.background = {1, 1, 1};
      const double t = static_cast<double>(0.8f) * texel / 255, m = static_cast<double>(metallic),
                   r = pane_reflectance(eye);
      const Vec3d color = to_double(kBase) * Vec3d{1, 0.50288646, 0};
      const Vec3d mirror = (Vec3d{0.04, 0.04, 0.04} * (1 - m) + color * m) * (1 - t * (1 - m));
      CAPTURE(texel);
      CAPTURE(metallic);
      const PaneLook found = look_at(&s.scene, eye);
      check_near(found.seen,
                 color * ((1 - m) * (1 - t) * 0.5) + mirror + Vec3d{r, r, r} + color * (t * (1 - m) * (1 - r)), 1e-3);
      CHECK(found.passed == 1);
    }
}

// Goal: where a texel transmits nothing, the surface is the opaque one, bit for bit, and sends no transmitted ray.
// Method: black texels and metal ones, against the material without transmission, lit, matte and glossy.
TEST_CASE("transmission_map_of_black_texels_is_opaque") {
  const Vec3 eye = {-1, -2, 1.5f};
  for (float roughness : {0.0f, 0.5f})
    for (bool by_metal : {false, true}) {
      Pane s(1, 0, roughness, true);
      MaterialMaps& maps = s.scene.material_maps[0];
      if (by_metal) {
        maps.metallic = maps.metallic_high = 1;
        maps.metallic_roughness.texture = s.texture(9, 255, 255);
        set_lobes(maps.model, 0.5f, roughness, 1, &s.material());
      } else {
        s.map().transmission_texture.texture = s.texture(0, 9, 9);
      }
      s.scene.scene.info.background = {1, 1, 1};
      const PaneLook found = look_at(&s.scene, eye);
      CHECK(found.passed == 0);
      Pane opaque(0, by_metal ? 1.0f : 0.0f, roughness, true);
      opaque.scene.glass_maps.clear(), opaque.scene.material_maps.clear();
      opaque.scene.scene.info.background = {1, 1, 1};
      if (by_metal) opaque.material().diffuse = {0, 0, 0};
      const PaneLook expected = look_at(&opaque.scene, eye);
      CHECK(found.seen == expected.seen);
    }
}

// Goal: a thin sheet absorbs like a body of its thickness; a body is its own thickness. Method: Beer–Lambert.
TEST_CASE("transmission_map_has_the_thickness_of_thin_sheets") {
  const Vec3 eye = {0.4f, 0.1f, 3};
  for (bool is_thin : {true, false}) {
    Pane s(1);
    s.material().thin = is_thin, s.material().ior = 1, s.material().absorption = {0.5f, 1, 2};
    s.map().thickness = 0.7f, s.map().thickness_texture.texture = s.texture(9, 153, 9);
    s.scene.scene.info.background = {1, 1, 1};
    Vec3d expected = to_double(kBase);
    if (is_thin)
      for (int c = 0; c < 3; ++c)
        expected[c] *= std::exp(-static_cast<double>(0.7f) * 0.6 * static_cast<double>(s.material().absorption[c]));
    else
      s.material().absorption = {0, 0, 0};
    check_near(look_at(&s.scene, eye).seen, expected);
  }
}

// Goal: shadows have the colours of the glass above them, texel by texel. Method: a sheet under a pane, whose texels
// let light of known colours pass, against the closed form.
TEST_CASE("transmission_map_colors_shadows") {
  for (int texel : {255, 102, 0}) {
    Pane s(1, 0, 0, true);
    s.map().transmission_texture.texture = s.texture(texel, 9, 9);
    s.material().diffuse_texture.texture = s.texture(255, 188, 0);
    s.material().ior = 1;
    add_sheet(&s.scene, -4, add_material(&s.scene, matte(0.5f)), false, 40);
    s.scene.material_maps.emplace_back(), s.scene.glass_maps.emplace_back();
    const double cosine = normalize(to_double(kSun)).z, t = texel / 255.0;
    auto renderer = ray_renderer(&s.scene);
    const Vec3 from = {-9, -12, -2}, to = {0.2f, 0.1f, -4};
    check_near(look(*renderer, from, to), to_double(kBase) * Vec3d{1, 0.50288646, 0} * (t * 0.5 / kPiD * cosine), 1e-3);
  }
}
