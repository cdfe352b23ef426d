#include "desktop/split_report/pixel_cost.h"

#include <vector>

#include "engine/frame.h"
#include "engine/light_map.h"
#include "session/interrupt.h"
#include "session/measure.h"

namespace pocketray {
namespace {

constexpr std::uint32_t kFrames = 3;

// While it exists, frames are traced on one thread, at this machine's pace.
struct OneThread {
  Renderer* renderer;
  Workers* workers;
  Pace pace;
  explicit OneThread(Renderer* r) : renderer(r), workers(r->workers), pace(r->pace) {
    renderer->workers = nullptr, renderer->pace = Pace();
  }
  ~OneThread() { renderer->workers = workers, renderer->pace = pace; }
};

// Adds a map's light to a frame that has only this machine's own.
Status measure_adding(Renderer* renderer, std::uint32_t pitch, double* ns) {
  const Settings& settings = renderer->settings;
  std::vector<Hit> hits(first_hit_count(settings));
  FrameTask task;
  task.first_hits = hits.data();
  RETURN_IF_ERROR(render_frame(renderer, task));
  const LightGrid grid = light_grid(settings, pitch);
  std::vector<MappedSurface> surfaces(light_count(grid));
  const std::vector<Vec3> lights(light_count(grid), Vec3{1, 1, 1});
  double times[kFrames];
  for (double& time : times) {
    const std::uint64_t begin_ns = kSystemClock.now_ns();
    take_mapped_surfaces(renderer, hits.data(), settings.height, grid, surfaces.data());
    const LightMap map = {grid, renderer->frame.view.camera, 0, surfaces.data(), lights.data()};
    add_mapped_light(renderer, hits.data(), map, 0, settings.height);
    time = static_cast<double>(kSystemClock.now_ns() - begin_ns) / static_cast<double>(pixel_count(*renderer));
  }
  *ns = range_of(times, kFrames).median;
  return success();
}

}  // namespace

Status measure_pixel_ns(Renderer* renderer, double* ns) {
  const OneThread one(renderer);
  double times[kFrames];
  for (double& time : times) {
    RETURN_IF_ERROR(render_frame(renderer, 0, Aov::none, &interrupted));
    time = renderer->timings.trace_ms * 1e6 / pixel_count(*renderer);
  }
  *ns = range_of(times, kFrames).median;
  return success();
}

Status measure_own_light_ns(Renderer* renderer, std::uint32_t pitch, double* ns) {
  *ns = 0;
  if (mapped_light_unfit(*renderer)) return success();
  const Settings kept = renderer->settings;
  Settings own = kept;
  own.indirect = own_indirect(renderer->scene);
  RETURN_IF_ERROR(change_settings(renderer, own));
  double trace_ns = 0, add_ns = 0;
  Status status;
  if (!light_map_unfit(*renderer)) {
    status = measure_pixel_ns(renderer, &trace_ns);
    const OneThread one(renderer);
    if (status.ok) status = measure_adding(renderer, pitch, &add_ns);
  }
  const Status back = change_settings(renderer, kept);
  if (status.ok) *ns = trace_ns + add_ns;
  return status.ok ? back : status;
}

}  // namespace pocketray
