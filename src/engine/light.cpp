// Kernels, lights and camera of a frame.
#include "base/color.h"
#include "effect/setting_list.h"
#include "engine/prepare.h"
#include "plan/plan_lights.h"
#include "shade/camera.h"
#include "shade/filters.h"
#include "shade/media.h"
#include "shade/shade.h"
#include "shade/surface.h"
#include "shade/tile_shadows.h"

namespace pocketray {
namespace {

// Whether the lights of the last frame are this one's, too: nothing moves, and nothing that they follow from has
// changed.
bool is_lit(const Renderer& r) {
  return r.lit_mask == r.effects.mask && !r.pose.positions.count && !r.pose.lights.count &&
         same_lights(r.lit_settings, r.settings);
}

}  // namespace

void choose_kernels(Renderer* r) {
  r->frame.scene = &r->scene;
  r->frame.accel_info = r->accel_info;
  r->frame.settings = r->settings;
  r->frame.mask = r->effects.mask;
  r->frame.surface = find_surface_function(r->effects.mask);
  r->frame.radiance = find_radiance_function(r->effects.mask);
  r->frame.find_shadows = has(r->effects.mask, Effect::shadow) ? find_tile_shadows : nullptr;
  make_filters(&r->frame);
}

void light_scene(Renderer* r) {
  if (!is_lit(*r)) {
    place_lights(r->pose.lights.count ? Array<const Light>(r->pose.lights) : r->scene.lights, r->light_points,
                 &r->frame);
    bool spawns = has(r->effects.mask, Effect::mirror) || has(r->effects.mask, Effect::refraction) ||
                  has(r->effects.mask, Effect::alpha_blend);
    r->frame.radiance_bound = spawns ? radiance_bound(r->frame) : 0;
    r->lit_settings = r->settings;
    r->lit_mask = r->effects.mask;
  }
  r->frame.left_out_max = 2 * kHalfLevel * r->settings.cut_off_levels / r->exposure;
}

Status aim_camera(Renderer* r) {
  if (!r->camera_overridden && r->pose.cameras.count) r->camera = r->pose.cameras[r->camera_index];
  RETURN_IF_ERROR(make_camera_rays(r->camera, r->settings.width, r->settings.height, &r->frame.camera));
  r->frame.eye_media = MediumStack();
  if (has(r->effects.mask, Effect::refraction))
    r->frame.eye_media = media_at(r->frame, r->frame.camera.eye, r->frame.camera.forward);
  return success();
}

}  // namespace pocketray
