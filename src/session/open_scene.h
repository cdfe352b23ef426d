// From a scene's name to a renderer that is ready for frames.
#pragma once
#include <functional>
#include <string>

#include "session/scene_options.h"
#include "session/source.h"

namespace pocketray {

// A scene opened for rendering; keeps what must stay alive.
struct OpenScene {
  Renderer renderer;
  SceneSource source;
  void* block = nullptr;
  OpenScene() = default;
  OpenScene(const OpenScene&) = delete;
  OpenScene& operator=(const OpenScene&) = delete;
  ~OpenScene();
};

// What a command adds to opening a scene.
struct OpenHooks {
  std::function<std::size_t(const Settings&)> output_bytes;  // as plan_memory() takes it
  std::function<Status(const std::string& name, Renderer*, SceneSource*, SceneStorage*)> load = load_scene;
  std::function<Status(const SceneSource&, Renderer*)> loaded = {};  // between loading and planning
  std::function<Status(Renderer*, const SceneStorage&, std::size_t output_bytes)> plan = plan_renderer;
};

// Reads the options, loads the scene and plans it. Where it fails for want of memory, opened->source.bytes_wanted says
// so.
Status open_scene(const CommonOptions& options, const OpenHooks& hooks, OpenScene* opened);
// Builds it and starts the threads: ready for render_frame().
Status start_scene(OpenScene* opened, const CommonOptions& options);

// Multiplies; fails where the product is beyond what exposures may be.
Status change_exposure(float factor, float* exposure);

// Prints the warning of a scene and what it was given, one line each, on stderr.
void print_notes(const OpenScene& opened);

}  // namespace pocketray
