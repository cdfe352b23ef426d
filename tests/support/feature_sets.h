// The feature sets for suites that test combinations.
#pragma once
#include <algorithm>
#include <vector>

#include "support/effort.h"
#include "support/generated_scene.h"

namespace pocketray {

// All combinations of the features that the radiance kernel is instantiated for and of cut-out holes, with each kind of
// light in turn; all pairs and triples of all features; 200 random sets.
inline std::vector<std::uint32_t> feature_sets() {
  std::vector<std::uint32_t> sets = {0, kAllFeatures};
  const Feature kernel[] = {Feature::specular,   Feature::mirror,     Feature::refraction,
                            Feature::absorption, Feature::alpha_mask, Feature::alpha_blend};
  const std::uint32_t lights[] = {0, bit(Feature::point_light), bit(Feature::spot_light),
                                  bit(Feature::directional_light), bit(Feature::emission)};
  for (std::uint32_t combination = 0; combination < 64; ++combination) {
    std::uint32_t features = 0;
    for (int i = 0; i < 6; ++i)
      if (combination >> i & 1) features |= bit(kernel[i]);
    for (std::uint32_t light : lights) sets.push_back(features | light);
  }
  for (int i = 0; i < kFeatureCount; ++i)
    for (int j = i; j < kFeatureCount; ++j)
      for (int k = j; k < kFeatureCount; ++k) sets.push_back(1u << i | 1u << j | 1u << k);
  Rng rng = make_rng(2024);
  for (int i = 0; i < 200; ++i) sets.push_back(next_u32(&rng) & kAllFeatures);
  std::sort(sets.begin(), sets.end());
  sets.erase(std::unique(sets.begin(), sets.end()), sets.end());
  std::size_t kept = 0;
  for (std::size_t i = 0; i < sets.size(); ++i)
    if (i % kEffortDivisor == 0 || i + 1 == sets.size()) sets[kept++] = sets[i];
  sets.resize(kept);
  return sets;
}

}  // namespace pocketray
