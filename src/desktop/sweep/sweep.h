// Measures a sweep: opens the scene with memory for its most expensive configuration, renders references, times all
// configurations in turn and compares their pictures with the reference. accuracy/sweep_plan.h plans the
// configurations.
#pragma once
#include "desktop/accuracy/flip.h"
#include "desktop/accuracy/sum_up.h"
#include "desktop/reference/reference.h"
#include "desktop/sweep/front.h"
#include "desktop/sweep/state.h"
#include "session/open_scene.h"
#include "session/progress.h"
#include "session/team.h"

namespace pocketray {

struct AccuracyOptions {
  CommonOptions common;
  std::string folder, output = kOutputFormats[Configuration().output].name, reference = "physical";
  std::string reference_file;           // of the judge's reference; empty: it is rendered
  std::uint32_t reference_samples = 0;  // per pixel of the judge's reference, both halves together; 0: the default
  std::uint32_t rounds = 15;
  double pixels_per_degree = kHandheldPixelsPerDegree, seconds = 0, price_limit = 16;
  bool restart = false;
  bool bakes = false;  // also vary what `bake` stores
  bool starts_valgrind =
      false;                 // if the CPU counts no instructions; only in a program started as `pocketray accuracy …`
  double save_seconds = 60;  // between saves of a running reference
  std::function<void(std::uint32_t)> row_done;  // called after each row of a reference, one at a time; may be null
  Team team;                                    // its ranks take the references' samples; this one measures
  std::string counting_folder;                  // in the process that valgrind runs: the job to render; otherwise empty
};

// A scene opened for all configurations that share its geometry.
struct Rig {
  OpenScene opened;
  Configuration baseline;  // as set by the options
  std::string scene_hash;  // of its content
  // In the cache, of the front and of its prices on this machine; empty: not identified, or its look is overridden.
  std::string front_path, prices_path;
  bool has_own_look = false;  // neither light nor surroundings are overridden
  double bake_seconds = kNotMeasured, stored_bytes = 0;  // bake_seconds: of scenes that were baked for the sweep
  std::vector<std::uint32_t> packed;                     // pixels of the last frame
  std::vector<std::uint8_t> reference_memory;
  Reference reference;            // for the posed frame; made on demand
  std::uint32_t part_pixels = 0;  // frames are parts of about this many pixels; 0: the whole picture
};

// A sweep renders the scene with each of these, besides settings.
struct SceneChoice {
  std::uint32_t sphere_columns = kCornellSphereColumns;  // of cornell's sphere
  BakeChoices bake;
};

// Opens the scene for every configuration of the knobs.
Status open_rig(const AccuracyOptions& options, const SceneChoice& choice, std::unique_ptr<Rig>* rig);
inline Status open_rig(const AccuracyOptions& options, std::uint32_t sphere_columns, std::unique_ptr<Rig>* rig) {
  return open_rig(options, SceneChoice{sphere_columns, {}}, rig);
}

// Makes rig->reference from the prepared frame, unless already made.
void make_rig_reference(Rig* rig);

// Reduces frames to about a sixteenth of the picture, spread over its tiles; a small picture stays whole. Leaves other
// pixels unchanged. Returns the number of pixels.
std::uint32_t take_part(Rig* rig);

// Prepares, renders, packs and times a frame, after preparing one with the same settings. The picture stays in the
// rig's renderer. Stops at an interrupt, which the caller must check for.
Status time_frame(Rig* rig, const Configuration& configuration, double seconds, double* ns_per_pixel);

// Instructions per pixel of tracing and packing, as in time_frame(); NaN if not counted or interrupted.
Status count_instructions(Rig* rig, const Configuration& configuration, double seconds, double* per_pixel);

// Measures everything not yet in the folder. After an interrupt *whole is false and the rest is missing. *front, unless
// null, receives the front for --budget-ms.
Status measure_sweep(const AccuracyOptions& options, Sweep* sweep, bool* whole, SweptFront* front = nullptr);

}  // namespace pocketray
