#include "bench/povray/povray_scene.h"

#include <cstdio>

#include "engine/frame.h"
#include "session/picture.h"

namespace pocketray {
namespace {

constexpr std::size_t kBlockBytes = std::size_t(256) << 20;

// Reduces the scene to what both render alike: Lambertian surfaces under one light.
void simplify(PovrayScene* s) {
  Scene* scene = &s->renderer->scene;
  for (const Material& m : scene->materials) {
    Material matte;
    matte.diffuse = m.diffuse;
    s->materials.push_back(matte);
  }
  scene->materials = {s->materials.data(), static_cast<std::uint32_t>(s->materials.size())};
  s->light.position = {-8.6f, 12.5f, 7.2f};
  s->light.intensity = {480, 480, 480};
  scene->lights = {&s->light, 1};
  scene->info.ambient = scene->info.background = {0, 0, 0};
  scene->info.auto_exposure = 0;
  scene->info.exposure = 1;
}

void write_vector(std::FILE* file, const Vec3& v) {
  std::fprintf(file, "<%.9g,%.9g,%.9g>", static_cast<double>(v.x), static_cast<double>(v.y), static_cast<double>(v.z));
}
void write_named(std::FILE* file, const char* name, const Vec3& v) {
  std::fprintf(file, "  %s ", name);
  write_vector(file, v);
  std::fprintf(file, "\n");
}
void write_list(std::FILE* file, const char* name, Array<const Vec3> list) {
  std::fprintf(file, "  %s { %u", name, list.count);
  for (const Vec3& v : list) {
    std::fprintf(file, ",\n    ");
    write_vector(file, v);
  }
  std::fprintf(file, "\n  }\n");
}

// A direction of POV-Ray's camera is direction + x·right + y·up with x and y from −½ to ½.
void write_camera(std::FILE* file, const CameraRays& camera) {
  std::fprintf(file, "camera {\n  perspective\n");
  write_named(file, "location", camera.eye);
  write_named(file, "direction", camera.forward);
  write_named(file, "right", camera.right * 2.0f);
  write_named(file, "up", camera.up * 2.0f);
  std::fprintf(file, "}\n");
}

// POV-Ray gives color · 2 / (1 + (d/f)²) at a distance d and counts no 1/π: a fade distance f far below d approximates
// the inverse square.
void write_light(std::FILE* file, const Light& light) {
  constexpr double kFade = 0.01, kPi = 3.14159265358979323846;
  std::fprintf(file, "light_source {\n");
  write_named(file, "", light.position);
  std::fprintf(file, "  color rgb %.9g\n  fade_distance %g\n  fade_power 2\n}\n",
               static_cast<double>(light.intensity.x) / (2 * kPi * kFade * kFade), kFade);
}

void write_mesh(std::FILE* file, const Scene& scene) {
  std::fprintf(file, "mesh2 {\n");
  write_list(file, "vertex_vectors", scene.positions);
  write_list(file, "normal_vectors", scene.normals);
  std::fprintf(file, "  texture_list { %u", scene.materials.count);
  for (const Material& m : scene.materials) {
    std::fprintf(file, ",\n    texture { pigment { rgb ");
    write_vector(file, m.diffuse);
    std::fprintf(file, " } finish { ambient 0 diffuse 1 } }");
  }
  std::fprintf(file, "\n  }\n  face_indices { %u", scene.triangles.count);
  for (const Triangle& t : scene.triangles)
    std::fprintf(file, ",\n    <%u,%u,%u>,%u", t.vertex(0), t.vertex(1), t.vertex(2), t.material());
  std::fprintf(file, "\n  }\n}\n");
}

}  // namespace

Status open_povray_scene(std::uint32_t width, std::uint32_t height, PovrayScene* s) {
  Settings settings;
  settings.width = width, settings.height = height;
  settings.cut_off_levels = 0;
  settings.memory_bytes = kBlockBytes;
  s->block.reset(new unsigned char[kBlockBytes]);
  s->renderer = std::make_unique<Renderer>();
  SceneStorage storage;
  start_renderer(s->block.get(), kBlockBytes, settings, s->renderer.get());
  RETURN_IF_ERROR(load_scene("statue", s->renderer.get(), &s->source, &storage));
  simplify(s);
  RETURN_IF_ERROR(plan_renderer(s->renderer.get(), storage, picture_bytes(settings)));
  return build_renderer(s->renderer.get());
}

Status write_povray_scene(const PovrayScene& s, const std::string& path) {
  std::FILE* file = std::fopen(path.c_str(), "w");
  if (!file) return failure("cannot write %s", path.c_str());
  std::fprintf(file, "#version 3.7;\nglobal_settings { assumed_gamma 1 }\nbackground { rgb 0 }\n");
  write_camera(file, s.renderer->frame.view.camera);
  write_light(file, s.light);
  write_mesh(file, s.renderer->scene);
  return std::fclose(file) == 0 ? success() : failure("cannot write %s: is the disk full?", path.c_str());
}

}  // namespace pocketray
