// Bytes from files beside the scene file. Whatever a scene file names stays under its own folder.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

namespace pocketray {

using Bytes = std::vector<std::uint8_t>;

// The whole file; its size is asked before memory is taken. Throws ImportError when it cannot be read or is larger than
// `byte_count_max`.
Bytes read_file(const std::string& path, std::uint64_t byte_count_max);

// Path of the file that the scene file at `scene_path` calls `name`: relative, without "..", '\' taken as '/'.
// Throws ImportError for anything else.
std::string path_beside(const std::string& scene_path, const std::string& name);

// A glTF URI's bytes: "data:…;base64,…" or a percent-encoded relative path.
Bytes read_uri(const std::string& scene_path, const std::string& uri, std::uint64_t byte_count_max);

// Lower-case ending without the dot; "" if none. Name without folders and ending.
std::string path_ending(const std::string& path);
std::string path_stem(const std::string& path);

}  // namespace pocketray
