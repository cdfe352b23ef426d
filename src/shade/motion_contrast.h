// Contrast that goes unseen in what moves. The eye's sensitivity to it depends on the frequency of a pattern and on its
// speed across the retina [Kelly 1979, "Motion and vision. II. Stabilized spatio-temporal threshold surface"], with the
// constants and the eye's own movements of [Daly 1998, "Engineering observations from spatiovelocity and spatiotemporal
// visual models"]: it follows what it looks at, but not all the way.
#pragma once
#include "shade/carried.h"

namespace pocketray {

// Of a viewer who follows with the eye what moves so fast: degrees per second, at least the eye's drift.
double retinal_speed(double degrees_per_second);
// Sensitivity to contrast: the inverse of the least that is seen.
double contrast_sensitivity(double cycles_per_degree, double retinal_degrees_per_second);

// How many times the contrast may be that goes unseen at rest, by movement in pixels per frame; the last for all more.
constexpr std::uint32_t kMotionStepMax = 63;
// Chosen: of the contrasts that are seen with certainty, no more is given up.
constexpr float kMotionToleranceMax = 4;
struct MotionTolerance {
  float at[kMotionStepMax + 1];
};
// For detail as coarse as a cell's side, the coarsest that selective rendering misses, two pixels of which are a
// period.
void set_motion_tolerance(double pixels_per_degree, double frames_per_second, MotionTolerance* tolerance);

// Of a pixel whose ray hits a surface; 1 if it is not known where that was.
float motion_tolerance(const FrameData& frame, std::uint32_t column, std::uint32_t row, const Hit& hit);

}  // namespace pocketray
