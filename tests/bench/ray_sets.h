// The ray sets of a picture size.
#pragma once
#include <string>
#include <vector>

#include "bench/ours.h"

namespace pocketray {

// Of the kinds named, in the order of kBenchRayNames. The light of shadow rays is offset from the eye by a fraction of
// the scene's size; in a narrow room by less, until it reaches a third.
Status make_ray_sets(const BenchScene& scene, const std::string& size, const std::vector<std::string>& kinds,
                     const OurSide& ours, std::vector<RaySet>* sets);

}  // namespace pocketray
