// Patches are divided where a light shines on them unevenly: beside a lamp and across the edges of shadows.
#pragma once
#include "desktop/radiosity/rays.h"

namespace pocketray {

// The irradiance of lights, the mean over the patch's light samples.
Vec3d mean_light(const SceneRays& rays, const Patch& patch);

// Substructuring [Cohen et al. 1986, "An Efficient Radiosity Approach for Realistic Image Synthesis"], of the patches
// that shoot: cells of flat surfaces are quartered, up to kRefinements times, as long as the light that they reflect
// deviates from its mean over the cell by more than kUneven of what all patches reflect. At most `count_max` patches.
constexpr int kRefinements = 4;
constexpr double kUneven = 1e-4;
void refine_patches(const SceneRays& rays, const Surfaces& surfaces, std::uint32_t count_max, std::uint32_t threads,
                    std::vector<Patch>* patches);

// Leaves out what of the patches lies inside bodies, such as the floor under a box: their area, and their samples, are
// those of the rest.
void uncover_patches(const SceneRays& rays, std::uint32_t threads, std::vector<Patch>* patches);

}  // namespace pocketray
