// Identifies a scene by content, wherever it came from: for servers and for the files of its front.
#pragma once
#include "scene/content_hash.h"
#include "session/source.h"

namespace pocketray {

// Hash of the scene's baked file: a .pray file as it is; an imported model or built-in scene as baked without an
// accelerator. Call between load_scene() and plan_renderer(), which adds missing lights and cameras. Bakes a built-in
// scene into the free part of the scene arena, which it then releases; fails if that is too small.
Status identify_scene(const SceneSource& source, Renderer* renderer, ContentHash* hash);

}  // namespace pocketray
