// Normals and occlusion from textures.
#include <doctest/doctest.h>

#include <cstring>

#include "brdf/brdf_list.h"
#include "shade_helpers.h"

using namespace pocketray;

namespace {

constexpr float kAlbedo = 0.8f;

// A double-sided sheet in the plane z = 0 under a directional light, with a one-texel normal map if there is a texel.
// Texture coordinates run along x and y, stretched by `by_u` and `by_v`.
struct Sheet {
  GeneratedScene scene;
  std::uint32_t material;
  explicit Sheet(Vec3 to_light, float by_u = 1, float by_v = 1) {
    Material m = matte(kAlbedo);
    m.double_sided = 1;
    material = add_material(&scene, m);
    add_sheet(&scene, 0, material, false, 10);
    for (Vec2& uv : scene.uvs) uv = {uv.x * by_u, uv.y * by_v};
    scene.with_uvs = true;
    scene.lights.resize(1);
    scene.lights[0].kind = LightKind::directional;
    scene.lights[0].direction = -normalize(to_light);
    scene.material_maps.resize(1);
  }
  MaterialMaps& maps() { return scene.material_maps[0]; }
  void add_normal(int r, int g, int b) { maps().normal.texture = add_texture(&scene, 1, 1, {{r, g, b, 255}}); }
};

Vec3 seen(GeneratedScene* s, const Vec3& eye, const Vec3& at = {0.1f, 0.2f, 0}) {
  auto t = ray_renderer(s);
  return look(*t, eye, at);
}
bool same_bits(const Vec3& a, const Vec3& b) { return std::memcmp(&a, &b, sizeof a) == 0; }

// Of a matte surface with that normal, under a light of irradiance 1.
double lit(const Vec3d& normal, const Vec3& to_light) {
  return static_cast<double>(kAlbedo) / kPiD * dot(normalize(normal), normalize(to_double(to_light)));
}

}  // namespace

// Goal: a texel (128, 128, 255) leaves the normal as it is, and so does a map where texture coordinates span no area.
// Method: the same bits as without a map, with normals at vertices and without.
TEST_CASE("normal_map_that_is_flat_changes_nothing") {
  for (bool smooth : {false, true})
    for (bool degenerate : {false, true}) {
      Sheet plain({1, 2, 3}), mapped({1, 2, 3}, degenerate ? 0.0f : 1.0f);
      degenerate ? mapped.add_normal(200, 30, 200) : mapped.add_normal(128, 128, 255);
      for (Sheet* s : {&plain, &mapped}) {
        s->scene.with_normals = smooth;
        for (std::size_t i = 0; i < s->scene.normals.size(); ++i)
          s->scene.normals[i] = normalize(Vec3{0.1f * static_cast<float>(i), -0.2f, 1});
      }
      CAPTURE(smooth);
      CAPTURE(degenerate);
      CHECK(same_bits(seen(&plain.scene, {1, 0.5f, 2}), seen(&mapped.scene, {1, 0.5f, 2})));
    }
}

// Goal: red leans along u, green against v, blue is the normal's; mirrored coordinates mirror the lean, the back
// reverses it, the scale stretches it. Method: closed form of a matte sheet under a directional light.
TEST_CASE("normal_map_leans_as_gltf_has_it") {
  const Vec3 light = {0.3f, 0.5f, 1};
  const double x = (170 - 128) / 127.0, y = (90 - 128) / 127.0, z = (220 - 128) / 127.0;
  for (float by_u : {3.0f, -1.0f})
    for (float by_v : {0.5f, -2.0f})
      for (float scale : {1.0f, 0.25f, -1.0f})
        for (bool back : {false, true}) {
          Sheet s(back ? -light : light, by_u, by_v);
          s.add_normal(170, 90, 220);
          s.maps().normal_scale = scale;
          const double side = back ? -1 : 1, lean = static_cast<double>(scale);
          const Vec3d n = Vec3d{x * lean * (by_u < 0 ? -1 : 1), -y * lean * (by_v < 0 ? -1 : 1), z} * side;
          CAPTURE(by_u);
          CAPTURE(by_v);
          CAPTURE(scale);
          CAPTURE(back);
          const float found = seen(&s.scene, {0.2f, 0.1f, back ? -2.0f : 2.0f}).x;
          CHECK(static_cast<double>(found) == doctest::Approx(lit(n, back ? -light : light)).epsilon(1e-5));
        }
}

