// Renderer: one scene, planned and accelerated in one block of memory, ready to render frames. It allocates nothing.
#pragma once
#include "engine/history.h"
#include "engine/pace.h"
#include "plan/plan_memory.h"
#include "scene/animate.h"
#include "scene/content_hash.h"

namespace pocketray {

struct Timings {
  double build_ms = 0, pose_ms = 0, refit_ms = 0, trace_ms = 0;
};

// Overrides of the scene's look; initially none.
enum class LightChoice { key, sun, none };  // in a scene without lights: default_lights(), default_sun(), ambient alone
// Keep the scene's environment, replace it, or use none.
enum class EnvironmentChoice { as_scene, given, none };
struct Look {
  LightChoice light = LightChoice::key;
  EnvironmentChoice environment = EnvironmentChoice::as_scene;
  bool has_background = false;
  Vec3 background;
  double vertical_fov = 0;  // radians, of every perspective camera; 0: the camera's own
};

// Memory as planned, and its arenas.
struct RendererMemory {
  MemoryPlan plan;
  Arena scene, persistent, frame;
  std::size_t texture_table_bytes = 0;  // in the scene arena, of textures without levels that the scene has
};

struct RendererAccel {
  const AccelInfo* info = nullptr;  // null until the plan chooses it
  bool is_fallback = false;         // the default did not fit
  Accel built;
  Array<std::uint8_t> data;  // writable if geometry moves
};

// Memory for the frame's lights, and what they were placed for.
struct RendererLights {
  Array<LightPoint> points, sample_points;
  std::uint32_t point_count_max = 0;  // planned
  std::uint32_t selected_max = 0;     // likewise if source selection is planned, otherwise 0
  std::uint32_t count_max = 0;        // lights that may be set later; their points are planned
  Array<PointGroup> point_groups;     // groups of area lights' points
  Array<std::uint8_t> point_order, point_place;
  Array<LightPolygon> polygons;
  Array<LightNode> nodes;  // for source selection
  Array<std::uint32_t> order;
  EnvironmentLights* environment = nullptr;  // null: not planned
  Settings lit_settings;                     // the settings that the frame's lights were placed for,
  EffectMask lit_mask = ~EffectMask(0);      // and the effects; ~0: not placed
  Light defaults[2];
};

// Materials that may change between frames; see recolor.h.
struct RendererMaterials {
  bool recolorable = false;      // memory is reserved to change materials
  Array<Material> current;       // the scene's materials, where they may change
  Array<const Material> opened;  // as the scene was opened
};

// The moment and the view that the next frame shows.
struct RendererView {
  Camera camera;
  bool camera_overridden = false;
  std::uint32_t camera_index = 0;
  std::uint32_t animation = 0;  // the one that plays; kNone: the rest pose
  float exposure = 1;
  DefaultView by_default;  // for scenes without cameras or lights
  Framing framing;         // for scenes without cameras: of that animation
  std::uint32_t framed_animation = 0;
  Look look;  // set before plan_renderer()
};

// The threads' working memory; empty parts are not planned.
struct ThreadScratch {
  Array<CellCorner> corners;                   // for selective rendering, two rows per thread
  Array<InterleavedPixel> interleaved_pixels;  // kept_pixel_count() of them per thread
  Array<Vec3> window_pixels;                   // for undersampling or samples at edges, one window per thread
  Array<std::uint8_t> window_states;
  Array<SharedPixel> shared_pixels;
  Array<LightEntry> light_entries;  // search_entry_count() of them per thread
};

struct Renderer {
  Settings settings;
  Scene scene;
  EffectPlan effects;
  RendererMemory memory;
  RendererAccel accel;
  Pose pose;
  RendererLights lights;
  RendererMaterials materials;
  RendererView view;
  FrameData frame;
  Array<Span> spans;            // one per scanline
  Array<std::uint64_t> row_ns;  // cost of each scanline in the last frame
  Array<Vec3> image;            // width × height, linear
  Array<Tracer> tracers;        // one per thread
  ThreadScratch scratch;
  Workers* workers = nullptr;  // null: the caller's thread alone
  History history;
  Pace pace;  // of an emulated device; default: none
  Timings timings;
  Box bounds;  // of all triangles, at time 0
};

// First step: carves the scene arena out of the block, to load the scene into. The caller keeps ownership of the block,
// which must outlive the renderer.
void start_renderer(void* block, std::size_t block_bytes, const Settings& settings, Renderer* renderer);

// Adds the camera and the lights that renderer->scene lacks. plan_renderer() does so, too.
void complete_scene(Renderer* renderer);

// Second step, with renderer->scene set: adds a missing camera and lights, plans effects and memory. On failure the
// plans are filled as far as they got, so that they can be shown. `output` as in plan_memory().
Status plan_renderer(Renderer* renderer, const SceneStorage& loaded, const OutputNeed& output);

// Third step: carves the arenas, builds the accelerator, poses the scene at time 0. Call it only once.
Status build_renderer(Renderer* renderer);

// Replaces the second and third step on a device that only shows frames rendered elsewhere: has memory for the output
// alone and renders nothing. The caller sets camera, exposure, effects and whatever else it uses of the scene.
Status plan_without_scene(Renderer* renderer, const OutputNeed& output);

// Changes the settings that trade accuracy for time for the next frames. Fails and changes nothing if one is out of
// range or needs more memory than planned.
Status change_settings(Renderer* renderer, const Settings& settings);

// Sets the camera for the next frames.
Status set_camera(Renderer* renderer, const Camera& camera);

// Aims the camera of a scene without one at the animation that plays.
void frame_by_default(Renderer* renderer);

// Sums the counters of the last frame over all threads.
Tracer total_counts(const Renderer& renderer);

// Measures exposure on a coarse grid of pixels: the scene's key value becomes middle grey [Reinhard et al. 2002,
// sec. 3.1].
float measure_exposure(Renderer* renderer);

// How the renderer's pictures are displayed.
inline Display display_of(const Renderer& renderer) { return {renderer.view.exposure, renderer.settings.tone}; }

}  // namespace pocketray
