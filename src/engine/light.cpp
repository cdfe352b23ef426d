// Kernels, lights and camera of a frame.
#include "base/check.h"
#include "base/color.h"
#include "effect/setting_list.h"
#include "engine/prepare.h"
#include "engine/recolor.h"
#include "indirect/surroundings.h"
#include "plan/place_light_polygons.h"
#include "plan/place_light_tree.h"
#include "plan/place_point_groups.h"
#include "plan/place_virtual_lights.h"
#include "plan/plan_lights.h"
#include "plan/radiance_bounds.h"
#include "shade/ambient_gloss.h"
#include "shade/branches.h"
#include "shade/camera.h"
#include "shade/edges.h"
#include "shade/filters.h"
#include "shade/footprint.h"
#include "shade/instances.h"
#include "shade/interleaved.h"
#include "shade/material_maps.h"
#include "shade/media.h"
#include "shade/selective.h"
#include "shade/shade.h"
#include "shade/source_selection.h"
#include "shade/surface.h"
#include "shade/texture.h"
#include "shade/tile_shadows.h"
#include "shade/virtual_light.h"

namespace pocketray {
namespace {

// Returns whether the last frame's lights are still valid: nothing moves, and their inputs are unchanged.
bool is_lit(const Renderer& renderer) {
  return renderer.lights.lit_mask == renderer.effects.mask && !renderer.pose.positions.count &&
         !renderer.pose.lights.count && same_lights(renderer.lights.lit_settings, renderer.settings);
}

// Chosen: a handheld's screen in a lit room reflects about 2.5 % of its own white.
constexpr float kDisplayFlare = 2 * 0.025f;

}  // namespace

void choose_kernels(Renderer* renderer) {
  renderer->frame.scene = &renderer->scene;
  renderer->frame.geometry.accel_info = renderer->accel.info;
  renderer->frame.geometry.first_rays = renderer->accel.info;
  renderer->frame.kept.first_hits = nullptr;
  renderer->frame.kept.compensation_paths = nullptr;
  renderer->frame.geometry.ray_by_ray = false;
  renderer->frame.settings = renderer->settings;
  renderer->frame.mask = renderer->effects.mask;
  renderer->frame.kernels.surface = find_surface_function(renderer->effects.mask);
  renderer->frame.kernels.add_later_light = is_interleaved(renderer->effects.mask) ? add_later_sources : nullptr;
  find_texture_functions(&renderer->frame);
  find_surroundings(&renderer->frame);
  if (renderer->effects.mask & kMapEffects & kEffectsBuilt)
    add_material_maps(&renderer->frame);
  else if (renderer->frame.kernels.surroundings)
    add_surroundings(&renderer->frame);
  renderer->frame.kernels.trace_strip = is_interleaved(renderer->effects.mask)           ? trace_interleaved
                                        : has(renderer->effects.mask, Effect::selective) ? trace_selectively
                                                                                         : nullptr;
  renderer->frame.kernels.trace_window_strip = nullptr;
  const bool has_edges = has(renderer->effects.mask, Effect::edge_sampling);
  if (has_edges || has(renderer->effects.mask, Effect::undersampling)) {
    renderer->frame.kernels.trace_window_strip = renderer->frame.kernels.trace_strip;
    renderer->frame.kernels.trace_strip = has_edges ? trace_edges : trace_lattice;
  }
  renderer->frame.kernels.radiance = find_radiance_function(renderer->effects.mask);
  renderer->frame.kernels.find_shadows = !has(renderer->effects.mask, Effect::shadow)            ? nullptr
                                         : has(renderer->effects.mask, Effect::source_selection) ? find_tile_surfaces
                                                                                                 : find_tile_shadows;
  CHECK(renderer->frame.kernels.surface != nullptr && renderer->frame.kernels.radiance != nullptr);
  make_filters(&renderer->frame);
}

void light_scene(Renderer* renderer) {
  CHECK_GT(renderer->view.exposure, 0);
  CHECK_LE(renderer->lights.points.count, renderer->lights.point_count_max);
  renderer->frame.cut_off.beyond_depth = radiance_beyond_depth(renderer->scene.info, renderer->effects.mask);
  if (has(renderer->effects.mask, Effect::environment_shadow) &&
      renderer->lights.environment->wanted != renderer->settings.environment_shadows)
    place_environment_lights(renderer->scene, renderer->settings.environment_shadows, renderer->lights.environment);
  renderer->frame.environment_lights = renderer->lights.environment;
  if (!is_lit(*renderer)) {
    const Array<const Light> lights =
        renderer->pose.lights.count ? Array<const Light>(renderer->pose.lights) : renderer->scene.lights;
    if (has(renderer->effects.mask, Effect::instant_radiosity) && virtual_lights_of(renderer->frame.indirect)->area < 0)
      measure_walks(renderer->frame, lights, renderer->lights.points);
    place_lights(lights, opened_materials(*renderer), renderer->lights.points, &renderer->frame);
    CHECK_LE(renderer->frame.lights.points.count, renderer->lights.points.count);
    if (has(renderer->effects.mask, Effect::area_light)) {
      place_sample_points(opened_materials(*renderer), renderer->lights.sample_points, &renderer->frame);
      place_point_groups(renderer->lights.point_groups, renderer->lights.point_order, renderer->lights.point_place,
                         &renderer->frame);
      place_light_polygons(opened_materials(*renderer), renderer->lights.polygons, &renderer->frame);
    }
    if (has(renderer->effects.mask, Effect::source_selection))
      place_light_tree(renderer->lights.nodes, renderer->lights.order, &renderer->frame);
    if (has(renderer->effects.mask, Effect::instant_radiosity)) {
      renderer->frame.view.cone = {0, 0};  // belongs to the last frame's camera, which the lights' walks ignore
      place_virtual_lights(&renderer->frame);
    }
    bool spawns = has(renderer->effects.mask, Effect::mirror) || has(renderer->effects.mask, Effect::refraction) ||
                  has(renderer->effects.mask, Effect::alpha_blend);
    renderer->frame.cut_off.radiance_bounds = spawns ? radiance_bounds(renderer->frame) : RadianceBounds{};
    renderer->lights.lit_settings = renderer->settings;
    renderer->lights.lit_mask = renderer->effects.mask;
  }
  if ((renderer->frame.lights.point_groups.groups.count || renderer->frame.lights.polygons.count) &&
      renderer->frame.kernels.find_shadows)
    renderer->frame.kernels.find_shadows = find_lamp_tile_shadows;
  const float white = 1 / renderer->view.exposure;
  renderer->frame.selection = {renderer->settings.selective_contrast, white, kDisplayFlare * white};
  FrameData& frame = renderer->frame;
  frame.cut_off.left_out_max = 2 * kHalfLevel * renderer->settings.cut_off_levels / renderer->view.exposure;
  const bool branches = renderer->settings.ray_depth > 0 && has_branches(opened_scene(*renderer));
  frame.cut_off.left_out_slope = branches ? kLevelSlope * frame.cut_off.left_out_max * renderer->view.exposure : 0;
  CHECK_GE(frame.cut_off.left_out_max, 0);
  frame.cut_off.dark_radiance = kDarkLevels / renderer->view.exposure;
}

void make_tracers(Renderer* renderer) {
  const std::uint32_t corners = renderer->scratch.corners.count / renderer->settings.threads;
  const std::uint32_t pixels = window_pixel_count(renderer->settings);
  for (std::uint32_t i = 0; i < renderer->tracers.count; ++i) {
    renderer->tracers[i] = make_tracer(renderer->frame);
    if (has(renderer->effects.mask, Effect::undersampling) || has(renderer->effects.mask, Effect::edge_sampling)) {
      const ThreadScratch& scratch = renderer->scratch;
      PixelWindow window;
      window.pixels = {&scratch.window_pixels[i * pixels], pixels};
      window.states = {&scratch.window_states[i * pixels], pixels};
      if (keeps_shared_pixels(renderer->settings, renderer->effects.mask))
        window.shared = {&scratch.shared_pixels[i * pixels], pixels};
      keep_window(window, &renderer->tracers[i]);
    }
    const std::uint32_t kept = kept_pixel_count(renderer->settings, renderer->effects.mask);
    if (is_interleaved(renderer->effects.mask) &&
        renderer->scratch.interleaved_pixels.count >= renderer->settings.threads * kept)
      keep_interleaved_pixels({&renderer->scratch.interleaved_pixels[i * kept], kept}, &renderer->tracers[i]);
    if (renderer->scratch.light_entries.count) {
      const std::uint32_t entries = search_entry_count(renderer->lights.selected_max);
      renderer->tracers[i].light_entries = {&renderer->scratch.light_entries[i * entries], entries};
    }
    if (has(renderer->effects.mask, Effect::selective) && corners > 0)
      keep_corner_rows({&renderer->scratch.corners[i * corners], corners}, &renderer->tracers[i]);
  }
}

Status aim_camera(Renderer* renderer) {
  CHECK(renderer->pose.cameras.empty() || renderer->view.camera_index < renderer->pose.cameras.count);
  if (!renderer->view.camera_overridden && renderer->pose.cameras.count) {
    renderer->view.camera = renderer->pose.cameras[renderer->view.camera_index];
    if (renderer->view.look.vertical_fov > 0)
      renderer->view.camera.vertical_fov = static_cast<float>(renderer->view.look.vertical_fov);
  }
  if (!renderer->view.camera_overridden && renderer->view.animation != renderer->view.framed_animation &&
      renderer->scene.cameras.empty() && renderer->scene.framings.count > 1)
    frame_by_default(renderer);
  RETURN_IF_ERROR(make_camera_rays(renderer->view.camera, renderer->settings.width, renderer->settings.height,
                                   &renderer->frame.view.camera));
  if (!renderer->view.camera_overridden && renderer->scene.camera_near.count)
    set_near_plane(renderer->scene.camera_near[renderer->view.camera_index], renderer->frame.geometry.positions,
                   renderer->scene.triangles, &renderer->frame.view.camera);
  if (has(renderer->effects.mask, Effect::mip_map))
    renderer->frame.view.cone = pixel_cone(renderer->frame.view.camera, renderer->settings.samples_per_pixel);
  renderer->frame.view.eye_media = MediumStack();
  if (has(renderer->effects.mask, Effect::refraction))
    renderer->frame.view.eye_media =
        media_at(renderer->frame, near_middle(renderer->frame.view.camera), renderer->frame.view.camera.forward);
  return success();
}

}  // namespace pocketray
