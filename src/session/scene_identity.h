// Which scene it is, wherever it came from: what device and server call it by, and its front's files.
#pragma once
#include "scene/content_hash.h"
#include "session/source.h"

namespace pocketray {

// The hash of the scene's baked file: of a .pray file as it lies; of an imported model or a built-in scene as they
// would be baked without an accelerator. To be called between load_scene() and plan_renderer(), which adds what a scene
// lacks. A built-in scene is baked for it into what is free of the scene arena, which is given back; fails where that
// is too little.
Status identify_scene(const SceneSource& source, Renderer* renderer, ContentHash* hash);

}  // namespace pocketray
