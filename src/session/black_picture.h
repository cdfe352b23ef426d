// Why a picture is black where it shows surfaces.
#pragma once
#include <string>
#include <vector>

#include "engine/renderer.h"

namespace pocketray {

// More of a picture's surfaces than this are exactly black only where something is amiss: materials, or light. Without
// ambient light, shadows alone cover up to .38 of the sample models (EmissiveStrengthTest), so their limit is above
// that. Chosen: lower limits would warn of pictures that are meant to be dark.
constexpr double kBlackShareMax = 0.25, kShadowShareMax = 0.5;

// Explains renderer.image, the last frame: the share of surfaces whose pixels are exactly black and the likely cause,
// in one line. False, and an empty text, if the share is at most that. Traces at most a thousand rays through
// a grid of pixels; allocates nothing. Surfaces that light passes do not count. `material_names`: of the scene's
// materials, as far as known.
constexpr std::size_t kBlackTextBytes = 400;
bool explain_black(const Renderer& renderer, const std::vector<std::string>& material_names,
                   char (&text)[kBlackTextBytes]);

}  // namespace pocketray
