#include "session/open_scene.h"

#include <algorithm>
#include <cstdio>

#include "base/check.h"
#include "base/limit_list.h"
#include "plan/plan_scene.h"
#include "plan/resolve.h"
#include "platform/memory.h"
#include "session/animation_choice.h"
#include "session/baked_file.h"
#include "session/environment.h"
#include "session/focus.h"
#include "session/interrupt.h"
#include "session/note.h"
#include "session/quality_choice.h"
#include "session/radiosity.h"
#include "session/report.h"
#include "session/room_light.h"

namespace pocketray {
namespace {

Status check_outputs_of(const CommonOptions& o, const std::vector<std::string>& files) {
  RETURN_IF_ERROR(check_not_read(files, {{"--json", o.json}}));
  RETURN_IF_ERROR(check_not_read(files, o.outputs));
  return check_folder_not_read(files, o.output_folder);
}

Status set_pace(const CommonOptions& o, Renderer* renderer) {
  const platform::Device* device;
  RETURN_IF_ERROR(find_device(o, &device));
  if (o.emulate.empty()) return success();
  CHECK(device != nullptr);
  CHECK_GE(device->slowdown, 1);
  renderer->pace.slowdown = device->slowdown;
  renderer->pace.device = device->name;
  renderer->pace.stop = &interrupted;
  return success();
}

// Returns the default light added to a scene without light, and the options that change it.
const char* default_light_note(const Scene& scene, LightChoice light) {
  constexpr const char* kAdded[] = {
      "adding a key and a fill light; --light and --environment change that",
      "adding a sun",
      "adding only ambient light",
      "adding a key and a fill light in a studio; --environment none or --background omits the studio",
      "adding a sun over a studio",
      "adding only the light of a studio",
  };
  return kAdded[static_cast<int>(light) + (scene.environment_info.count ? 3 : 0)];
}

}  // namespace

Status check_memory(std::size_t wanted, std::size_t free_bytes) {
  if (free_bytes == 0 || wanted <= free_bytes) return success();
  constexpr double kMebibyte = 1 << 20;
  return failure("--memory is %.1f MiB but the system has only %.1f MiB free: try --memory %zuK",
                 static_cast<double>(wanted) / kMebibyte, static_cast<double>(free_bytes) / kMebibyte,
                 memory_to_take(free_bytes) >> 10);
}

Status change_exposure(float factor, float* exposure) {
  CHECK(exposure != nullptr);
  *exposure *= factor;
  return check_limit(Quantity::exposure, static_cast<double>(*exposure), "the scene's exposure times --exposure");
}

OpenScene::~OpenScene() {
  stop_workers(renderer.workers);
  give_block_back(block);
}

namespace {

// Chosen: more texels than a row of a small screen has pixels. Levels beyond it make way for whatever speeds frames up;
// smaller ones, only for what frames cannot do without.
constexpr std::uint32_t kSpareTextureSide = 512;

// Opens a scene without the levels of textures beyond a side.
Status open_with_textures(const CommonOptions& o, const OpenHooks& hooks, std::uint32_t side_max, OpenScene* opened) {
  Settings settings;
  RETURN_IF_ERROR(read_settings(o, &settings));
  settings.texture_side_max = side_max;
  opened->asked = settings;
  Isa isa;
  RETURN_IF_ERROR(parse_isa(o.isa, &isa));
  select_isa(isa);
  RETURN_IF_ERROR(check_memory(settings.memory_bytes, platform::free_memory()));
  if (!opened->block) opened->block = take_block(settings.memory_bytes);
  if (!opened->block) return failure("cannot get %zu bytes of memory: lower --memory", settings.memory_bytes);
  Renderer* renderer = &opened->renderer;
  start_renderer(opened->block, settings.memory_bytes, settings, renderer);
  RETURN_IF_ERROR(set_pace(o, renderer));
  RETURN_IF_ERROR(parse_look(o, &renderer->view.look));
  renderer->view.camera_index = o.camera_index;
  renderer->accel.info = find_accel(o.accel);
  opened->source.reading = o.reading;
  if (o.animation == kNoAnimation) renderer->view.animation = kNone;
  SceneStorage storage;
  RETURN_IF_ERROR(hooks.load(o.scene, renderer, &opened->source, &storage));
  RETURN_IF_ERROR(find_animation(renderer->scene, o.animation, &renderer->view.animation));
  RETURN_IF_ERROR(set_environment_if_requested(o.environment, renderer, &opened->source, &storage));
  RETURN_IF_ERROR(check_outputs_of(o, opened->source.files));
  RETURN_IF_ERROR(solve_if_requested(o.scene, renderer, &opened->source, &storage));
  const bool is_known = !hooks.is_shared || opened->source.has_all_levels;
  if (settings.indirect == IndirectChoice::automatic && is_known)
    RETURN_IF_ERROR(light_room(o.scene, renderer, &opened->source, &storage));
  RETURN_IF_ERROR(set_quality(o, opened->source, renderer));
  opened->asked = settings = renderer->settings;
  if (hooks.loaded) RETURN_IF_ERROR(hooks.loaded(opened->source, renderer));
  Status planned = hooks.plan(renderer, storage, hooks.output_bytes(settings));
  if (!planned.ok && renderer->memory.plan.total_bytes > renderer->memory.plan.limit_bytes)
    opened->source.bytes_wanted = renderer->memory.plan.total_bytes;
  if (opened->source.bytes_wanted > 0 && !planned.ok)
    return failure("%s: --memory %zuM", planned.message, (opened->source.bytes_wanted >> 20) + 1);
  RETURN_IF_ERROR(planned);
  if (!o.fov.empty() && renderer->view.camera.projection != Projection::perspective)
    return failure("--fov is for perspective cameras, and camera %u is orthographic: drop --fov", o.camera_index);
  if (!o.focus.empty()) {
    RETURN_IF_ERROR(find_part(opened->source, o.scene, o.focus, &opened->source.focus));
    const float aspect = static_cast<float>(settings.width) / static_cast<float>(settings.height);
    const double fov = renderer->view.look.vertical_fov > 0 ? renderer->view.look.vertical_fov : kFramingFieldOfView;
    RETURN_IF_ERROR(set_camera(renderer, focused_camera(renderer->view.camera, opened->source.focus, aspect, fov)));
  }
  if (!o.camera.empty()) {
    Camera camera;
    const Array<const SceneOrigin>& origin = renderer->scene.origin;
    RETURN_IF_ERROR(parse_camera(o.camera, &camera, origin.count ? origin[0] : SceneOrigin{0, 0, 0}));
    RETURN_IF_ERROR(set_camera(renderer, camera));
  }
  return success();
}

// How many parts of a renderer that was planned are slower for want of memory: accelerator, coherence.
int slow_parts(const Renderer& renderer) {
  return int(renderer.accel.is_fallback) + int(renderer.history.state.unplanned_because == kCoherenceTooLarge);
}

// After planning: the longest side of textures with which to try again, or 0.
std::uint32_t smaller_textures(const OpenScene& opened, const Status& planned) {
  const Renderer& renderer = opened.renderer;
  const MemoryPlan& plan = renderer.memory.plan;
  const Array<const Texture> textures = renderer.scene.textures;
  const std::uint32_t side_max = renderer.settings.texture_side_max;
  if (plan.total_bytes == 0 || textures.empty()) return 0;  // not planned
  if (planned.ok) {
    const std::uint32_t smaller = next_smaller_side(textures, side_max);
    return slow_parts(renderer) > 0 && smaller >= kSpareTextureSide ? smaller : 0;
  }
  if (plan.total_bytes <= plan.limit_bytes) return 0;
  const std::uint64_t missing = plan.total_bytes - plan.limit_bytes, kept = kept_texel_bytes(textures, side_max);
  std::uint32_t side = next_smaller_side(textures, side_max);
  while (side > 0 && kept - kept_texel_bytes(textures, side) < missing) side = next_smaller_side(textures, side);
  return side;
}

}  // namespace

Status open_scene(const CommonOptions& o, const OpenHooks& hooks, OpenScene* opened) {
  CHECK(hooks.load && hooks.plan && hooks.output_bytes);
  CHECK(opened->block == nullptr);  // opened once
  opened->texture_side_asked = o.texture_side_max;
  auto open_again = [&](std::uint32_t side_max) {
    opened->renderer = Renderer();
    opened->source = SceneSource();
    return open_with_textures(o, hooks, side_max, opened);
  };
  const Status status = open_with_textures(o, hooks, o.texture_side_max, opened);
  const std::size_t bytes_wanted = opened->source.bytes_wanted;
  Status latest = status;
  std::uint32_t side_max = o.texture_side_max, best_side = 0;  // the largest textures with the fewest slow parts
  for (int fewest = 0;; latest = open_again(side_max)) {
    if (latest.ok && (best_side == 0 || slow_parts(opened->renderer) < fewest))
      best_side = side_max, fewest = slow_parts(opened->renderer);
    const std::uint32_t smaller = smaller_textures(*opened, latest);
    if (smaller == 0) break;
    side_max = smaller;
  }
  if (best_side == 0) {
    opened->source.bytes_wanted = bytes_wanted;
    return status;
  }
  return side_max == best_side ? latest : open_again(best_side);
}

Status start_scene(OpenScene* opened, const CommonOptions& o) {
  CHECK(opened->block != nullptr && opened->renderer.workers == nullptr);
  Renderer* renderer = &opened->renderer;
  renderer->workers = start_workers(renderer->settings.threads);
  ExposureChoice choice;
  float factor;
  RETURN_IF_ERROR(parse_exposure(o.exposure, &choice, &factor));
  float* measured = &renderer->scene.info.auto_exposure;
  if (choice != ExposureChoice::as_scene)
    *measured = choice == ExposureChoice::measured ? std::max(*measured, 1.0f) : 0.0f;
  RETURN_IF_ERROR(build_renderer(renderer));
  return change_exposure(factor, &renderer->view.exposure);
}

namespace {

// "textures up to 512 texels: the block has no room for more; --memory 29M has"
void print_texture_note(const OpenScene& opened) {
  const SceneSource& source = opened.source;
  const Settings& settings = opened.renderer.settings;
  const Scene& scene = opened.renderer.scene;
  if (source.has_all_levels && opened.texture_side_asked != kTextureSideMax && scene.triangles.count)
    print_note(std::string("--texture-max has no effect: ") +
               (scene.textures.empty() ? "the scene has no textures" : "no texture has more texels a side"));
  if (source.has_all_levels || settings.texture_side_max == opened.texture_side_asked) return;
  const std::uint64_t wanted = opened.renderer.memory.plan.total_bytes + source.whole_bytes - source.baked_bytes;
  std::string text =
      "textures up to " + counted(settings.texture_side_max, "texel") + ": the block has no room for more";
  if (wanted < kMemoryBytesMax) text += "; --memory " + std::to_string((wanted >> 20) + 1) + "M has";
  print_note(text);
}

}  // namespace

void print_notes(const OpenScene& opened, const char* aov) {
  if (!opened.source.warning.empty()) print_note(opened.source.warning);
  print_texture_note(opened);
  std::uint32_t threads = worker_thread_count(opened.renderer.workers), asked = opened.renderer.settings.threads;
  if (!opened.renderer.image.empty() && threads < asked)
    std::fprintf(stderr, "pocketray: the system allows only %u of %u threads; continuing with those\n", threads, asked);
  if (opened.renderer.accel.is_fallback)
    std::fprintf(
        stderr,
        "pocketray: the accelerator %s does not fit in --memory; using the slower %s. Raise --memory to use %s\n",
        kAccelList[0]->name, opened.renderer.accel.info->name, kAccelList[0]->name);
  const SceneInfo& info = opened.renderer.scene.info;
  const LightChoice light = opened.renderer.view.look.light;
  const char* added = default_light_note(opened.renderer.scene, light);
  if (info.default_camera != 0 && info.default_lights != 0)
    std::fprintf(stderr, "pocketray: the scene has no camera and no light: framing its bounds, %s\n", added);
  else if (info.default_camera != 0)
    std::fprintf(stderr, "pocketray: the scene has no camera: framing its bounds\n");
  else if (info.default_lights != 0)
    std::fprintf(stderr, "pocketray: the scene has no light: %s\n", added);
  if (opened.source.has_fill && opened.renderer.scene.environment_info.count)
    std::fprintf(stderr,
                 "pocketray: the model has lights but no surroundings: adding a dimmed studio; "
                 "--environment none or --background omits it\n");
  if (info.default_lights == 0 && light != LightChoice::key)
    std::fprintf(stderr, "pocketray: --light changes nothing: the scene or its environment has light\n");
  const Renderer& renderer = opened.renderer;
  if (renderer.scene.triangles.empty()) return;  // a server has the scene
  const Notes notes =
      find_requests_without_effect(renderer.scene, {opened.asked, renderer.history.state.unplanned_because, aov});
  for (int i = 0; i < notes.count; ++i) print_note(notes.text[i]);
}

}  // namespace pocketray
