// Advances a job from request to pixels, one slice of CPU time at a time.
#include <algorithm>
#include <cmath>
#include <cstring>

#include "base/check.h"
#include "effect/setting_list.h"
#include "engine/shared_rows.h"
#include "plan/plan_effects.h"
#include "remote/server/session.h"

namespace pocketray {
namespace {

// Chosen: all of a 320×240 picture, 1/32 of the largest that a server accepts by default. With more, searching a large
// picture would delay other clients.
constexpr std::uint32_t kSearchPixels = 1u << 17;  // searched at once
// First pixels of an exposure, while their cost is unknown; as in session.cpp.
constexpr std::uint32_t kFirstPixels = 8;
// A chunk is packed and coded at once. Derived: at the 100 to 200 ns per pixel of a small server, this takes 3 to 7 ms,
// less than a slice.
constexpr std::uint32_t kServerChunkPixels = 1u << 15;

// Memory that a step may touch for the first time: the system then provides and clears it. Chosen: at the 0.5 to 2.5 ms
// per MiB of small and virtual machines, less than a slice.
constexpr std::size_t kTouchBytes = 2u << 20;

// Touches the block up to `end`, as far as a step may; returns false if more is left.
bool touch(Session* session, std::size_t end) {
  CHECK_LE(end, session->block.capacity);
  std::size_t* begin = &session->touched_bytes;
  *begin = std::max(*begin, session->block.used);
  const std::size_t next = std::min(end, *begin + kTouchBytes);
  if (next <= *begin) return true;
  std::memset(session->block.base + *begin, 0, next - *begin);
  *begin = next;
  return next == end;
}

// Largest number of rows in a chunk of that shape.
std::uint32_t chunk_rows_max(CodecShape shape) {
  shape.chunk_rows_max = std::min({shape.height, kChunkRowsLimit, std::max(1u, kServerChunkPixels / shape.width)});
  while (shape.chunk_rows_max > 1 && !codec_shape_valid(shape)) shape.chunk_rows_max -= shape.chunk_rows_max / 8 + 1;
  return shape.chunk_rows_max;
}

Status make_codec(Session* session) {
  CHECK(session->encoder == nullptr);
  arena_release(&session->block, session->frame_mark);
  session->built_scene = nullptr;  // its renderer lay behind the codec
  std::size_t pixels = std::size_t(session->shape.width) * session->shape.height * pixel_bytes(session->shape.format);
  if (arena_need(pixels) + row_encoder_need(session->shape) > arena_free(session->block))
    return failure("%ux%u pixels need more than the memory per client", session->shape.width, session->shape.height);
  session->pixels = arena_array<std::uint8_t>(&session->block, pixels);
  make_row_encoder(session->shape, &session->block, &session->encoder);
  return success();
}

bool same_pixels(const Settings& a, const Settings& b) {
  return a.width == b.width && a.height == b.height && a.texture_side_max == b.texture_side_max && same_quality(a, b) &&
         a.forced_on == b.forced_on && a.forced_off == b.forced_off;
}

bool is_built_for(const Session& session) {
  const FrameRequest& request = session.job.request;
  return session.built_scene == session.job.scene && same_pixels(session.renderer.settings, request.settings) &&
         session.renderer.view.camera_index == request.camera_index;
}

// Rows of the largest chunk within the limits of request, codec and client.
std::uint32_t largest_chunk_rows(const Session& session) {
  std::uint32_t rows = session.job.request.chunk_rows;
  if (rows > session.shape.chunk_rows_max) rows = session.shape.chunk_rows_max;
  while (rows > 0 &&
         row_chunk_prefix_bytes(true, true) + encoded_bytes_max(session.shape, rows) > session.message_bytes_max)
    --rows;
  return rows;
}

Status plan_chunks(Session* session) {
  if (!session->encoder) {
    session->shape.chunk_rows_max = chunk_rows_max(session->shape);
    if (!codec_shape_valid(session->shape)) return failure("no message can hold one of its rows");
    RETURN_IF_ERROR(make_codec(session));
  }
  const std::uint32_t rows_max = largest_chunk_rows(*session);
  session->job.request.chunk_rows = static_cast<std::uint16_t>(rows_max);
  return rows_max > 0 ? success() : failure("the client accepts no message large enough for a row");
}

// Plans the renderer for the job's scene and settings.
Status plan_memory(Session* session, const JobTools& tools, WireError* code) {
  CHECK_GE(tools.thread_count, 1u);
  session->built_scene = nullptr;
  session->trace_ns = session->probe_ns = session->light_ns = 0;
  Renderer* renderer = &session->renderer;
  *renderer = Renderer();
  Settings settings = session->job.request.settings;
  settings.threads = tools.thread_count;
  settings.coherence = tools.coherence;
  *code = WireError::bad_request;
  RETURN_IF_ERROR(validate_settings(settings));
  const Scene& scene = session->job.scene->scene;
  renderer->view.camera_index = session->job.request.camera_index;
  if (renderer->view.camera_index > 0 && renderer->view.camera_index >= scene.cameras.count)
    return failure("no camera %u: the scene has %u", renderer->view.camera_index, scene.cameras.count);
  start_renderer(session->block.base + session->block.used, arena_free(session->block), settings, renderer);
  renderer->scene = scene;
  *code = WireError::too_large;
  RETURN_IF_ERROR(plan_renderer(renderer, SceneStorage(), 0));
  session->own_camera = renderer->view.camera;
  renderer->workers = tools.workers;
  session->job.stage = JobStage::build;
  return success();
}

JobStage after_build(const Session& session) {
  return session.own_exposure > 0 ? JobStage::aim : JobStage::own_exposure;
}

// Builds the renderer as planned, once its memory has been touched, and starts measuring the scene's exposure if
// required.
Status build(Session* session) {
  Renderer* renderer = &session->renderer;
  std::size_t bytes = arena_need(renderer->memory.scene.used);
  for (std::size_t arena : renderer->memory.plan.arena_bytes) bytes += arena;
  const std::size_t begin = static_cast<std::size_t>(renderer->memory.scene.base - session->block.base);
  const std::size_t end = begin + bytes;
  session->touched_bytes = std::max(session->touched_bytes, begin + renderer->memory.scene.used);  // holds a table
  if (!touch(session, std::min(end, session->block.capacity))) return success();
  RETURN_IF_ERROR(build_renderer_unexposed(renderer));
  session->own_exposure = wants_exposure(*renderer) ? 0 : renderer->view.exposure;
  session->built_scene = session->job.scene;
  session->job.stage = after_build(*session);
  return success();
}

// Sets up the codec, and plans the renderer unless it has been built.
Status plan(Session* session, const JobTools& tools, WireError* code) {
  *code = WireError::too_large;
  if (!session->job.is_view_query) RETURN_IF_ERROR(plan_chunks(session));
  const std::uint32_t animation = session->job.request.animation, count = session->job.scene->scene.animations.count;
  if (animation != 0 && animation != kNone && animation >= count) {
    *code = WireError::bad_request;
    return failure("no animation %u: the scene has %u", animation, count);
  }
  if (session->job.request.light_pitch > 0) RETURN_IF_ERROR(check_light_map(*session));
  if (!is_built_for(*session)) return plan_memory(session, tools, code);
  session->job.stage = after_build(*session);
  if (session->own_exposure > 0) return success();
  // Its measurement was abandoned for another request: restart it.
  session->renderer.view.camera = session->own_camera;
  session->renderer.view.camera_overridden = false;
  session->renderer.view.animation = session->renderer.view.framed_animation = 0;
  session->renderer.view.exposure = session->renderer.scene.info.exposure;
  return begin_frame(&session->renderer, {0});
}

// Sets the requested view and time.
Status aim(Session* session) {
  CHECK(session->built_scene == session->job.scene);
  CHECK_GT(session->own_exposure, 0);
  FrameJob* job = &session->job;
  Renderer* renderer = &session->renderer;
  renderer->view.animation = job->request.animation;
  renderer->view.camera = session->own_camera, renderer->view.framed_animation = 0;
  renderer->view.camera_overridden = false;
  if (job->request.camera_stated) RETURN_IF_ERROR(set_camera(renderer, job->request.camera));
  job->stage = JobStage::rows;
  if (job->is_view_query) {
    // Like build_renderer(), but from the camera's position.
    renderer->view.exposure = renderer->scene.info.exposure;
    RETURN_IF_ERROR(begin_frame(renderer, {0}));
    job->stage = JobStage::view_exposure;
    return job->measure_exposure || wants_exposure(*renderer) ? success() : answer_view_query(session);
  }
  renderer->view.exposure = job->request.exposure > 0 ? job->request.exposure : session->own_exposure;
  renderer->settings.tone = job->request.settings.tone;
  const bool has_light = job->request.light_pitch > 0;
  FrameTask task = {job->request.seconds, has_light ? FramePurpose::shared_light : FramePurpose::shared_rows};
  task.rows = {job->request.row_begin, job->request.row_end};
  RETURN_IF_ERROR(begin_frame(renderer, task));
  job->stage = has_light ? JobStage::light : JobStage::search;
  return success();
}

// Traces the next pixels of an exposure, for about `slice_ns`.
Status probe(Session* session, std::uint64_t slice_ns, Slice* slice) {
  CHECK(session->built_scene == session->job.scene);
  const Renderer& renderer = session->renderer;
  std::uint32_t count = slice_pixels(renderer.settings, renderer.lights.points.count, session->probe_ns, slice_ns);
  if (session->probe_ns == 0) count = std::min(count, kFirstPixels);
  *slice = {};
  slice->is_probe = true;
  float exposure = 0;
  bool done = probe_exposure(&session->renderer, &session->job.probe, count, &slice->pixel_count, &exposure);
  slice->traced_count = slice->pixel_count;
  if (!done) return success();
  if (session->job.stage == JobStage::own_exposure) {
    session->own_exposure = exposure;
    session->job.stage = JobStage::aim;
    session->job.probe = ExposureProbe();
    return success();
  }
  session->renderer.view.exposure = exposure;
  return answer_view_query(session);
}

}  // namespace

Status step_job(Session* session, const JobTools& tools, std::uint64_t slice_ns, Slice* slice, WireError* code) {
  CHECK(has_job(*session));
  *slice = {};
  *code = WireError::bad_request;
  switch (session->job.stage) {
    case JobStage::plan:
      return plan(session, tools, code);
    case JobStage::build:
      return build(session);
    case JobStage::aim:
      if (tools.helpers && has_rows(session->job.traced)) tools.helpers->begin(tools.helpers->context, session);
      slice->is_preparation = !session->job.is_view_query;
      return aim(session);
    case JobStage::own_exposure:
    case JobStage::view_exposure:
      return probe(session, slice_ns, slice);
    case JobStage::search:
      if (search_shared_rows(&session->renderer, kSearchPixels))
        session->job.stage = wants_coarse(*session) ? JobStage::coarse : JobStage::rows;
      break;
    case JobStage::coarse:
      *slice = trace_coarse(session, slice_ns);
      break;
    case JobStage::light:
      *slice = trace_light(session, slice_ns);
      break;
    case JobStage::rows:
      CHECK(session->encoder != nullptr && session->built_scene == session->job.scene);
      *slice = tools.helpers ? tools.helpers->trace(tools.helpers->context, session, slice_ns)
                             : trace_slice(session, slice_ns);
      break;
  }
  return success();
}

}  // namespace pocketray
