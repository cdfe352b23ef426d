// Shows which pixels the last frame traced by dimming the others on the screen. The renderer's image is unchanged.
#pragma once
#include "engine/renderer.h"
#include "present/hud.h"

namespace pocketray {

// Halves the levels of the pixels that the last coherent frame reused. The
// canvas holds the freshly packed picture.
void dim_kept_pixels(const Renderer& renderer, const Canvas& canvas);

}  // namespace pocketray
