#include "desktop/split_report/pixel_cost.h"

#include <algorithm>
#include <vector>

#include "engine/frame.h"
#include "engine/light_map.h"
#include "plan/resolve.h"
#include "session/interrupt.h"
#include "session/measure.h"

namespace pocketray {
namespace {

constexpr int kRunsMin = 3, kRunsMax = 100;
constexpr double kRunsNs = 30e6;  // the runs take at least this long, so that one of them is undisturbed

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

// Calls `run`, which returns the time it took in ns, several times. Returns the shortest, since other work on this
// machine only adds to it; a negative time if a run fails.
template <class Run>
double shortest_ns(const Run& run) {
  double shortest = run(), total = shortest;
  for (int i = 1; shortest >= 0 && i < kRunsMax && (i < kRunsMin || total < kRunsNs); ++i) {
    const double ns = run();
    shortest = std::min(shortest, ns), total += ns;
  }
  return shortest;
}

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
  *ns = shortest_ns([&] {
    const std::uint64_t begin_ns = kSystemClock.now_ns();
    take_mapped_surfaces(renderer, hits.data(), settings.height, grid, surfaces.data());
    const LightMap map = {grid, renderer->frame.view.camera, 0, surfaces.data(), lights.data()};
    add_mapped_light(renderer, hits.data(), map, 0, settings.height);
    return static_cast<double>(kSystemClock.now_ns() - begin_ns);
  });
  *ns /= pixel_count(*renderer);
  return success();
}

}  // namespace

Status measure_pixel_ns(Renderer* renderer, double* ns) {
  const OneThread one(renderer);
  Status status;
  *ns = shortest_ns([&] {
    status = render_frame(renderer, 0, Aov::none, &interrupted);
    return status.ok ? renderer->timings.trace_ms * 1e6 : -1;
  });
  *ns /= pixel_count(*renderer);
  return status;
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
  if (!unshared_because(renderer->effects.mask)) {
    status = measure_pixel_ns(renderer, &trace_ns);
    const OneThread one(renderer);
    if (status.ok) status = measure_adding(renderer, pitch, &add_ns);
  }
  const Status back = change_settings(renderer, kept);
  if (status.ok) *ns = trace_ns + add_ns;
  return status.ok ? back : status;
}

}  // namespace pocketray
