// Scenes as `bake` stores them, for a sweep of its choices.
#pragma once
#include "desktop/accuracy/knob_list.h"
#include "session/open_scene.h"

namespace pocketray {

// Loads the scene as `bake` with these choices would store it, accelerator included. *seconds receives the time that
// took.
Status load_as_baked(const BakeChoices& choices, const std::string& accel, const std::string& name, Renderer* renderer,
                     SceneSource* source, SceneStorage* storage, double* seconds);

// Bytes of the .pray file of an opened scene with its accelerator.
std::size_t stored_bytes_of(const Renderer& renderer);

// Finds which choices of `bake` change an opened scene; reads models again. `has_own_look`: neither light nor
// surroundings are overridden.
Status find_bakeable(const std::string& name, const OpenScene& opened, bool has_own_look, BakeableScene* bakeable);

}  // namespace pocketray
