#include "session/radiosity.h"

#include <atomic>
#include <cstring>
#include <new>
#include <system_error>

#include "base/check.h"
#include "effect/setting_list.h"
#include "engine/frame.h"
#include "plan/plan_effects.h"
#include "plan/plan_scene.h"
#include "session/interrupt.h"
#include "session/progress.h"
#ifdef POCKETRAY_HAVE_RADIOSITY
#include "session/radiosity_solver.h"
#endif

namespace pocketray {

#ifdef POCKETRAY_HAVE_RADIOSITY
namespace {

struct Block {
  void* bytes = nullptr;
  ~Block() { give_block_back(bytes); }
};

// Makes a renderer of the scene with a one-pixel picture, for its lights and its accelerator.
Status prepare(const Scene& scene, Renderer* renderer, Block* block) {
  Settings settings;
  settings.width = settings.height = 1, settings.threads = 1;
  settings.texture_side_max = kSolvedTextureSide;
  settings.indirect = IndirectChoice::none;
  // Chosen: the default of `render`; doubled until the scene fits.
  for (std::size_t bytes = std::size_t(64) << 20;; bytes *= 2) {
    block->bytes = take_block(bytes);
    if (!block->bytes) return failure("not enough memory to solve radiosity: bake a smaller model");
    *renderer = Renderer();
    start_renderer(block->bytes, bytes, settings, renderer);
    renderer->scene = scene;
    Status planned = plan_renderer(renderer, SceneStorage(), 0);
    if (planned.ok) return build_renderer(renderer);
    if (renderer->memory.plan.total_bytes <= renderer->memory.plan.limit_bytes || bytes > SIZE_MAX / 4) return planned;
    give_block_back(block->bytes);
    block->bytes = nullptr;
  }
}

}  // namespace

namespace {

RadiosityOptions options_of(const RadiosityWork& work) {
  RadiosityOptions options;
  options.threads = work.threads;
  if (work.patch_count > 0) options.patch_count = work.patch_count;
  return options;
}

Status solve(const std::string& name, const RadiosityWork& work, Scene* scene, RadiositySolution* solution,
             SolvedRadiosity* solved) {
  if (!can_solve_radiosity(*scene))
    return failure("%.300s has no light of its own to solve radiosity for: add one to the model", name.c_str());
  Block block;
  Renderer renderer;
  RETURN_IF_ERROR(prepare(*scene, &renderer, &block));
  constexpr std::uint64_t kSteps = 1000;  // chosen: finer than the displayed percentage
  Progress progress = start_progress("solving radiosity", kSteps);
  std::atomic<bool> showing{false};
  Status status = solve_radiosity(
      renderer.frame, options_of(work),
      [&](double share) {
        if (!showing.exchange(true)) {
          show_progress(&progress, static_cast<std::uint64_t>(share * kSteps));
          showing = false;
        }
        return !interrupted;
      },
      solution);
  end_progress(&progress);
  if (!status.ok) return failure("%.300s: %s", name.c_str(), status.message);
  std::size_t bytes = 0;
  auto place = [&](auto& array) { bytes += arena_need(array.bytes()); };
  solution->view(scene);
  visit_radiosity(scene, place);
  solved->memory.resize(bytes + kArenaAlignment);
  Arena arena = make_arena("radiosity", solved->memory.data(), solved->memory.size());
  visit_radiosity(scene, [&](auto& array) {
    if (array.empty()) return;
    void* copy = arena_allocate(&arena, array.bytes());
    std::memcpy(copy, array.data, array.bytes());
    array.data = static_cast<decltype(array.data)>(copy);
  });
  char text[128];
  std::snprintf(text, sizeof text, "%u patches, %u shots, %.2g %% of the light unshot", solution->patch_count,
                solution->shots, 100 * solution->unshot);
  solved->summary = text;
  return success();
}

}  // namespace

Status solve_scene(const std::string& name, const RadiosityWork& work, Scene* scene, SolvedRadiosity* solved) {
  CHECK(scene != nullptr && solved != nullptr);
  RadiositySolution solution;
  try {
    return solve(name, work, scene, &solution, solved);
  } catch (const std::bad_alloc&) {
    const double patches = solution.patch_count;
    if (patches == 0) return failure("%.300s: not enough memory to divide its surfaces for radiosity", name.c_str());
    return failure("%.300s: not enough memory for radiosity: the form factors of %.0f patches take %.0f MiB",
                   name.c_str(), patches, 4 * patches * patches / (1 << 20));
  } catch (const std::system_error&) {
    return failure("%.300s: not enough memory for the %u threads that solve radiosity", name.c_str(), work.threads);
  }
}

bool can_solve_radiosity(const Scene& scene) { return has_light(scene) && scene.info.default_lights == 0; }

Status fit_radiosity(std::uint32_t threads, const Scene& scene, const RadiosityLimit& limit, RadiosityFit* fit) {
  CHECK(can_solve_radiosity(scene) && fit != nullptr);
  *fit = RadiosityFit();
  try {
    Block block;
    Renderer renderer;
    RETURN_IF_ERROR(prepare(scene, &renderer, &block));
    for (std::uint32_t patch_count : {1200u, 300u, 75u}) {
      RadiositySize size;
      RETURN_IF_ERROR(size_radiosity(renderer.frame, options_of({threads, patch_count}), &size));
      const bool fits =
          size.pair_count() <= limit.pair_count && size.patch_count <= limit.patch_count && size.bytes <= limit.bytes;
      *fit = {fits ? patch_count : 0, size.bytes, size.pair_count()};
      if (fits) break;
    }
    return success();
  } catch (const std::bad_alloc&) {
    return failure("not enough memory to divide its surfaces for radiosity");
  } catch (const std::system_error&) {
    return failure("not enough memory for %u threads", threads);
  }
}

Status forecast_scene(std::uint32_t threads, const Scene& scene, RadiosityCost* cost) {
  CHECK(can_solve_radiosity(scene) && cost != nullptr);
  try {
    Block block;
    Renderer renderer;
    RETURN_IF_ERROR(prepare(scene, &renderer, &block));
    RadiosityForecast forecast;
    RETURN_IF_ERROR(forecast_radiosity(renderer.frame, options_of({threads}), &forecast));
    *cost = {forecast.size.bytes, forecast.seconds};
    return success();
  } catch (const std::bad_alloc&) {
    return failure("not enough memory to divide its surfaces for radiosity");
  } catch (const std::system_error&) {
    return failure("not enough memory for %u threads", threads);
  }
}

std::size_t stored_radiosity_bytes(const Scene& scene) {
  try {
    return radiosity_bytes_of_fronts(scene, RadiosityOptions());
  } catch (const std::bad_alloc&) {
    return 0;
  }
}
#else
Status solve_scene(const std::string& name, const RadiosityWork&, Scene*, SolvedRadiosity*) {
  return failure("%.300s stores no radiosity: bake it on a desktop with pocketray bake --radiosity", name.c_str());
}
Status forecast_scene(std::uint32_t, const Scene&, RadiosityCost*) { return failure("this build solves no radiosity"); }
Status fit_radiosity(std::uint32_t, const Scene&, const RadiosityLimit&, RadiosityFit*) {
  return failure("this build solves no radiosity");
}
std::size_t stored_radiosity_bytes(const Scene&) { return 0; }
bool can_solve_radiosity(const Scene&) { return false; }
#endif

void drop_radiosity(Scene* scene) {
  CHECK(scene != nullptr);
  visit_radiosity(scene, [](auto& array) { array = {}; });
}

Status solve_if_requested(const std::string& name, Renderer* renderer, SceneSource* source, SceneStorage* storage) {
  CHECK(renderer != nullptr && source != nullptr && storage != nullptr);
  if (renderer->settings.indirect != indirect_choice(Effect::radiosity) || !renderer->scene.radiosity_triangles.empty())
    return success();
  return solve_into({renderer->settings.threads}, name, renderer, source, storage);
}

Status solve_into(const RadiosityWork& work, const std::string& name, Renderer* renderer, SceneSource* source,
                  SceneStorage* storage) {
  CHECK(renderer != nullptr && source != nullptr && storage != nullptr);
  Scene lit = renderer->scene;
  SolvedRadiosity solved;
  RETURN_IF_ERROR(solve_scene(name, work, &lit, &solved));
  return adopt_radiosity(name, lit, solved, renderer, source, storage);
}

Status adopt_radiosity(const std::string& name, const Scene& lit, const SolvedRadiosity& solved, Renderer* renderer,
                       SceneSource* source, SceneStorage* storage) {
  CHECK(renderer != nullptr && source != nullptr && storage != nullptr);
  auto* copy =
      static_cast<std::uint8_t*>(arena_try_allocate(&renderer->memory.scene, solved.memory.size() + kArenaAlignment));
  if (!copy)
    return scene_too_large(name, renderer->memory.scene.used + solved.memory.size(), renderer->settings.memory_bytes,
                           source);
  // The arrays keep their places relative to the block.
  std::memcpy(copy, solved.memory.data(), solved.memory.size());
  renderer->scene = lit;
  visit_radiosity(&renderer->scene, [&](auto& array) {
    if (array.empty()) return;
    auto* bytes = reinterpret_cast<const std::uint8_t*>(array.data);
    array.data = reinterpret_cast<decltype(array.data)>(copy + (bytes - solved.memory.data()));
  });
  source->baked = nullptr, source->baked_bytes = 0;  // it is no longer the file's scene
  storage->arena_bytes = renderer->memory.scene.used;
  return success();
}

}  // namespace pocketray
