// Explains why a picture is black where it shows surfaces.
#pragma once
#include <string>
#include <vector>

#include "engine/renderer.h"

namespace pocketray {

// Larger fractions of exactly black surfaces mean that something is wrong with materials or light. Without ambient
// light, shadows alone cover up to .38 of the sample models (EmissiveStrengthTest), so their limit is higher. Chosen:
// lower limits would warn about pictures that are meant to be dark.
constexpr double kBlackShareMax = 0.25, kShadowShareMax = 0.5;

// Explains renderer.image, the last frame, in one line: the fraction of surfaces whose pixels are exactly black, and
// the likely cause. Returns false and an empty text if the fraction is within the limit. Traces at most a thousand rays
// through a grid of pixels; allocates nothing. Surfaces that transmit light do not count. `material_names`: names of
// the scene's materials, as far as known.
constexpr std::size_t kBlackTextBytes = 400;
bool explain_black(const Renderer& renderer, const std::vector<std::string>& material_names,
                   char (&text)[kBlackTextBytes]);

}  // namespace pocketray
