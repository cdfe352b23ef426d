// Everything trace_spans() reads. Filled by plan/ and engine/, constant while threads run.
#pragma once
#include "accel/accel.h"
#include "effect/effect.h"
#include "effect/settings.h"
#include "indirect/environment_lights.h"
#include "indirect/indirect_list.h"
#include "scene/scene.h"
#include "shade/cut_off.h"
#include "shade/footprints.h"
#include "shade/frame_lights.h"
#include "shade/kernels.h"
#include "shade/ray_filters.h"
#include "shade/view.h"

namespace pocketray {

struct KeptPath;

// The posed scene's triangles.
struct Geometry {
  Array<const Vec3> positions, normals;
  const AccelInfo* accel_info = nullptr;
  const AccelTraversal* first_rays = nullptr;  // for camera rays and shadow rays from first hits
  Accel accel;
  bool ray_by_ray = false;  // no packets
};

// Thresholds for the pixels that selective rendering interpolates; selective.h.
struct Selection {
  float contrast = 0;          // Michelson, as displayed; lower contrast is invisible. 0: every pixel is traced
  float white = 0, flare = 0;  // radiances: that of exposure 1, and twice what the display reflects
};

// Rays that are kept for later, width × height per sample; null: not kept.
struct KeptRays {
  Hit* first_hits = nullptr;
  KeptPath* compensation_paths = nullptr;  // compensation's rays, see compensation.h
};

struct FrameData {
  const Scene* scene = nullptr;
  Geometry geometry;
  View view;
  Lights lights;
  Settings settings;
  EffectMask mask = 0;
  Kernels kernels;
  RayFilters filters;
  CutOff cut_off;
  Selection selection;
  IndirectData indirect;
  const EnvironmentLights* environment_lights = nullptr;  // set with Effect::environment_shadow
  KeptRays kept;
};

// Filter for camera and secondary rays; null without cutouts.
inline const HitFilter* visible_filter(const FrameData& frame) {
  return frame.filters.visible.accept ? &frame.filters.visible : nullptr;
}

}  // namespace pocketray
