#include "session/room_light.h"

#include <cstdio>

#include "base/check.h"
#include "plan/plan_scene.h"
#include "plan/room.h"
#include "session/light_file.h"
#include "session/note.h"
#include "session/scene_identity.h"

namespace pocketray {
namespace {

bool reflects_anywhere(const Scene& scene) {
  for (const Triangle& t : scene.triangles) {
    const Material& m = scene.materials[t.material()];
    if (!m.unlit && !(is_zero(m.diffuse) && is_zero(m.specular))) return true;
  }
  return false;
}

}  // namespace

bool calls_for_radiosity(const Scene& scene) {
  return scene.radiosity_triangles.empty() && can_solve_radiosity(scene) && reflects_anywhere(scene) &&
         find_room(scene, scene_bounds(scene)).is_room;
}

Status find_room_light(const std::string& name, const ContentHash& identity, std::uint32_t threads,
                       std::size_t bytes_max, Scene* scene, SolvedRadiosity* solved) {
  CHECK(scene != nullptr && solved != nullptr);
  if (is_baked_name(name) || scene->triangles.count > kOpenTrianglesMax || !calls_for_radiosity(*scene))
    return success();
  const std::string path = light_path(name, identity);
  Scene lit = *scene;
  const KeptLight kept = read_light(path, identity, &lit, solved);
  if (kept == KeptLight::none) {
    RadiosityFit fit;
    if (!fit_radiosity(threads, *scene, kOpenLimit, &fit).ok || fit.bytes > bytes_max) return success();
    if (fit.patch_count > 0) RETURN_IF_ERROR(solve_scene(name, {threads, fit.patch_count}, &lit, solved));
    const Status written = path.empty() ? success() : write_light(path, identity, lit);
    if (!written.ok) print_note(std::string(written.message) + "; solving the light of rooms anew each time");
    if (fit.patch_count == 0) return success();
    const bool is_kept = written.ok && !path.empty();
    char text[600];
    std::snprintf(text, sizeof text, "solved the light between surfaces%s%.300s; --indirect ambient omits it",
                  is_kept ? ", kept in " : "", is_kept ? path.c_str() : "");
    print_note(text);
  }
  if (solved->memory.size() <= bytes_max) *scene = lit;
  return success();
}

Status light_room(const std::string& name, Renderer* renderer, SceneSource* source, SceneStorage* storage) {
  CHECK(renderer != nullptr && source != nullptr && storage != nullptr);
  ContentHash identity;
  if (!is_local_scene(name) || !calls_for_radiosity(renderer->scene) ||
      !identify_scene(*source, renderer, &identity).ok)
    return success();
  Scene lit = renderer->scene;
  SolvedRadiosity solved;
  RETURN_IF_ERROR(find_room_light(name, identity, renderer->settings.threads, arena_free(renderer->memory.scene) / 4,
                                  &lit, &solved));
  if (lit.radiosity_triangles.empty()) return success();
  source->lit_unasked = true;
  return adopt_radiosity(name, lit, solved, renderer, source, storage);
}

}  // namespace pocketray
