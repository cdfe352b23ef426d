// Measures a sweep: opens the scene with memory for its dearest configuration, renders references, times all
// configurations in turn and compares their pictures with the reference. See accuracy/sweep_plan.h for what it
// measures.
#pragma once
#include "accuracy/flip.h"
#include "accuracy/sweep_plan.h"
#include "reference/reference.h"
#include "session/open_scene.h"
#include "session/progress.h"
#include "sweep/front.h"
#include "sweep/state.h"

namespace pocketray {

struct AccuracyOptions {
  CommonOptions common;
  std::string folder, output = kOutputFormats[Configuration().output].name, reference = "model";
  std::uint32_t reference_samples = 0;  // a pixel of the chosen reference, both seeds together; 0: what is usual
  std::uint32_t rounds = 15;
  double pixels_per_degree = kHandheldPixelsPerDegree, seconds = 0, price_limit = 16;
  bool restart = false;
  bool starts_valgrind = false;  // where the CPU counts no instructions; of a program started as `pocketray accuracy …`
  double save_seconds = 10;      // between two times that a running reference is saved
  std::function<void(std::uint32_t)> row_done;  // called after each row of a reference, one at a time; may be null
  std::string counting_folder;  // of the program that valgrind runs, and not empty: what it is to render
};

// A scene opened for all configurations that have its geometry.
struct Rig {
  OpenScene opened;
  Configuration baseline;             // as the options have it
  std::string scene_hash;             // of its content
  std::string front_path;             // in the cache; empty: the scene could not be named
  std::vector<std::uint32_t> packed;  // pixels of the last frame
  std::vector<std::uint8_t> reference_memory;
  Reference reference;            // of the posed frame; made where it is needed
  std::uint32_t part_pixels = 0;  // frames are a part of the picture, of about so many pixels; 0: whole
};

// Opens the scene, with cornell's sphere of so many columns, for every configuration that the knobs can make of it.
Status open_rig(const AccuracyOptions& options, std::uint32_t sphere_columns, std::unique_ptr<Rig>* rig);

// Makes rig->reference if it is not made yet, of the frame as it is prepared.
void make_rig_reference(Rig* rig);

// Calls trace_row(row, radiances) for each of the rows by all workers, puts what it gets into `picture`, width ×
// height, and calls row_done(row), one thread at a time; that may be null. False: interrupted before the last of them.
bool trace_rows(const Renderer& renderer, const std::vector<std::uint32_t>& rows,
                const std::function<void(std::uint32_t, Vec3d*)>& trace_row,
                const std::function<void(std::uint32_t)>& row_done, Vec3* picture);

// Frames are about a sixteenth of the picture from now on, spread over it in tiles as the whole one is traced in; a
// small picture stays whole. What they hold elsewhere is left as it was. Returns the pixels.
std::uint32_t take_part(Rig* rig);

// Prepares, renders and packs one frame after another has been prepared with the same settings. Times it; keeps the
// picture in the rig's renderer. Stops at an interrupt, which the caller has to look for.
Status time_frame(Rig* rig, const Configuration& configuration, double seconds, double* ns_per_pixel);

// Instructions per pixel of tracing and packing what time_frame() times; NaN where none are counted or at an interrupt.
Status count_instructions(Rig* rig, const Configuration& configuration, double seconds, double* per_pixel);

// Measures everything. What is there already is taken from the folder; after an interrupt the rest is missing and
// *whole is false. `front`, where given, becomes what --budget-ms may choose from.
Status measure_sweep(const AccuracyOptions& options, Sweep* sweep, bool* whole, SweptFront* front = nullptr);

}  // namespace pocketray
