// Opens a scene by name and makes a renderer ready for it.
#pragma once
#include <functional>
#include <string>

#include "session/scene_options.h"
#include "session/source.h"

namespace pocketray {

// A scene opened for rendering; owns everything that the renderer refers to.
struct OpenScene {
  Renderer renderer;
  SceneSource source;
  Settings asked;  // by the command line, before a budget chooses
  std::uint32_t texture_side_asked = kTextureSideMax;
  void* block = nullptr;
  OpenScene() = default;
  OpenScene(const OpenScene&) = delete;
  OpenScene& operator=(const OpenScene&) = delete;
  ~OpenScene();
};

// A command's additions to opening a scene.
struct OpenHooks {
  std::function<OutputNeed(const Settings&)> output_bytes;  // as passed to plan_memory()
  // With servers: they know the scene only as its source has it, or with the light of all its levels of textures.
  bool is_shared = false;
  std::function<Status(const std::string& name, Renderer*, SceneSource*, SceneStorage*)> load = load_scene;
  std::function<Status(const SceneSource&, Renderer*)> loaded = {};  // between loading and planning
  std::function<Status(Renderer*, const SceneStorage&, const OutputNeed& output)> plan = plan_renderer;
};

// Fails if the system cannot provide a block of `wanted` bytes: using it would make the system kill the program.
// `free_bytes`: from platform::free_memory().
Status check_memory(std::size_t wanted, std::size_t free_bytes);
// Reads the options, loads the scene and plans it. If memory is short, fails with opened->source.bytes_wanted set.
Status open_scene(const CommonOptions& options, const OpenHooks& hooks, OpenScene* opened);
// Builds the accelerator and starts the threads, ready for render_frame().
Status start_scene(OpenScene* opened, const CommonOptions& options);

// Bounds of what the camera turns around.
inline const Box& subject_of(const OpenScene& opened) {
  return is_empty(opened.source.focus) ? opened.renderer.accel.built.bounds : opened.source.focus;
}

// Multiplies *exposure; fails if the product is out of range.
Status change_exposure(float factor, float* exposure);

// Prints the scene's warning and the defaults that were added, one line each, on stderr.
void print_notes(const OpenScene& opened, const char* aov = nullptr);

}  // namespace pocketray
