// Everything on which all pixels of a frame depend, besides the geometry and the values of its lights. If it differs
// from the last frame's, every pixel may.
#pragma once
#include "shade/frame_data.h"

namespace pocketray {

struct FrameSignature {
  bool known = false;
  Quality quality;
  Tone tone = Tone::clip;
  EffectMask mask = 0;
  CameraRays camera;
  MediumStack eye_media;
  Vec3 background, ambient;
  RadianceBounds radiance_bounds;
  float left_out_max = 0;
  IndirectData indirect;
  LightRun runs[4];
  int run_count = 0;
};

FrameSignature signature_of(const FrameData& frame);
// Readable reason why two frames differ as a whole, such as "the camera moved". Null if they do not.
const char* difference(const FrameSignature& a, const FrameSignature& b);

}  // namespace pocketray
