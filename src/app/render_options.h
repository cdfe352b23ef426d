// Options of `pocketray render`, and what they ask for.
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
  std::string format;            // of -o -
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
  std::vector<std::string> paths;  // one per picture, or that of the animation
  std::string kind;                // a path whose ending is the kind of file to write
  AnimationKind animation = AnimationKind::none;
  Aov aov = Aov::none;
  PictureOptions picture;
};

void add_render_options(Command command, RenderOptions* options);
// Refuses what makes no sense, and outputs that cannot be written. Coherence that has no effect becomes "off".
Status read_render_options(RenderOptions* options, RenderRequest* request);

bool moves_camera(const RenderOptions& options);
// How far the camera has orbited, in degrees, after so many frames.
float orbit_after(const RenderOptions& options, std::uint32_t frame_count);
// Whether finished frames are listed, so that --resume can continue the sequence.
bool keeps_journal(const RenderOptions& options, const RenderRequest& request);
// Identifies what the pictures of a sequence show: the scene, version and options that matter, hashed.
std::string identity_of(const RenderOptions& options, const RenderRequest& request, const SceneSource& source,
                        const Renderer& renderer);
double frame_rate(const RenderOptions& options, const SceneInfo& scene);
// Time of a frame, in seconds.
double time_of(const RenderOptions& options, const RenderRequest& request, std::uint32_t frame, const SceneInfo& scene);
// Options that do not do with this scene what their user may expect, a note each.
std::vector<std::string> unexpected(const RenderOptions& options, const RenderRequest& request, const Renderer& renderer);

}  // namespace pocketray
