#include <memory>

#include "fuzz/fuzz.h"
#include "support/generated_scene.h"

namespace pocketray {

void fuzz_render(const Scene& scene) {
  // Larger ones only take time.
  constexpr std::uint32_t kTrianglesToRender = 256;
  if (scene.triangles.count > kTrianglesToRender) return;
  Settings settings;
  settings.width = 4, settings.height = 3, settings.ray_depth = 3, settings.points_per_area_light = 1;
  settings.memory_bytes = 2u << 20;
  Status status;
  std::unique_ptr<TestRenderer> test = make_renderer(scene, settings, nullptr, &status);
  if (!test) return;
  for (double seconds : {0.0, 0.7}) fuzz_counts.frames += render_frame(&test->renderer, seconds).ok;
}

}  // namespace pocketray
