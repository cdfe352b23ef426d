// How a job comes from a request to pixels, a slice of the CPU at a time.
#include <algorithm>
#include <cmath>

#include "effect/setting_list.h"
#include "engine/frame.h"
#include "plan/plan_effects.h"
#include "remote/server/session.h"

namespace pocketray {
namespace {

constexpr std::uint32_t kFirstPixels = 8;               // of an exposure, while nothing is known of what they cost
constexpr std::uint32_t kServerChunkPixels = 1u << 15;  // a chunk is packed and deflated in one go

// As many rows as a chunk of pictures of that shape can have.
std::uint32_t chunk_rows_max(CodecShape shape) {
  shape.chunk_rows_max = std::min(shape.height, std::max(1u, kServerChunkPixels / shape.width));
  while (shape.chunk_rows_max > 1 && !codec_shape_valid(shape)) shape.chunk_rows_max -= shape.chunk_rows_max / 8 + 1;
  return shape.chunk_rows_max;
}

Status make_codec(Session* s) {
  arena_release(&s->block, s->frame_mark);
  s->built_scene = nullptr;  // its renderer lay behind
  std::size_t pixels = std::size_t(s->shape.width) * s->shape.height * pixel_bytes(s->shape.format);
  if (arena_need(pixels) + row_encoder_need(s->shape) > arena_free(s->block))
    return failure("%ux%u pixels take more than the memory of a client", s->shape.width, s->shape.height);
  s->pixels = arena_array<std::uint8_t>(&s->block, pixels);
  Status status = make_row_encoder(s->shape, &s->block, &s->encoder);
  if (!status.ok) s->encoder = nullptr;
  return status;
}

bool same_pixels(const Settings& a, const Settings& b) {
  return a.width == b.width && a.height == b.height && same_quality(a, b) && a.forced_on == b.forced_on &&
         a.forced_off == b.forced_off;
}

bool is_built_for(const Session& s) {
  const FrameRequest& request = s.job.request;
  return s.built_scene == s.job.scene && same_pixels(s.renderer.settings, request.settings) &&
         s.renderer.camera_index == request.camera_index;
}

// Rows of the largest chunk that was asked for, that the codec makes and that the client takes.
std::uint32_t largest_chunk_rows(const Session& s) {
  std::uint32_t rows = s.job.request.chunk_rows_max;
  if (rows > s.shape.chunk_rows_max) rows = s.shape.chunk_rows_max;
  while (rows > 0 && row_chunk_prefix_bytes() + encoded_bytes_max(s.shape, rows) > s.message_bytes_max) --rows;
  return rows;
}

Status plan_chunks(Session* s) {
  if (!s->encoder) {
    s->shape.chunk_rows_max = chunk_rows_max(s->shape);
    if (!codec_shape_valid(s->shape)) return failure("no message can hold a row of it");
    RETURN_IF_ERROR(make_codec(s));
  }
  FrameRequest* request = &s->job.request;
  std::uint16_t rows_max = static_cast<std::uint16_t>(largest_chunk_rows(*s));
  request->chunk_rows_max = rows_max;
  request->chunk_rows = std::min(request->chunk_rows, rows_max);
  return rows_max > 0 ? success() : failure("the client takes no message that could hold a row");
}

// Makes the renderer for the scene and the settings of the job.
Status build(Session* s, const JobTools& tools, WireError* code) {
  s->built_scene = nullptr;
  s->trace_ns = s->probe_ns = 0;
  Renderer* r = &s->renderer;
  *r = Renderer();
  Settings settings = s->job.request.settings;
  settings.threads = tools.thread_count;
  *code = WireError::bad_request;
  RETURN_IF_ERROR(validate_settings(settings));
  const Scene& scene = s->job.scene->scene;
  r->camera_index = s->job.request.camera_index;
  if (r->camera_index > 0 && r->camera_index >= scene.cameras.count)
    return failure("there is no camera %u: the scene has %u", r->camera_index, scene.cameras.count);
  start_renderer(s->block.base + s->block.used, arena_free(s->block), settings, r);
  r->scene = scene;
  *code = WireError::too_large;
  RETURN_IF_ERROR(plan_renderer(r, SceneStorage(), 0));
  s->own_camera = r->camera;
  r->workers = tools.workers;
  *code = WireError::bad_request;
  RETURN_IF_ERROR(build_renderer_unexposed(r));
  s->own_exposure = wants_exposure(*r) ? 0 : r->exposure;
  s->built_scene = s->job.scene;
  return success();
}

// Codec, renderer, and the start of the exposure that the scene wants measured.
Status plan(Session* s, const JobTools& tools, WireError* code) {
  *code = WireError::too_large;
  if (!s->job.is_view_query) RETURN_IF_ERROR(plan_chunks(s));
  bool built = is_built_for(*s);
  if (!built) RETURN_IF_ERROR(build(s, tools, code));
  s->job.stage = s->own_exposure > 0 ? JobStage::aim : JobStage::own_exposure;
  if (s->own_exposure > 0 || !built) return success();
  // Its measuring was given up for another request: from the start.
  s->renderer.camera = s->own_camera;
  s->renderer.camera_overridden = false;
  s->renderer.exposure = s->renderer.scene.info.exposure;
  return prepare_frame(&s->renderer, 0);
}

// The view and the moment that were asked for.
Status aim(Session* s) {
  FrameJob* job = &s->job;
  Renderer* r = &s->renderer;
  r->camera = s->own_camera;
  r->camera_overridden = false;
  if (job->request.camera_stated) RETURN_IF_ERROR(set_camera(r, job->request.camera));
  job->stage = JobStage::rows;
  if (job->is_view_query) {
    // As build_renderer() does, but from where the camera is.
    r->exposure = r->scene.info.exposure;
    RETURN_IF_ERROR(prepare_frame(r, 0));
    job->stage = JobStage::view_exposure;
    return job->measure_exposure || wants_exposure(*r) ? success() : answer_view_query(s);
  }
  r->exposure = job->request.exposure > 0 ? job->request.exposure : s->own_exposure;
  return prepare_frame(r, job->request.seconds);
}

// The next pixels of an exposure, for about `slice_ns`.
Status probe(Session* s, std::uint64_t slice_ns, Slice* slice) {
  const Renderer& r = s->renderer;
  std::uint32_t count = slice_pixels(r.settings, r.light_points.count, s->probe_ns, slice_ns);
  if (s->probe_ns == 0) count = std::min(count, kFirstPixels);
  *slice = {0, 0, 0, true};
  float exposure = 0;
  bool done = probe_exposure(&s->renderer, &s->job.probe, count, &slice->pixel_count, &exposure);
  if (!done) return success();
  if (s->job.stage == JobStage::own_exposure) {
    s->own_exposure = exposure;
    s->job.stage = JobStage::aim;
    s->job.probe = ExposureProbe();
    return success();
  }
  s->renderer.exposure = exposure;
  return answer_view_query(s);
}

}  // namespace

Status step_job(Session* s, const JobTools& tools, std::uint64_t slice_ns, Slice* slice, WireError* code) {
  *slice = {};
  *code = WireError::bad_request;
  switch (s->job.stage) {
    case JobStage::plan:
      return plan(s, tools, code);
    case JobStage::aim:
      return aim(s);
    case JobStage::own_exposure:
    case JobStage::view_exposure:
      return probe(s, slice_ns, slice);
    case JobStage::rows:
      *slice = trace_slice(s, slice_ns);
      break;
  }
  return success();
}

}  // namespace pocketray
