// The studio, and the models that call for one.
#include <doctest/doctest.h>

#include <cmath>

#include "base/fmath.h"
#include "base/rng.h"
#include "brdf/brdf_list.h"
#include "desktop/import/environment.h"
#include "import/gltf_writer.h"
#include "import/import_testing.h"
#include "indirect/environment.h"
#include "plan/plan_scene.h"
#include "scene/metallic_roughness.h"
#include "session/source.h"

using namespace pocketray;

namespace {

constexpr int kSide = 400;  // of a grid over the octahedral map

// Sums value(direction) × solid angle over all directions.
template <class Value>
double integral(Value value) {
  double sum = 0;
  for (int i = 0; i < kSide * kSide; ++i) {
    const Vec3d p = from_octahedral(2 * (i % kSide + 0.5) / kSide - 1, 2 * (i / kSide + 0.5) / kSide - 1);
    const double square = dot(p, p), distance = std::sqrt(square);
    sum += value(p / distance) * 4 / (double(kSide) * kSide * square * distance);
  }
  return sum;
}

// Irradiance / π of a surface.
double irradiance_of_studio(const Vec3d& normal) {
  return integral([&](const Vec3d& d) {
           const double cosine = dot(d, normal);
           return cosine > 0 ? studio_radiance(d).y * cosine : 0;
         }) /
         kPi;
}

// A box of half sides a and b at distance 1, seen from its middle.
double solid_angle(double a, double b) { return 4 * std::asin(a * b / std::sqrt((1 + a * a) * (1 + b * b))); }

// One triangle of one material, in OBJ.
ImportedScene triangle_of(const std::string& material) {
  const TemporaryFolder folder;
  folder.write("a.mtl", "newmtl a\n" + material + "\n");
  const std::string path = folder.write("a.obj", "mtllib a.mtl\nusemtl a\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  ImportedScene imported;
  const Status status = import_model(path, ImportOptions(), &imported);
  REQUIRE_MESSAGE(status.ok, status.message);
  return imported;
}
bool has_studio(const ImportedScene& model) { return model.scene.environment_info.count == 1; }

}  // namespace

// Goal: the studio's light is that of its boxes and backdrop. Method: the boxes' solid angles in closed form, which
// soft edges keep to within a few percent; the smooth steps' means, a half; radiance in the middle of the key's box.
TEST_CASE("studio_sends_the_light_of_its_boxes") {
  const double boxes =
      2 * solid_angle(0.3, 0.27) + solid_angle(0.18, 0.38) + 2 * solid_angle(0.32, 0.2) + 0.8 * solid_angle(0.3, 0.3);
  const double floor = 0.17 - 0.1 * (0.8 / 2 + 0.2), wall = 0.17 + 0.15 * (0.9 / 2 + 0.1);
  const double expected = boxes + 2 * kPi * (floor + wall);
  CHECK(integral([](const Vec3d& d) { return studio_radiance(d).y; }) == doctest::Approx(expected).epsilon(0.02));
  const Vec3d key = normalize(Vec3d{-0.45, 0.95, 0.95});
  CHECK(studio_radiance(key).y == doctest::Approx(2 + 0.17 + 0.15 * 0.835).epsilon(0.01));
  CHECK(studio_radiance({0, -1, 0}).y == doctest::Approx(0.07));
}

// Goal: a camera that looks straight ahead sees an even backdrop. Method: directions below 10° of elevation differ by
// their height alone; no direction is dark, none jumps.
TEST_CASE("studio_hangs_its_boxes_high") {
  Rng rng = make_rng(3);
  double least = 1;
  for (int i = 0; i < 20000; ++i) {
    const double y = 1.17 * next_double(&rng) - 1, turn = 2 * kPi * next_double(&rng), across = std::sqrt(1 - y * y);
    const Vec3d found = studio_radiance({across * det_cos(turn), y, across * det_sin(turn)});
    const Vec3d expected = studio_radiance({across, y, 0});
    for (int c = 0; c < 3; ++c) CHECK(found[c] == doctest::Approx(expected[c]));
    least = std::fmin(least, found.x);
  }
  CHECK(least > 0.05);
}

// Goal: a white surface is as bright in the studio, with what is left of the default lights, as under these alone, and
// no side is darker. Method: integrals over the studio; the lights' cosines.
TEST_CASE("studio_leaves_models_as_bright_as_default_lights_do") {
  auto model = triangle_of("Kd 1 1 1");
  const Box bounds = scene_bounds(model.scene);
  const DefaultView view = find_default_view(model.scene, bounds);
  const Camera camera = default_camera(view, find_framing(model.scene, view, bounds), bounds, 4.0f / 3);
  Light lights[kDefaultLightCount];
  default_lights(view, bounds, camera, lights);
  auto by_lights = [&](const Vec3d& normal) {
    double sum = 0;
    for (const Light& light : lights)
      sum += std::fmax(0.0, -dot(to_double(light.direction), normal)) * double(light.intensity.y) / kPi;
    return sum;
  };
  const Vec3d to_key = -to_double(lights[0].direction), to_camera = normalize(to_double(camera.eye - camera.target));
  auto in_studio = [&](const Vec3d& normal) {
    return irradiance_of_studio(normal) + double(kStudioLightShare) * by_lights(normal);
  };
  auto alone = [&](const Vec3d& normal) { return double(default_ambient().y) + by_lights(normal); };
  for (const Vec3d& normal : {to_key, to_camera}) {
    CAPTURE(normal.y);
    CHECK(in_studio(normal) < 1.1 * alone(normal));
    CHECK(in_studio(normal) > 0.9 * alone(normal));
  }
  for (const Vec3d& normal : {Vec3d{0, -1, 0}, Vec3d{0, 1, 0}, Vec3d{1, 0, 0}, Vec3d{-1, 0, 0}, Vec3d{0, 0, -1}})
    CHECK(in_studio(normal) > 0.9 * alone(normal));
}

// Goal: models get the studio where it shows: metal, mirror, glass, a clear coat or polish. Method: one material at a
// time; what no triangle shows does not count, nor do a lamp's model and one that is told to do without.
TEST_CASE("studio_comes_where_it_shows") {
  for (const char* material : {"Kd 0.8 0.8 0.8\nPm 1\nPr 1", "Kd 0.8 0.8 0.8\nPm 1\nPr 0.2", "Pm 0\nPr 0.4",
                               "Kd 1 1 1\nPr 0.8\nPc 1", "illum 7\nd 0.2\nNi 1.5", "Ks 0.8 0.8 0.8\nillum 3"}) {
    CAPTURE(std::string(material));
    const ImportedScene model = triangle_of(material);
    CHECK(has_studio(model));
    CHECK(model.scene.info.default_lights == 1);
    CHECK(model.scene.environment_texels.count == environment_texel_count(128, 64));
    CHECK(model.scene.environment_texels.bytes() < 110 << 10);
  }
  for (const char* material : {"Kd 1 1 1", "Pm 0\nPr 0.8", "Kd 1 1 1\nKs 0.5 0.5 0.5\nNs 100", "Kd 0 0 0\nKe 9 9 9",
                               "Kd 0.8 0.8 0.8\nPm 1\nPr 0.2\nKe 9 9 9"}) {
    CAPTURE(std::string(material));
    CHECK_FALSE(has_studio(triangle_of(material)));
  }
  auto diffuse = triangle_of("Kd 1 1 1");
  Material metal;
  metal.brdf = kGgx, metal.specular = {1, 1, 1};
  const Material materials[] = {diffuse.scene.materials[0], metal};
  diffuse.scene.materials = {materials, 2};
  CHECK_FALSE(calls_for_studio(diffuse.scene));
  const TemporaryFolder folder;
  ImportedScene without;
  folder.write("a.mtl", "newmtl a\nKd 0.8 0.8 0.8\nPm 1\nPr 0.2\n");
  const std::string path = folder.write("a.obj", "mtllib a.mtl\nusemtl a\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  REQUIRE(import_model(path, ImportOptions(), &without, false).ok);
  CHECK_FALSE(has_studio(without));
}

// Goal: textures of metal and roughness count by their range. Method: a factor of metal with a texture that has none of
// it, and some.
TEST_CASE("studio_counts_what_textures_reach") {
  auto model = triangle_of("Kd 1 1 1");
  Material m = model.scene.materials[0];
  MaterialMaps maps;
  maps.metallic_roughness.texture = 0;
  maps.model.base = {1, 1, 1}, maps.model.dielectric = {0.04f, 0.04f, 0.04f}, maps.model.grazing = 1;
  maps.metallic_low = maps.metallic_high = 0, maps.roughness_low = maps.roughness_high = 0.9f;
  set_lobes(maps.model, 1, 1, 0, &m);
  m.brdf = kGgx;
  model.scene.materials = {&m, 1}, model.scene.material_maps = {&maps, 1};
  CHECK_FALSE(calls_for_studio(model.scene));
  maps.roughness_low = 0.3f;
  CHECK(calls_for_studio(model.scene));
  maps.roughness_low = 0.9f, maps.metallic_high = 0.5f;
  CHECK(calls_for_studio(model.scene));
}

// Goal: a model with a light, in the open, gets a dimmed studio and its exposure measured of surfaces; not if it is to
// do without. Method: a triangle under a directional light, in glTF.
TEST_CASE("studio_fills_the_shadows_of_a_models_own_light") {
  const TemporaryFolder folder;
  const std::string path = folder.write(
      "a.gltf",
      triangle_gltf("",
                    ",\"extensions\":{\"KHR_lights_punctual\":{\"lights\":[{\"type\":\"directional\",\"intensity\":"
                    "400}]}}",
                    ",\"extensions\":{\"KHR_lights_punctual\":{\"light\":0}}"));
  ImportedScene filled, alone;
  REQUIRE(import_model(path, ImportOptions(), &filled).ok);
  REQUIRE(import_model(path, ImportOptions(), &alone, false).ok);
  CHECK(filled.has_fill);
  CHECK(has_studio(filled));
  CHECK(filled.scene.info.auto_exposure == 2);
  CHECK(filled.scene.info.default_lights == 0);
  CHECK(filled.scene.lights.count == 1);
  CHECK(filled.scene.environment_info[0].scale > 1);
  CHECK_FALSE(alone.has_fill);
  CHECK_FALSE(has_studio(alone));
  CHECK(alone.scene.info.auto_exposure == 1);
}
