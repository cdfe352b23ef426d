// A frame in one sentence: scene → plan → accelerate → trace + shade spans. Planning was done before the first frame;
// the source decides which spans are traced, and when; showing the frame is up to the caller.
#include "engine/frame.h"

#include "base/check.h"
#include "base/limit_list.h"
#include "engine/prepare.h"

namespace pocketray {

Status prepare_frame(Renderer* renderer, double seconds) {
  CHECK(renderer->accel_info != nullptr && renderer->image.data != nullptr);  // it has been built
  RETURN_IF_ERROR(check_limit(Quantity::seconds, seconds));
  renderer->pace.owed_ns = 0;
  renderer->coherence.following = renderer->shared_rows.records = false;  // the geometry is about to move
  pose_scene(renderer, seconds);
  accelerate(renderer);
  choose_kernels(renderer);
  light_scene(renderer);
  RETURN_IF_ERROR(aim_camera(renderer));
  make_tracers(renderer);
  return success();
}

Status render_frame(Renderer* renderer, double seconds, const SpanSource& source, bool* complete) {
  RETURN_IF_ERROR(prepare_frame(renderer, seconds));
  const Clock& clock = *renderer->pace.clock;
  std::uint64_t start = clock.now_ns();
  bool done = trace_frame(renderer, source);
  renderer->timings.trace_ms = static_cast<double>(clock.now_ns() - start) * 1e-6;
  if (complete) *complete = done;
  return success();
}

Status render_frame(Renderer* renderer, double seconds, Aov aov, const std::atomic<bool>* stop,
                    std::uint32_t* rows_done) {
  SpanList list = whole_frame(renderer);
  SpanSource source = list_source(&list);
  source.aov = aov;
  source.stop = stop;
  RETURN_IF_ERROR(render_frame(renderer, seconds, source));
  if (rows_done) *rows_done = list.done_count;
  return success();
}

}  // namespace pocketray
