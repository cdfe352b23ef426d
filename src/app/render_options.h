// Options of `pocketray render`, and the resulting request.
#pragma once
#include "app/commands.h"
#include "app/options.h"
#include "session/animation.h"
#include "session/sequence.h"

namespace pocketray {

struct RenderOptions {
  CommonOptions common;
  std::string output = "out.png", frames, aov = "none", raw_format = "rgb565";
  double seconds = 0;
  float orbit_degrees = 0;
  std::uint32_t turntable = 0;
  double frames_per_second = 0;  // 0: the scene's
  std::string format;            // for -o -
  std::string crop;
  bool resume = false, no_legend = false;
  int rotation = 0;
  bool dither = false, plan = false;
  ServersOptions servers;
  OptionalParts parts;
  BudgetOptions budget;
};

struct RenderRequest {
  FrameRange sequence;
  std::vector<std::string> paths;  // one per picture, or the animation's
  std::string kind;                // a path whose suffix is the kind of file to write
  AnimationKind animation = AnimationKind::none;
  Aov aov = Aov::none;
  PictureOptions picture;
};

void add_render_options(Command command, RenderOptions* options);
// Refuses contradictory options, and outputs that cannot be written. Coherence without effect becomes "off".
Status read_render_options(RenderOptions* options, RenderRequest* request);

bool moves_camera(const RenderOptions& options);
// Degrees that the camera has orbited after `frame_count` frames.
float orbit_after(const RenderOptions& options, std::uint32_t frame_count);
// Returns whether finished frames are recorded, so that --resume can continue the sequence.
bool keeps_journal(const RenderOptions& options, const RenderRequest& request);
// Hash of everything that a sequence's pictures depend on: the scene, version and relevant options.
std::string identity_of(const RenderOptions& options, const RenderRequest& request, const SceneSource& source,
                        const Renderer& renderer);
double frame_rate(const RenderOptions& options, const SceneInfo& scene);
// Animation time of a frame, in seconds.
double time_of(const RenderOptions& options, const RenderRequest& request, std::uint32_t frame, const SceneInfo& scene);
// Notes about options that do not do what the user may expect with this scene.
std::vector<std::string> unexpected(const RenderOptions& options, const RenderRequest& request, const Renderer& renderer);

}  // namespace pocketray
