#include "scene/builtin/builtin.h"

#include <cstring>

#include "base/check.h"
#include "scene/builtin/builtin_scenes.h"

namespace pocketray {
namespace {

constexpr BuiltinScene kScenes[] = {
    {"cornell", "the measured Cornell box with a statue and a mirror sphere; 45,109 triangles", cornell_need,
     build_cornell},
    {"statue", "the statue in its niche, between columns; 67,244 triangles", statue_need, build_statue},
    {"seesaw", "a weight launches a worm in a circus tent; 6,000 triangles, 4 lights, 351 frames", seesaw_need,
     build_seesaw},
    {"cube", "a closed cube lit by an area light in its ceiling; 20 triangles", cube_need, build_cube},
    {"furnace", "a closed enclosure that emits uniformly, so that radiance is Le/(1-rho) everywhere", furnace_need,
     build_furnace},
    {"lanterns", "a street lit by 200 lanterns and 12 windows; 26,358 triangles", lanterns_need, build_lanterns},
};

}  // namespace

const BuiltinScene* builtin_list(int* count) {
  CHECK(count != nullptr);
  *count = static_cast<int>(sizeof kScenes / sizeof *kScenes);
  return kScenes;
}

const BuiltinScene* find_builtin(const char* name) {
  CHECK(name != nullptr);
  for (const BuiltinScene& scene : kScenes)
    if (std::strcmp(scene.name, name) == 0) return &scene;
  return nullptr;
}

}  // namespace pocketray
