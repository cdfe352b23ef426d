#include "temporal/frame_signature.h"

#include <algorithm>

#include "effect/setting_list.h"

namespace pocketray {
namespace {

bool same_camera(const CameraRays& a, const CameraRays& b) {
  return a.eye == b.eye && a.forward == b.forward && a.right == b.right && a.up == b.up && a.width == b.width &&
         a.height == b.height && a.near_distance == b.near_distance && a.orthographic == b.orthographic;
}

bool same_media(const MediumStack& a, const MediumStack& b) {
  return a.depth == b.depth && std::equal(a.material, a.material + a.depth, b.material);
}

bool same_runs(const FrameSignature& a, const FrameSignature& b) {
  return a.run_count == b.run_count && std::equal(a.runs, a.runs + a.run_count, b.runs, [](auto& x, auto& y) {
           return x.begin == y.begin && x.end == y.end && x.sample == y.sample;
         });
}

}  // namespace

FrameSignature signature_of(const FrameData& frame) {
  FrameSignature s;
  s.known = true;
  s.quality = frame.settings, s.tone = frame.settings.tone;
  s.mask = frame.mask;
  s.camera = frame.view.camera;
  s.eye_media = frame.view.eye_media;
  s.background = frame.scene->info.background;
  s.ambient = frame.scene->info.ambient;
  s.radiance_bounds = frame.cut_off.radiance_bounds;
  s.left_out_max = frame.cut_off.left_out_max;
  s.indirect = frame.indirect;
  s.run_count = frame.lights.run_count;
  std::copy(frame.lights.runs, frame.lights.runs + frame.lights.run_count, s.runs);
  return s;
}

const char* difference(const FrameSignature& a, const FrameSignature& b) {
  if (!a.known || !b.known) return "no previous frame";
  if (!same_camera(a.camera, b.camera)) return "the camera moved";
  if (!same_quality(a.quality, b.quality) || a.mask != b.mask || a.tone != b.tone) return "the settings changed";
  if (a.left_out_max != b.left_out_max) return "the exposure changed";
  if (a.background != b.background || a.ambient != b.ambient ||
      !std::equal(a.indirect.prepared, a.indirect.prepared + IndirectList::kCount, b.indirect.prepared))
    return "the surroundings changed";
  if (!same_runs(a, b)) return "lights were added or removed";
  if (!same_media(a.eye_media, b.eye_media)) return "the camera entered or left a body";
  if (a.radiance_bounds != b.radiance_bounds) return "the brightest light on a surface changed";
  return nullptr;
}

}  // namespace pocketray
