#include "engine/renderer.h"

#include <algorithm>

#include "accel/accel_list.h"
#include "base/check.h"
#include "base/color.h"
#include "base/fmath.h"
#include "base/limit_list.h"
#include "brdf/brdf_list.h"
#include "engine/exposure.h"
#include "engine/frame.h"
#include "engine/prepare.h"
#include "engine/recolor.h"
#include "plan/place_light_polygons.h"
#include "plan/plan_effects.h"
#include "plan/plan_lights.h"
#include "plan/plan_scene.h"
#include "plan/radiance_bounds.h"
#include "scene/texture_side.h"
#include "shade/camera.h"
#include "shade/edges.h"
#include "shade/interleaved.h"
#include "shade/point_groups.h"
#include "shade/selective.h"
#include "shade/source_selection.h"

namespace pocketray {

void frame_by_default(Renderer* renderer) {
  RendererView& view = renderer->view;
  const float aspect = static_cast<float>(renderer->settings.width) / static_cast<float>(renderer->settings.height);
  view.framing = find_framing(renderer->scene, view.by_default, renderer->bounds, view.animation);
  view.framed_animation = view.animation;
  view.camera = default_camera(view.by_default, view.framing, renderer->bounds, aspect, view.look.vertical_fov);
}

void complete_scene(Renderer* renderer) {
  CHECK(renderer != nullptr);
  Scene& scene = renderer->scene;
  if (renderer->view.look.has_background || renderer->view.look.environment == EnvironmentChoice::none)
    leave_out_environment(&scene);
  renderer->bounds = scene_bounds(scene);
  const bool has_default_lights = !has_light(scene) || scene.info.default_lights != 0;
  if (scene.cameras.empty() || has_default_lights)
    renderer->view.by_default = find_default_view(scene, renderer->bounds);
  if (scene.cameras.empty()) {
    scene.info.default_camera = 1;
    frame_by_default(renderer);
  } else {
    renderer->view.camera =
        scene.cameras[renderer->view.camera_index < scene.cameras.count ? renderer->view.camera_index : 0];
    if (renderer->view.look.vertical_fov > 0)
      renderer->view.camera.vertical_fov = static_cast<float>(renderer->view.look.vertical_fov);
  }
  if (has_default_lights) {
    scene.info.default_lights = 1;
    scene.info.auto_exposure = 0;
    scene.info.ambient = scene.environment_info.empty() ? default_ambient() : Vec3{0, 0, 0};
    if (is_zero(scene.info.background)) scene.info.background = default_background();
    default_lights(renderer->view.by_default, renderer->bounds, renderer->view.camera, renderer->lights.defaults);
    scene.lights = {renderer->lights.defaults, kDefaultLightCount};
    if (renderer->view.look.light == LightChoice::sun)
      renderer->lights.defaults[0] = default_sun(), scene.lights.count = 1;
    if (renderer->view.look.light == LightChoice::none) scene.lights = {};
    if (scene.environment_info.count)
      for (Light& light : renderer->lights.defaults) light.intensity = light.intensity * kStudioLightShare;
  }
  if (renderer->view.look.has_background) scene.info.background = renderer->view.look.background;
}

namespace {

bool moves(const Renderer& renderer) {
  return has(renderer.effects.mask, Effect::animation) && is_animated(renderer.scene);
}

// Replaces the table of textures by one without levels beyond the settings' side. The scene may be shared with other
// renderers, so the table is a copy.
Status limit_textures(Renderer* renderer) {
  const std::uint32_t side_max = renderer->settings.texture_side_max;
  const Array<const Texture> textures = renderer->scene.textures;
  if (!any_levels_beyond(textures, side_max)) return success();
  const std::size_t bytes = arena_need<Texture>(textures.count);
  if (bytes > arena_free(renderer->memory.scene))
    return failure("the scene's table of textures needs %zu KiB of memory: allow more", bytes / 1024 + 1);
  const Array<Texture> limited = arena_array<Texture>(&renderer->memory.scene, textures.count);
  for (std::uint32_t i = 0; i < textures.count; ++i) limited[i] = without_levels_beyond(textures[i], side_max);
  renderer->scene.textures = limited;
  renderer->memory.texture_table_bytes = bytes;
  return success();
}

Arena take_front(Arena* rest, const char* name, std::size_t bytes) {
  CHECK_LE(bytes, rest->capacity - rest->used);
  Arena arena = make_arena(name, rest->base + rest->used, bytes);
  rest->used += bytes;
  return arena;
}

Status adopt_or_build(Renderer* renderer) {
  renderer->accel.built.positions = renderer->scene.positions;
  renderer->accel.built.triangles = renderer->scene.triangles;
  renderer->accel.built.bounds = renderer->bounds;
  if (moves(*renderer) && !renderer->accel.info->refit) {
    renderer->accel.data = arena_array<std::uint8_t>(&renderer->memory.persistent,
                                                     renderer->accel.info->need(renderer->scene.triangles.count));
    Arena keep = make_arena("accelerator", renderer->accel.data.data, renderer->accel.data.bytes());
    renderer->accel.info->build(&renderer->accel.built, &keep, &renderer->memory.frame);
    return success();
  }
  if (renderer->scene.accel.empty()) {
    renderer->accel.info->build(&renderer->accel.built, &renderer->memory.persistent, &renderer->memory.frame);
    renderer->accel.data = {const_cast<std::uint8_t*>(renderer->accel.built.data.data),
                            renderer->accel.built.data.count};  // lies in our arena
    return success();
  }
  const ParallelLoop loop = loop_over(renderer->workers);
  if (!moves(*renderer)) return renderer->accel.info->adopt(&renderer->accel.built, renderer->scene.accel, loop);
  renderer->accel.data = arena_array<std::uint8_t>(&renderer->memory.persistent, renderer->scene.accel.count);
  __builtin_memcpy(renderer->accel.data.data, renderer->scene.accel.data, renderer->scene.accel.count);
  return renderer->accel.info->adopt(&renderer->accel.built, renderer->accel.data, loop);
}

Status plan_with(Renderer* renderer, const AccelInfo& accel, const SceneStorage& storage, const OutputNeed& output) {
  renderer->accel.info = &accel;
  CoherenceState* coherence = &renderer->history.state;
  SceneStorage stored = storage;
  stored.recolorable = recolorable_count(*renderer);
  Status status = plan_memory(renderer->scene, renderer->settings, renderer->effects, accel, stored,
                              {renderer->lights.points.count, renderer->lights.selected_max}, output,
                              &renderer->memory.plan, &coherence->unplanned_because);
  coherence->planned = !coherence->unplanned_because;
  return status;
}

// Chooses the accelerator and plans the memory with it: the requested one, or the one the scene was baked with, or the
// default; if that does not fit, the first automatic one that does.
Status choose_accel(Renderer* renderer, const SceneStorage& storage, const OutputNeed& output) {
  const AccelInfo* baked = accel_of(renderer->scene.accel);
  if (renderer->accel.info) {
    if (renderer->accel.info != baked) renderer->scene.accel = {};
    return plan_with(renderer, *renderer->accel.info, storage, output);
  }
  const AccelInfo* first = baked ? baked : kAccelList[0];
  Status status = plan_with(renderer, *first, storage, output);
  if (first != kAccelList[0]) return status;
  for (const AccelInfo* info : kAccelList) {
    if (status.ok || info == first || !info->is_automatic) continue;
    renderer->scene.accel = {};
    status = plan_with(renderer, *info, storage, output);
    renderer->accel.is_fallback = status.ok;
  }
  return status;
}

}  // namespace

void start_renderer(void* block, std::size_t block_bytes, const Settings& settings, Renderer* renderer) {
  CHECK(renderer != nullptr);
  renderer->settings = settings;
  renderer->memory.scene = make_arena("scene", block, block_bytes);
  renderer->settings.memory_bytes =
      renderer->memory.scene.capacity;  // aligning the block's start may have lost a few bytes
}

Status plan_renderer(Renderer* renderer, const SceneStorage& loaded, const OutputNeed& output) {
  RETURN_IF_ERROR(validate_settings(renderer->settings));
  RETURN_IF_ERROR(limit_textures(renderer));
  SceneStorage storage = loaded;
  storage.arena_bytes = size_sum(storage.arena_bytes, renderer->memory.texture_table_bytes);
  if (renderer->view.camera_index > 0 && renderer->view.camera_index >= renderer->scene.cameras.count)
    return failure("there is no camera %u: the scene has %u, counted from 0", renderer->view.camera_index,
                   renderer->scene.cameras.count);
  for (const Material& m : renderer->scene.materials)  // the file's program may have had more lobes
    if (m.brdf >= kBrdfCount)
      return failure("a material uses glossy lobe %u, this program has %u: bake the scene again", m.brdf, kBrdfCount);
  complete_scene(renderer);
  renderer->effects = plan_effects(renderer->scene, renderer->settings);
  if (moves(*renderer) && animates_materials(renderer->scene)) renderer->materials.recolorable = true;
  std::uint32_t point_count;
  RETURN_IF_ERROR(light_point_count(renderer->scene, renderer->settings, renderer->effects.mask, &point_count));
  if (renderer->lights.count_max > renderer->scene.lights.count)
    point_count += renderer->lights.count_max - renderer->scene.lights.count;
  renderer->lights.points.count = renderer->lights.point_count_max = point_count;
  const std::uint64_t light_count_max = std::uint64_t(renderer->lights.count_max) + renderer->scene.materials.count;
  const bool may_select =
      renderer->lights.count_max > 0 && renderer->settings.light_tolerance > 0 && light_count_max >= kSelectedLightsMin;
  renderer->lights.selected_max = may_select || has(renderer->effects.mask, Effect::source_selection) ? point_count : 0;
  return choose_accel(renderer, storage, output);
}

Status build_renderer_unexposed(Renderer* renderer) {
  // So far the scene arena spanned the whole block; from here on each arena has exactly its planned size.
  Arena rest = renderer->memory.scene;
  rest.used = arena_need(rest.used);
  renderer->memory.scene.capacity = renderer->memory.scene.used;
  renderer->memory.persistent =
      take_front(&rest, "persistent", renderer->memory.plan.arena_bytes[static_cast<int>(ArenaKind::persistent)]);
  renderer->memory.frame =
      take_front(&rest, "frame", renderer->memory.plan.arena_bytes[static_cast<int>(ArenaKind::frame)]);
  CHECK_LE(rest.used, rest.capacity);

  CHECK(renderer->accel.info != nullptr && renderer->image.empty());  // planned, and not built before
  std::uint64_t start = clock_ns();
  RETURN_IF_ERROR(adopt_or_build(renderer));
  if (moves(*renderer) && renderer->accel.info->refit && renderer->accel.info->settle)
    renderer->accel.info->settle(&renderer->accel.built, renderer->accel.data, renderer->scene.moving_meshes);
  renderer->timings.build_ms = static_cast<double>(clock_ns() - start) * 1e-6;

  if (moves(*renderer)) renderer->pose = make_pose(renderer->scene, &renderer->memory.persistent);
  make_recolorable(renderer);
  const std::size_t used = renderer->memory.persistent.used;
  const EffectMask prepared = prepared_methods(renderer->scene, renderer->settings, renderer->effects.mask);
  renderer->frame.indirect = prepare_indirect(renderer->scene, renderer->settings, prepared,
                                              &renderer->memory.persistent, &renderer->memory.frame);
  CHECK_LE(renderer->memory.persistent.used - used, indirect_need(renderer->scene, renderer->settings, prepared).keep);
  if (plans_environment_lights(renderer->scene, renderer->settings))
    renderer->lights.environment =
        new (arena_array<EnvironmentLights>(&renderer->memory.persistent, 1).data) EnvironmentLights();
  if (renderer->lights.points.count)
    renderer->lights.points = arena_array<LightPoint>(&renderer->memory.persistent, renderer->lights.points.count);
  if (const std::uint32_t points = renderer->memory.plan.planned_for.sample_points)
    renderer->lights.sample_points = arena_array<LightPoint>(&renderer->memory.persistent, points);
  if (has_point_groups(renderer->settings, renderer->effects.mask)) {
    const std::uint32_t points = renderer->lights.point_count_max;
    renderer->lights.point_groups = arena_array<PointGroup>(&renderer->memory.persistent, points);
    renderer->lights.point_order = arena_array<std::uint8_t>(&renderer->memory.persistent, points);
    renderer->lights.point_place = arena_array<std::uint8_t>(&renderer->memory.persistent, points);
  }
  if (const std::uint32_t polygons = light_polygon_count(renderer->scene, renderer->effects.mask))
    renderer->lights.polygons = arena_array<LightPolygon>(&renderer->memory.persistent, polygons);
  if (const std::uint32_t lights = renderer->lights.selected_max) {
    const std::uint32_t entries = renderer->settings.threads * search_entry_count(lights);
    renderer->lights.nodes = arena_array<LightNode>(&renderer->memory.persistent, lights);
    renderer->lights.order = arena_array<std::uint32_t>(&renderer->memory.persistent, lights);
    renderer->scratch.light_entries = arena_array<LightEntry>(&renderer->memory.persistent, entries);
  }
  renderer->tracers = arena_array<Tracer>(&renderer->memory.persistent, renderer->settings.threads);
  if (has(renderer->effects.mask, Effect::selective))
    renderer->scratch.corners =
        arena_array<CellCorner>(&renderer->memory.persistent, selective_corner_count(renderer->settings));
  if (is_interleaved(renderer->effects.mask))
    renderer->scratch.interleaved_pixels = arena_array<InterleavedPixel>(
        &renderer->memory.persistent,
        renderer->settings.threads * kept_pixel_count(renderer->settings, renderer->effects.mask));
  if (plans_window(renderer->settings)) {
    const std::uint32_t count = renderer->settings.threads * window_pixel_count(renderer->settings);
    renderer->scratch.window_pixels = arena_array<Vec3>(&renderer->memory.persistent, count);
    renderer->scratch.window_states = arena_array<std::uint8_t>(&renderer->memory.persistent, count);
    if (keeps_shared_pixels(renderer->settings, renderer->effects.mask))
      renderer->scratch.shared_pixels = arena_array<SharedPixel>(&renderer->memory.persistent, count);
  }
  renderer->spans = arena_array<Span>(&renderer->memory.persistent, renderer->settings.height);
  renderer->row_ns = arena_array_zeroed<std::uint64_t>(&renderer->memory.persistent, renderer->settings.height);
  renderer->image = arena_array_zeroed<Vec3>(
      &renderer->memory.persistent, static_cast<std::size_t>(renderer->settings.width) * renderer->settings.height);
  for (std::uint32_t row = 0; row < renderer->settings.height; ++row)
    renderer->spans[row] = {static_cast<std::uint16_t>(row), 0, static_cast<std::uint16_t>(renderer->settings.width)};
  renderer->view.exposure = renderer->scene.info.exposure;
  RETURN_IF_ERROR(begin_frame(renderer, {0}));
  make_history(renderer);
  return success();
}

bool wants_exposure(const Renderer& renderer) { return renderer.scene.info.auto_exposure != 0; }

Status build_renderer(Renderer* renderer) {
  RETURN_IF_ERROR(build_renderer_unexposed(renderer));
  if (wants_exposure(*renderer)) renderer->view.exposure = measure_exposure(renderer);
  return success();
}

Status plan_without_scene(Renderer* renderer, const OutputNeed& output) {
  RETURN_IF_ERROR(validate_settings(renderer->settings));
  RETURN_IF_ERROR(plan_output_memory(renderer->settings, output, &renderer->memory.plan));
  Arena rest = renderer->memory.scene;
  renderer->memory.scene.capacity = 0;
  renderer->memory.frame =
      take_front(&rest, "frame", renderer->memory.plan.arena_bytes[static_cast<int>(ArenaKind::frame)]);
  return success();
}

Status change_settings(Renderer* renderer, const Settings& settings) {
  const Settings& now = renderer->settings;
  CHECK_EQ(settings.width, now.width);
  CHECK_EQ(settings.height, now.height);
  CHECK_EQ(settings.threads, now.threads);
  CHECK_EQ(settings.texture_side_max, now.texture_side_max);
  CHECK_EQ(settings.forced_on, now.forced_on);
  CHECK_EQ(settings.forced_off, now.forced_off);
  RETURN_IF_ERROR(validate_settings(settings));
  const Scene scene = opened_scene(*renderer);
  EffectPlan effects = plan_effects(scene, settings);
  PlannedFor need;
  RETURN_IF_ERROR(check_planned(scene, renderer->memory.plan.planned_for, settings, effects.mask, &need));
  std::size_t memory_bytes = now.memory_bytes;
  renderer->settings = settings;
  renderer->settings.memory_bytes = memory_bytes;
  renderer->effects = effects;
  renderer->lights.points.count = need.light_points;
  return success();
}

Status set_camera(Renderer* renderer, const Camera& camera) {
  CameraRays rays;
  RETURN_IF_ERROR(make_camera_rays(camera, renderer->settings.width, renderer->settings.height, &rays));
  renderer->view.camera = camera;
  renderer->view.camera_overridden = true;
  return success();
}

Tracer total_counts(const Renderer& renderer) {
  Tracer total;
  for (const Tracer& t : renderer.tracers) {
    for (int kind = 0; kind < kRayKindCount; ++kind) total.rays[kind] += t.rays[kind];
    total.rays_left_out += t.rays_left_out, total.rays_ended += t.rays_ended;
    total.ended_weight_max = std::max(total.ended_weight_max, t.ended_weight_max);
    total.stats.nodes += t.stats.nodes;
    total.stats.triangles += t.stats.triangles;
    total.left_out_max = std::max(total.left_out_max, t.left_out_max);
    total.left_out_share_max = std::max(total.left_out_share_max, t.left_out_share_max);
    total.ended_bound_max = std::max(total.ended_bound_max, t.ended_bound_max);
  }
  return total;
}

bool probe_exposure(Renderer* renderer, ExposureProbe* p, std::uint32_t pixel_count_max, std::uint32_t* pixel_count,
                    float* exposure) {
  CHECK(pixel_count != nullptr && exposure != nullptr);
  forget_last_frame(&renderer->history);  // the probe leaves its pixels in the image
  constexpr float kGrey = 0.18f;          // the key of [Reinhard et al. 2002] sec. 3
  // Chosen: every hundredth pixel, 768 of 320×240. More would delay the first frame, fewer would miss small lights.
  constexpr std::uint32_t kStep = 10;
  auto places = [](std::uint32_t side) { return (side + kStep / 2 - 1) / kStep; };
  std::uint32_t columns = places(renderer->settings.width), count = columns * places(renderer->settings.height),
                begin = p->next;
  FrameData frame = renderer->frame;
  frame.kept.first_hits = nullptr;
  frame.settings.samples_per_pixel = 1;  // pictures of more samples are as bright
  if (frame.mask & kInterpolatingEffects) frame.kernels.trace_strip = nullptr;
  if (has(frame.mask, Effect::edge_sampling)) frame.kernels.trace_strip = frame.kernels.trace_window_strip;
  Tracer tracer = make_tracer(frame);
  tracer.light_entries = renderer->tracers[0].light_entries;
  for (; p->next < count && p->next - begin < pixel_count_max; ++p->next) {
    std::uint32_t row = kStep / 2 + p->next / columns * kStep, column = kStep / 2 + p->next % columns * kStep;
    Span one = {static_cast<std::uint16_t>(row), static_cast<std::uint16_t>(column),
                static_cast<std::uint16_t>(column + 1)};
    const Vec3& pixel = renderer->image[static_cast<std::size_t>(row) * renderer->settings.width + column];
    if (renderer->scene.info.auto_exposure > 1) {
      trace_spans(&tracer, &one, 1, Aov::depth, renderer->image.data);
      if (!(pixel.x > 0)) continue;
    }
    trace_spans(&tracer, &one, 1, Aov::none, renderer->image.data);
    float bright = luminance(pixel);
    if (bright > 0 && std::isfinite(bright)) p->log_sum += det_log(bright), ++p->lit;
  }
  *pixel_count = p->next - begin;
  if (p->next < count) return false;
  const LimitRow& limit = limit_of(Quantity::exposure);
  double measured = p->lit ? kGrey / det_exp(p->log_sum / p->lit) : 1;
  *exposure = static_cast<float>(std::fmin(std::fmax(measured, limit.low), limit.high));
  CHECK(within(Quantity::exposure, *exposure));
  return true;
}

float measure_exposure(Renderer* renderer) {
  ExposureProbe probe;
  std::uint32_t pixel_count;
  float exposure = 1;
  probe_exposure(renderer, &probe, ~0u, &pixel_count, &exposure);
  return exposure;
}

}  // namespace pocketray
