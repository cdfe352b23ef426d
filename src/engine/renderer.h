// Renderer: one scene, planned and accelerated in one block of memory, ready to render frames. It allocates nothing.
#pragma once
#include "engine/coherence_trial.h"
#include "engine/pace.h"
#include "plan/plan_memory.h"
#include "scene/animate.h"
#include "scene/content_hash.h"
#include "shade/trace_spans.h"
#include "temporal/coherence.h"

namespace pocketray {

struct Timings {
  double build_ms = 0, pose_ms = 0, refit_ms = 0, trace_ms = 0;
};

// How the last coherent frame was traced.
struct CoherenceState {
  bool planned = false;
  const char* unplanned_because = "coherence is off";
  const char* whole_because = nullptr;  // why all pixels were traced; null: only those that may have changed
  std::uint64_t pixels_traced = 0;
  ChangeCounts search;  // rays traced to find these
  double follow_ms = 0, find_ms = 0, keep_ms = 0;
  CoherenceTrial trial;  // for CoherenceMode::automatic
};

// The rows of a frame that this renderer may trace; shared_rows.h.
struct SharedRows {
  std::uint32_t begin = 0, end = 0;
  bool records = false;             // the frame is followed
  bool searched = false;            // the search for changes is complete
  std::uint32_t tile_row = 0;       // the next to search
  std::uint32_t known_rows = 0;     // of the last frame ...
  std::uint64_t known_changes = 0;  // ... and pixels to trace in these
  Span parts[2 * kThreadCountMax];  // parts of a row, or rows far apart
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

struct Renderer {
  Settings settings;
  Arena scene_arena, persistent_arena, frame_arena;
  Scene scene;
  EffectPlan effects;
  MemoryPlan memory;
  const AccelInfo* accel_info = nullptr;  // null until the plan chooses it
  bool accel_is_fallback = false;         // the default did not fit
  Accel accel;
  Array<std::uint8_t> accel_data;  // writable if geometry moves
  Pose pose;
  Array<LightPoint> light_points;
  std::uint32_t light_point_count_max = 0;  // planned
  std::uint32_t selected_light_max = 0;     // likewise if source selection is planned, otherwise 0
  Array<PointGroup> point_groups;           // groups of area lights' points
  Array<std::uint8_t> point_order, point_place;
  Array<LightPolygon> light_polygons;
  Array<LightNode> light_nodes;  // for source selection
  Array<std::uint32_t> light_order;
  Array<LightEntry> light_entries;                  // search_entry_count() of them per thread
  std::uint32_t light_count_max = 0;                // lights that may be set later; their points are planned
  bool recolorable = false;                         // memory is reserved to change materials
  Array<Material> materials;                        // the scene's materials, where they may change
  Array<const Material> opened_materials;           // as the scene was opened; see recolor.h
  EnvironmentLights* environment_lights = nullptr;  // null: not planned
  FrameData frame;
  Array<Span> spans;                           // one per scanline
  Array<std::uint64_t> row_ns;                 // cost of each scanline in the last frame
  Array<Tracer> tracers;                       // one per thread
  Array<CellCorner> corners;                   // for selective rendering, two rows per thread; empty: not planned
  Array<InterleavedPixel> interleaved_pixels;  // kept_pixel_count() of them per thread; empty: not planned
  Array<Vec3> window_pixels;                   // for undersampling, one window per thread; empty: not planned
  Array<std::uint8_t> window_states;
  Array<Vec3> image;  // width × height, linear
  Camera camera;
  Settings lit_settings;                 // the settings that the frame's lights were placed for,
  EffectMask lit_mask = ~EffectMask(0);  // and the effects; ~0: not placed
  bool camera_overridden = false;
  std::uint32_t camera_index = 0;
  std::uint32_t animation = 0;  // the one that plays; kNone: the rest pose
  float exposure = 1;
  Timings timings;
  Coherence coherence;  // set up if planned
  CoherenceState coherence_state;
  SharedRows shared_rows;
  Pace pace;                   // of an emulated device; default: none
  Workers* workers = nullptr;  // null: the caller's thread alone
  Light default_lights[2];
  Box bounds;                // of all triangles, at time 0
  DefaultView default_view;  // for scenes without cameras or lights
  Look look;                 // set before plan_renderer()
};

// First step: carves the scene arena out of the block, to load the scene into. The caller keeps ownership of the block,
// which must outlive the renderer.
void start_renderer(void* block, std::size_t block_bytes, const Settings& settings, Renderer* renderer);

// Second step, with renderer->scene set: adds a missing camera and lights, plans effects and memory. On failure the
// plans are filled as far as they got, so that they can be shown. `output` as in plan_memory().
Status plan_renderer(Renderer* renderer, const SceneStorage& storage, const OutputNeed& output);

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

// Sums the counters of the last frame over all threads.
Tracer total_counts(const Renderer& renderer);

// Measures exposure on a coarse grid of pixels: the scene's key value becomes middle grey [Reinhard et al. 2002,
// sec. 3.1].
float measure_exposure(Renderer* renderer);

}  // namespace pocketray
