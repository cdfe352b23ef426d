#include "engine/last_picture.h"

#include <algorithm>

#include "base/check.h"
#include "shade/carried.h"
#include "shade/lattice.h"

namespace pocketray {
namespace {

// What the picture's pixels depend on besides the camera, whichever of them are traced.
FrameSignature signature_now(const Renderer& renderer) {
  FrameSignature s = signature_of(renderer.frame);
  s.quality.resolution = Resolution::full, s.quality.selective_contrast = 0;
  s.quality.moving_contrast = MovingContrast::as_resting;
  s.mask &= ~(bit(Effect::undersampling) | bit(Effect::selective));
  return s;
}

bool same_scene(const SceneNow& a, const SceneNow& b) {
  return a.lights == b.lights && a.positions == b.positions && a.normals == b.normals;
}

// What moves besides the camera.
SceneNow scene_now(const Renderer& renderer) {
  const FrameData& frame = renderer.frame;
  SceneNow now;
  now.lights = content_hash(frame.lights.data, frame.lights.bytes());
  if (renderer.pose.positions.count) now.positions = content_hash(frame.positions.data, frame.positions.bytes());
  if (renderer.pose.normals.count) now.normals = content_hash(frame.normals.data, frame.normals.bytes());
  return now;
}

}  // namespace

void make_last_picture(Renderer* renderer) {
  const Settings& settings = renderer->settings;
  LastPictureState* state = &renderer->last_picture;
  state->is_planned = plans_last_picture(settings);
  if (!state->is_planned) return;
  if (plans_last_pixels(settings)) {
    state->pixels = arena_array<Vec3>(&renderer->persistent_arena, renderer->image.count);
    state->steps = arena_array<Vec2>(&renderer->persistent_arena, settings.threads * window_pixel_count(settings));
  }
  if (const std::uint32_t count = kept_position_count(renderer->scene, renderer->effects.mask))
    state->positions = arena_array<Vec3>(&renderer->persistent_arena, count);
  set_motion_tolerance(static_cast<double>(settings.pixels_per_degree),
                       static_cast<double>(renderer->scene.info.frames_per_second), &state->tolerance);
}

void forget_picture(Renderer* renderer) { renderer->last_picture.is_known = false; }

void follow_picture(Renderer* renderer) {
  LastPictureState* state = &renderer->last_picture;
  FrameData* frame = &renderer->frame;
  if (!state->is_planned) return;
  state->signature_now = signature_now(*renderer);
  state->scene_now = scene_now(*renderer);
  const Settings& settings = renderer->settings;
  const bool interleaves =
      has(renderer->effects.mask, Effect::undersampling) && settings.resolution == Resolution::interleaved;
  const bool sees_motion = settings.moving_contrast == MovingContrast::as_seen;
  if (!interleaves && !sees_motion) return;
  LastPicture* last = &state->last;
  *last = LastPicture();
  last->camera = state->signature.camera;
  last->tolerance = &state->tolerance;
  FrameSignature moved = state->signature;
  moved.camera = state->signature_now.camera;
  bool is_still = false;
  if (state->is_known && !difference(moved, state->signature_now)) {
    last->is_known = true;
    last->positions = state->positions.count ? Array<const Vec3>(state->positions) : frame->positions;
    is_still = !difference(state->signature, state->signature_now) && same_scene(state->scene, state->scene_now);
  }
  if (interleaves && last->is_known && state->is_whole) {
    last->pixels = state->pixels;
    last->parity = 1 - state->parity;
    last->rests = is_still && state->exposure == renderer->exposure &&
                  (state->contrast == 0 || (state->is_still && state->contrast == settings.selective_contrast));
  }
  state->is_still_now = is_still || !last->is_known || !sees_motion;
  frame->last = last;
  // The hits of interpolated pixels are not known.
  if (last->pixels.empty() || frame->trace_lattice_strip) return;
  frame->first_hits = &state->unused;
  const std::uint32_t pixels = window_pixel_count(settings);
  for (std::uint32_t i = 0; i < renderer->tracers.count; ++i)
    renderer->tracers[i].window.steps = {&state->steps[i * pixels], pixels};
}

void keep_picture(Renderer* renderer) {
  LastPictureState* state = &renderer->last_picture;
  const FrameData& frame = renderer->frame;
  if (!state->is_planned) return;
  const bool all = !has(renderer->effects.mask, Effect::undersampling);
  const bool interleaves = frame.last && frame.settings.resolution == Resolution::interleaved;
  state->is_known = true;
  state->is_whole = state->pixels.count > 0 && (all || interleaves);
  if (state->is_whole) {
    CHECK_EQ(state->pixels.count, renderer->image.count);
    std::copy(renderer->image.begin(), renderer->image.end(), state->pixels.begin());
  }
  if (state->positions.count)
    std::copy(frame.positions.data, frame.positions.data + frame.positions.count, state->positions.data);
  state->signature = state->signature_now;
  state->scene = state->scene_now;
  state->exposure = renderer->exposure;
  state->contrast = has(renderer->effects.mask, Effect::selective) ? frame.settings.selective_contrast : 0;
  state->parity = interleaves ? frame.last->parity : 0;
  state->is_still = !frame.last || state->is_still_now;
  if (frame.first_hits == &state->unused) renderer->frame.first_hits = nullptr;
}

}  // namespace pocketray
