// Takes a reference's samples until it is good enough, and keeps them in a file.
#pragma once
#include "desktop/sweep/reference_file.h"

namespace pocketray {

struct ReferencePictures {
  std::vector<double> one, other, mean;                    // exposed light, clamped to the display range [0, 1]
  std::vector<float> encoded_one, encoded_other, encoded;  // as sRGB
  Levels levels;                                           // of the mean, 8 bits per channel
  double rmse = 0, flip = 0;                               // the mean's own error
  std::uint64_t samples = 0;                               // per pixel, both halves together
};

// Makes the pictures of an accumulation, at the rig's exposure.
void develop(const Accumulation& accumulation, const Display& display, double pixels_per_degree,
             ReferencePictures* pictures);

// Own error of one region in a grid that is as even as whole pixels allow, row by row from the top.
struct RegionError {
  std::uint32_t column, row, column_end, row_end;  // pixels
  double rmse, flip;
};
std::vector<RegionError> region_errors(const ReferencePictures& pictures, std::uint32_t width, std::uint32_t height,
                                       double pixels_per_degree);

struct ReferenceGoal {
  Transport transport = Transport::physical;
  std::uint32_t samples = 0;               // per pixel, both halves and all parts together; 0: no limit
  double until = 0;                        // ꟻLIP error at which to stop; 0: only at `samples`
  std::uint32_t part = 1, part_count = 1;  // takes this part's samples
  double pixels_per_degree = kHandheldPixelsPerDegree;
  std::string path;                             // of its file
  Team team;                                    // ranks that take the samples
  double save_seconds = 60;                     // between saves
  LaterWork later;                              // for the progress
  std::function<void(std::uint32_t)> row_done;  // called after each row's samples, one at a time; may be null
};

// Adds the samples that the goal lacks, using the rig's prepared frame and all its threads, and saves them now and then
// and at the end. The other ranks of a team run a ReferenceHelper; this one leads. After an interrupt *whole is false;
// calling again continues.
Status run_reference(const ReferenceGoal& goal, Rig* rig, Accumulation* accumulation, bool* whole);

}  // namespace pocketray
