// Explains why a picture shows nothing of its model.
#pragma once
#include "session/black_picture.h"

namespace pocketray {

// Explains in one line why no ray of the last frame's grid hits a visible surface: all of the model is transparent,
// culled, without area, behind the camera, beside the picture or smaller than a pixel. Returns false and an empty text
// if a surface is visible. Traces at most a thousand rays; allocates nothing. `material_names`: names of the scene's
// materials, as far as known.
bool explain_nothing(const Renderer& renderer, const std::vector<std::string>& material_names,
                     char (&text)[kBlackTextBytes]);

// explain_black(), otherwise explain_nothing().
bool explain_picture(const Renderer& renderer, const std::vector<std::string>& material_names,
                     char (&text)[kBlackTextBytes]);

}  // namespace pocketray
