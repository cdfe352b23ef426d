// Rooms get radiosity unasked: stored by `bake`, otherwise solved when a scene is opened and kept in the cache.
#pragma once
#include "session/radiosity.h"
#include "session/source.h"

namespace pocketray {

// Chosen: a minute of baking, and two seconds of opening, on two cores of 3 GHz (.15 to .35 µs of a core for a pair).
constexpr RadiosityLimit kBakeLimit = {400e6, 8000, std::size_t(2) << 20};
constexpr RadiosityLimit kOpenLimit = {15e6, 2000, std::size_t(2) << 20};
constexpr std::uint32_t kOpenTrianglesMax = 100000;  // chosen: dividing their surfaces takes a second

// Returns whether a scene that stores no radiosity is lit and enclosed, and this build has the solver.
bool calls_for_radiosity(const Scene& scene);

// Makes a scene refer to its radiosity in *solved, which comes from the cache, or is solved and kept there. Scenes that
// need more than kOpenLimit or `bytes_max` stay as they are, as do .pray files. `name` is that of the command line,
// `identity` the scene's content_hash(). Fails on Ctrl-C.
Status find_room_light(const std::string& name, const ContentHash& identity, std::uint32_t threads,
                       std::size_t bytes_max, Scene* scene, SolvedRadiosity* solved);
// Calls find_room_light() for a scene that was just loaded; its radiosity takes at most a quarter of the memory left.
Status light_room(const std::string& name, Renderer* renderer, SceneSource* source, SceneStorage* storage);

}  // namespace pocketray