// Goal: the tangent follows the triangle wherever it lies. Method: closed form of a sheet turned by 90° about y and its
// texture by 90°.
TEST_CASE("normal_map_turns_with_the_surface") {
  const Vec3 light = {1, 0.4f, -0.2f};
  Sheet s(light);
  s.add_normal(170, 90, 220);
  for (Vec3& p : s.scene.positions) p = {0, p.y, -p.x};  // faces +x, u along −z, v along y
  for (Vec2& uv : s.scene.uvs) uv = {uv.y, -uv.x};       // u along y, v along z
  const Vec3d n = {(220 - 128) / 127.0, (170 - 128) / 127.0, -(90 - 128) / 127.0};
  CHECK(static_cast<double>(seen(&s.scene, {2, 0.1f, 0.3f}, {0, 0.2f, 0.1f}).x) ==
        doctest::Approx(lit(n, light)).epsilon(1e-5));
}

// Goal: vertices with a handedness have the frame that they say, whatever the texture coordinates: a tangent turned by
// 90° lights like coordinates turned by 90°. Method: closed form, from both sides; coordinates mirrored and of no area;
// then bits of the turned sheet; then vertices that differ, where the majority decides.
TEST_CASE("normal_map_follows_the_frame_of_vertices") {
  const Vec3 light = {0.3f, 0.5f, 1};
  const double x = (170 - 128) / 127.0, y = (90 - 128) / 127.0, z = (220 - 128) / 127.0;
  for (int handedness : {1, -1})
    for (float by_v : {0.5f, -2.0f, 0.0f})
      for (bool back : {false, true}) {
        Sheet s(back ? -light : light, 1, by_v);
        s.add_normal(170, 90, 220);
        s.scene.tangents.assign(s.scene.positions.size(), {0, 127, 0, static_cast<std::int8_t>(handedness)});
        const Vec3d n = Vec3d{-y * handedness, x, z} * (back ? -1.0 : 1.0);
        CAPTURE(handedness);
        CAPTURE(by_v);
        CAPTURE(back);
        const float found = seen(&s.scene, {0.2f, 0.1f, back ? -2.0f : 2.0f}).x;
        CHECK(static_cast<double>(found) == doctest::Approx(lit(n, back ? -light : light)).epsilon(1e-5));
      }
  Sheet given(light), turned(light);
  given.add_normal(170, 90, 220), turned.add_normal(170, 90, 220);
  given.scene.tangents.assign(given.scene.positions.size(), {0, 127, 0, 1});
  for (Vec2& uv : turned.scene.uvs) uv = {uv.y, uv.x};  // u along y, v along x
  CHECK(same_bits(seen(&given.scene, {0.2f, 0.1f, 2}), seen(&turned.scene, {0.2f, 0.1f, 2})));
  for (std::size_t other = 0; other < given.scene.positions.size(); ++other) {
    given.scene.tangents.assign(given.scene.positions.size(), {0, 127, 0, 1});
    given.scene.tangents[other].handedness = -1;
    CHECK(same_bits(seen(&given.scene, {0.2f, 0.1f, 2}), seen(&turned.scene, {0.2f, 0.1f, 2})));
  }
}

