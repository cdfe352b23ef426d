// Reads files beside the scene file. Names in a scene file cannot leave its folder.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

namespace pocketray {

using Bytes = std::vector<std::uint8_t>;

// Reads the whole file. Throws ImportError if it cannot be read or is larger than `byte_count_max`, before allocating.
Bytes read_file(const std::string& path, std::uint64_t byte_count_max);

// Path of the file `name` in the scene file at `scene_path`: relative, without "..", with '\' read as '/'. Throws
// ImportError for any other name.
std::string path_beside(const std::string& scene_path, const std::string& name);

// The same path, or if no such file exists, one that differs only in the case of ASCII letters, as on systems that do
// not tell them apart.
std::string find_beside(const std::string& scene_path, const std::string& name);
Bytes read_beside(const std::string& scene_path, const std::string& name, std::uint64_t byte_count_max);

// A glTF URI's bytes: "data:…;base64,…" or a percent-encoded relative path.
Bytes read_uri(const std::string& scene_path, const std::string& uri, std::uint64_t byte_count_max);

// Lower-case ending without the dot; "" if none. Name without folders and ending.
std::string path_ending(const std::string& path);
std::string path_stem(const std::string& path);

}  // namespace pocketray
