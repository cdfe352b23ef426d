#include "bench/bench_scene.h"

#include <cstdlib>

#include "engine/frame.h"
#include "plan/plan_scene.h"
#include "platform/file.h"

namespace pocketray {
namespace {

struct Model {
  const char *name, *file, *archive;  // under the model folder, or in an archive there
};
constexpr Model kModels[] = {{"buddha", "mesh/happy_vrip_res3.ply", nullptr},
                             {"bunny", "mesh/bunny/bun_zipper.ply", nullptr},
                             {"dragon", "mesh/dragon_100k.obj", nullptr},
                             {"conference", "conference.obj", "rooms/conference.zip"}};
constexpr std::size_t kBlockBytes = std::size_t(1) << 30;  // more than any scene needs; untouched pages cost nothing

const Model* find_model(const std::string& name) {
  for (const Model& model : kModels)
    if (name == model.name) return &model;
  return nullptr;
}

bool exists(const std::string& path) { return platform::file_stamp(path.c_str()) != 0; }

std::string quoted(const std::string& text) {
  std::string result = "'";
  for (char c : text) result += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return result + "'";
}

Status unpack(const std::string& archive, const std::string& folder) {
  std::string command = "mkdir -p " + quoted(folder) + " && unzip -q -o " + quoted(archive) + " -d " + quoted(folder);
  if (std::system(command.c_str()) == 0) return success();
  return failure("cannot unpack %s into %s: is unzip installed?", archive.c_str(), folder.c_str());
}

Status find_file(const Model& model, const std::string& model_folder, const std::string& cache_folder,
                 std::string* path, bool* found) {
  *path = (model.archive ? cache_folder : model_folder) + "/" + model.file;
  if (model.archive && !exists(*path)) {
    std::string archive = model_folder + "/" + model.archive;
    *found = exists(archive);
    return *found ? unpack(archive, cache_folder) : success();
  }
  *found = exists(*path);
  return success();
}

}  // namespace

const std::vector<std::string>& default_scene_names() {
  static const std::vector<std::string> names = {"buddha", "bunny", "dragon", "conference", "cornell", "statue"};
  return names;
}

Status load_bench_scene(const std::string& name, const std::string& model_folder, const std::string& cache_folder,
                        BenchScene* scene, bool* found) {
  std::string path = name;
  *found = true;
  if (const Model* model = find_model(name))
    RETURN_IF_ERROR(find_file(*model, model_folder, cache_folder, &path, found));
  if (!*found) return success();
  scene->name = name;
  scene->block.reset(new unsigned char[kBlockBytes]);
  scene->renderer = std::make_unique<Renderer>();
  SceneStorage storage;
  start_renderer(scene->block.get(), kBlockBytes, Settings(), scene->renderer.get());
  RETURN_IF_ERROR(load_scene(path, scene->renderer.get(), &scene->source, &storage));
  RETURN_IF_ERROR(plan_renderer(scene->renderer.get(), storage, 0));
  scene->camera = scene->renderer->view.camera;
  scene->bounds = scene_bounds(scene->scene());
  if (scene->scene().triangles.count == 0) return failure("%s has no triangles", name.c_str());
  return success();
}

}  // namespace pocketray