// Goal: a normal that faces away from the viewer is bent to the viewer's horizon: finite light, neither black nor NaN.
// Method: closed form: a horizontal normal seen against its lean, of a matte sheet; all kinds of texels on a metal, a
// mirror and glass.
TEST_CASE("normal_map_facing_away_is_bent_to_the_horizon") {
  const Vec3 light = {0.4f, 0.1f, 1}, eye = {-3, 0, 1};
  Sheet s(light);
  s.add_normal(255, 128, 128);
  const Vec3d way = normalize(to_double(Vec3{0.1f, 0.2f, 0} - eye)), lean = {1, 0, 0};
  CHECK(static_cast<double>(seen(&s.scene, eye).x) ==
        doctest::Approx(lit(lean - way * dot(lean, way), light)).epsilon(1e-4));
  for (int kind = 0; kind < 3; ++kind)
    for (int r : {0, 1, 128, 255})
      for (int g : {0, 128, 129, 255})
        for (int b : {0, 128, 255}) {
          Sheet any(light);
          Material& m = any.scene.materials[0];
          if (kind == 0) m.specular = {1, 1, 1}, m.brdf = kGgx, m.roughness = 0.2f, m.grazing = 1;
          if (kind == 1) m.mirror = {1, 1, 1};
          if (kind == 2) m = glass(1.5f);
          any.add_normal(r, g, b);
          any.scene.scene.info.background = any.scene.scene.info.ambient = {1, 1, 1};
          const Vec3 found = seen(&any.scene, eye);
          CAPTURE(kind);
          CAPTURE(r);
          CAPTURE(g);
          CAPTURE(b);
          CHECK((found.x > 0 && found.x < 1000));
        }
}

// Goal: a scene scaled by a power of two has the same bits. Method: a leaning normal at three scales.
TEST_CASE("normal_map_does_not_depend_on_scale") {
  Vec3 found[3];
  int i = 0;
  for (float scale : {1.0f, 0x1p-40f, 0x1p40f}) {
    Sheet s({1, 2, 3});
    s.add_normal(170, 90, 220);
    for (Vec3& p : s.scene.positions) p = p * scale;
    found[i++] = seen(&s.scene, Vec3{1, 0.5f, 2} * scale, Vec3{0.1f, 0.2f, 0} * scale);
  }
  CHECK(found[0].x > 0);
  CHECK(same_bits(found[0], found[1]));
  CHECK(same_bits(found[0], found[2]));
}

// Goal: an occlusion map scales ambient light, on the diffuse and on the glossy lobe, and nothing else. Method: closed
// form with lights and ambient light apart: a map of red 51 at strength 0.75 leaves 1 + 0.75 (0.2 − 1) = 0.4.
TEST_CASE("occlusion_map_scales_ambient_light_only") {
  const Vec3 eye = {1, 0.5f, 2}, light = {1, 2, 3};
  for (bool shiny : {false, true}) {
    Vec3 found[2][3];
    for (int mapped = 0; mapped < 2; ++mapped)
      for (int part = 0; part < 3; ++part) {  // ambient light, a light, emission
        Sheet s(light);
        Material& m = s.scene.materials[0];
        if (shiny) m.specular = {0.5f, 0.4f, 0.3f}, m.brdf = kGgx, m.roughness = 0.4f, m.grazing = 1;
        if (mapped) {
          s.maps().occlusion.texture = add_texture(&s.scene, 1, 1, {{51, 255, 255, 255}});
          s.maps().occlusion_strength = 0.75f;
        }
        if (part == 0) s.scene.scene.info.ambient = {0.5f, 0.6f, 0.7f};
        if (part != 1) s.scene.lights[0].intensity = {0, 0, 0};
        if (part == 2) m.emission = {3, 2, 1};
        found[mapped][part] = seen(&s.scene, eye);
      }
    CAPTURE(shiny);
    for (int c = 0; c < 3; ++c) {
      CHECK(found[0][0][c] > 0);
      CHECK(found[1][0][c] == doctest::Approx(0.4 * static_cast<double>(found[0][0][c])).epsilon(1e-5));
    }
    CHECK(same_bits(found[0][1], found[1][1]));
    CHECK(same_bits(found[0][2], found[1][2]));
  }
}
