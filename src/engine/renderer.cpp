#include "engine/renderer.h"

#include "accel/accel_list.h"
#include "base/check.h"
#include "base/color.h"
#include "base/fmath.h"
#include "base/limit_list.h"
#include "brdf/brdf_list.h"
#include "engine/exposure.h"
#include "engine/frame.h"
#include "plan/plan_effects.h"
#include "plan/plan_lights.h"
#include "plan/plan_scene.h"
#include "shade/camera.h"

namespace pocketray {
namespace {

void add_what_is_missing(Renderer* r) {
  Scene& scene = r->scene;
  float aspect = static_cast<float>(r->settings.width) / static_cast<float>(r->settings.height);
  if (scene.cameras.empty()) {
    scene.info.default_camera = 1;
    r->camera = default_camera(scene, aspect);
  } else {
    r->camera = scene.cameras[r->camera_index < scene.cameras.count ? r->camera_index : 0];
  }
  if (!has_light(scene) || scene.info.default_lights != 0) {
    scene.info.default_lights = 1;
    scene.info.auto_exposure = 0;
    scene.info.ambient = default_ambient();
    if (is_zero(scene.info.background)) scene.info.background = default_background();
    default_lights(scene, r->camera, r->default_lights);
    scene.lights = {r->default_lights, kDefaultLightCount};
  }
}

bool moves(const Renderer& r) { return has(r.effects.mask, Effect::animation) && is_animated(r.scene); }

Arena take_front(Arena* rest, const char* name, std::size_t bytes) {
  Arena arena = make_arena(name, rest->base + rest->used, bytes);
  rest->used += bytes;
  return arena;
}

Status adopt_or_build(Renderer* r) {
  r->accel.positions = r->scene.positions;
  r->accel.triangles = r->scene.triangles;
  r->accel.bounds = scene_bounds(r->scene);
  if (moves(*r) && !r->accel_info->refit) {
    r->accel_data = arena_array<std::uint8_t>(&r->persistent_arena, r->accel_info->need(r->scene.triangles.count));
    Arena keep = make_arena("accelerator", r->accel_data.data, r->accel_data.bytes());
    r->accel_info->build(&r->accel, &keep, &r->frame_arena);
    return success();
  }
  if (r->scene.accel.empty()) {
    r->accel_info->build(&r->accel, &r->persistent_arena, &r->frame_arena);
    r->accel_data = {const_cast<std::uint8_t*>(r->accel.data.data), r->accel.data.count};  // lies in our arena
    return success();
  }
  if (!moves(*r)) return r->accel_info->adopt(&r->accel, r->scene.accel);
  r->accel_data = arena_array<std::uint8_t>(&r->persistent_arena, r->scene.accel.count);
  __builtin_memcpy(r->accel_data.data, r->scene.accel.data, r->scene.accel.count);
  return r->accel_info->adopt(&r->accel, r->accel_data);
}

Status plan_with(Renderer* r, const AccelInfo& accel, const SceneStorage& storage, std::size_t output_bytes) {
  r->accel_info = &accel;
  return plan_memory(r->scene, r->settings, r->effects, accel, storage, r->light_points.count, output_bytes,
                     &r->memory);
}

// Settles the accelerator and plans the memory with it: what was asked for, else what the scene was baked with, else
// the default, else, where that does not fit, the first automatic one that does.
Status choose_accel(Renderer* r, const SceneStorage& storage, std::size_t output_bytes) {
  const AccelInfo* baked = accel_of(r->scene.accel);
  if (r->accel_info) {
    if (r->accel_info != baked) r->scene.accel = {};
    return plan_with(r, *r->accel_info, storage, output_bytes);
  }
  const AccelInfo* first = baked ? baked : kAccelList[0];
  Status status = plan_with(r, *first, storage, output_bytes);
  if (first != kAccelList[0]) return status;
  for (const AccelInfo* info : kAccelList) {
    if (status.ok || info == first || !info->is_automatic) continue;
    r->scene.accel = {};
    status = plan_with(r, *info, storage, output_bytes);
    r->accel_is_fallback = status.ok;
  }
  return status;
}

}  // namespace

void start_renderer(void* block, std::size_t block_bytes, const Settings& settings, Renderer* r) {
  r->settings = settings;
  r->scene_arena = make_arena("scene", block, block_bytes);
  r->settings.memory_bytes = r->scene_arena.capacity;  // aligning the block's start may have cost a few bytes
}

Status plan_renderer(Renderer* r, const SceneStorage& storage, std::size_t output_bytes) {
  RETURN_IF_ERROR(validate_settings(r->settings));
  if (r->camera_index > 0 && r->camera_index >= r->scene.cameras.count)
    return failure("there is no camera %u: the scene has %u", r->camera_index, r->scene.cameras.count);
  for (const Material& m : r->scene.materials)  // a file may come from a program with more lobes
    if (m.brdf >= kBrdfCount)
      return failure("a material uses glossy lobe %u and this program has %u: bake the scene again", m.brdf,
                     kBrdfCount);
  add_what_is_missing(r);
  r->effects = plan_effects(r->scene, r->settings);
  std::uint32_t point_count;
  RETURN_IF_ERROR(light_point_count(r->scene, r->settings, r->effects.mask, &point_count));
  if (r->light_count_max > r->scene.lights.count) point_count += r->light_count_max - r->scene.lights.count;
  r->light_points.count = r->light_point_count_max = point_count;
  return choose_accel(r, storage, output_bytes);
}

Status build_renderer_unexposed(Renderer* r) {
  // The scene arena so far reached over the whole block; from here on each arena has just what was planned for it.
  Arena rest = r->scene_arena;
  rest.used = arena_need(rest.used);
  r->scene_arena.capacity = r->scene_arena.used;
  r->persistent_arena = take_front(&rest, "persistent", r->memory.arena_bytes[static_cast<int>(ArenaKind::persistent)]);
  r->frame_arena = take_front(&rest, "frame", r->memory.arena_bytes[static_cast<int>(ArenaKind::frame)]);
  CHECK_LE(rest.used, rest.capacity);

  std::uint64_t start = clock_ns();
  RETURN_IF_ERROR(adopt_or_build(r));
  r->timings.build_ms = static_cast<double>(clock_ns() - start) * 1e-6;

  if (moves(*r)) r->pose = make_pose(r->scene, &r->persistent_arena);
  r->frame.indirect = prepare_indirect(r->scene, r->effects.mask, &r->persistent_arena);
  if (r->light_points.count) r->light_points = arena_array<LightPoint>(&r->persistent_arena, r->light_points.count);
  r->tracers = arena_array<Tracer>(&r->persistent_arena, r->settings.threads);
  r->spans = arena_array<Span>(&r->persistent_arena, r->settings.height);
  r->row_ns = arena_array_zeroed<std::uint64_t>(&r->persistent_arena, r->settings.height);
  r->image =
      arena_array_zeroed<Vec3>(&r->persistent_arena, static_cast<std::size_t>(r->settings.width) * r->settings.height);
  for (std::uint32_t row = 0; row < r->settings.height; ++row)
    r->spans[row] = {static_cast<std::uint16_t>(row), 0, static_cast<std::uint16_t>(r->settings.width)};
  r->exposure = r->scene.info.exposure;
  return prepare_frame(r, 0);
}

bool wants_exposure(const Renderer& r) { return r.scene.info.auto_exposure != 0; }

Status build_renderer(Renderer* r) {
  RETURN_IF_ERROR(build_renderer_unexposed(r));
  if (wants_exposure(*r)) r->exposure = measure_exposure(r);
  return success();
}

Status plan_without_scene(Renderer* r, std::size_t output_bytes) {
  RETURN_IF_ERROR(validate_settings(r->settings));
  RETURN_IF_ERROR(plan_output_memory(r->settings, output_bytes, &r->memory));
  Arena rest = r->scene_arena;
  r->scene_arena.capacity = 0;
  r->frame_arena = take_front(&rest, "frame", r->memory.arena_bytes[static_cast<int>(ArenaKind::frame)]);
  return success();
}

Status change_settings(Renderer* r, const Settings& settings) {
  const Settings& now = r->settings;
  CHECK_EQ(settings.width, now.width);
  CHECK_EQ(settings.height, now.height);
  CHECK_EQ(settings.threads, now.threads);
  CHECK_EQ(settings.forced_on, now.forced_on);
  CHECK_EQ(settings.forced_off, now.forced_off);
  RETURN_IF_ERROR(validate_settings(settings));
  EffectPlan effects = plan_effects(r->scene, settings);
  std::uint32_t point_count;
  RETURN_IF_ERROR(light_point_count(r->scene, settings, effects.mask, &point_count));
  if (point_count > r->light_point_count_max)
    return failure("the lights would take %u points and memory was planned for %u: plan with that many", point_count,
                   r->light_point_count_max);
  std::size_t memory_bytes = now.memory_bytes;
  r->settings = settings;
  r->settings.memory_bytes = memory_bytes;
  r->effects = effects;
  r->light_points.count = point_count;
  return success();
}

Status set_camera(Renderer* r, const Camera& camera) {
  CameraRays rays;
  RETURN_IF_ERROR(make_camera_rays(camera, r->settings.width, r->settings.height, &rays));
  r->camera = camera;
  r->camera_overridden = true;
  return success();
}

Tracer total_counts(const Renderer& r) {
  Tracer total;
  for (const Tracer& t : r.tracers) {
    for (int kind = 0; kind < kRayKindCount; ++kind) total.rays[kind] += t.rays[kind];
    total.rays_left_out += t.rays_left_out;
    total.stats.nodes += t.stats.nodes;
    total.stats.triangles += t.stats.triangles;
    if (t.left_out_max > total.left_out_max) total.left_out_max = t.left_out_max;
  }
  return total;
}

bool probe_exposure(Renderer* r, ExposureProbe* p, std::uint32_t pixel_count_max, std::uint32_t* pixel_count,
                    float* exposure) {
  constexpr float kGrey = 0.18f;
  constexpr std::uint32_t kStep = 10;
  auto places = [](std::uint32_t side) { return (side + kStep / 2 - 1) / kStep; };
  std::uint32_t columns = places(r->settings.width), count = columns * places(r->settings.height), begin = p->next;
  Tracer tracer = make_tracer(r->frame);
  for (; p->next < count && p->next - begin < pixel_count_max; ++p->next) {
    std::uint32_t row = kStep / 2 + p->next / columns * kStep, column = kStep / 2 + p->next % columns * kStep;
    Span one = {static_cast<std::uint16_t>(row), static_cast<std::uint16_t>(column),
                static_cast<std::uint16_t>(column + 1)};
    trace_spans(&tracer, &one, 1, Aov::none, r->image.data);
    float bright = luminance(r->image[static_cast<std::size_t>(row) * r->settings.width + column]);
    if (bright > 0 && std::isfinite(bright)) p->log_sum += det_log(bright), ++p->lit;
  }
  *pixel_count = p->next - begin;
  if (p->next < count) return false;
  const LimitRow& limit = limit_of(Quantity::exposure);
  double measured = p->lit ? kGrey / det_exp(p->log_sum / p->lit) : 1;
  *exposure = static_cast<float>(std::fmin(std::fmax(measured, limit.low), limit.high));
  return true;
}

float measure_exposure(Renderer* r) {
  ExposureProbe probe;
  std::uint32_t pixel_count;
  float exposure = 1;
  probe_exposure(r, &probe, ~0u, &pixel_count, &exposure);
  return exposure;
}

}  // namespace pocketray
