// Reads files beside the scene file. Names in a scene file cannot leave its folder, or a given folder that contains it.
#pragma once
#include <cstdint>
#include <set>
#include <string>
#include <vector>

namespace pocketray {

using Bytes = std::vector<std::uint8_t>;

// The files opened by an import, each once. Bounded, since a scene file may name any number.
struct FilesRead {
  std::string root;  // folder that names may not leave; empty: the scene file's
  std::set<std::string> paths;
  std::size_t byte_count = 0;
};
constexpr std::size_t kFilesReadBytesMax = 512u << 10;  // chosen: five thousand long names

// Adds a path; throws ImportError beyond kFilesReadBytesMax.
void note_file(FilesRead* files, const std::string& path);

// Reads the whole file and adds it to `files`. Throws ImportError if it cannot be read or is larger than
// `byte_count_max`, before allocating.
Bytes read_file(const std::string& path, std::uint64_t byte_count_max, FilesRead* files);

// Returns the path of the file `name` in the scene file at `scene_path`: relative, with '\' read as '/'. Throws
// ImportError for any other name, and for one that ".." leads out of the folder `root`, by default the scene file's.
std::string path_beside(const std::string& scene_path, const std::string& name, const std::string& root = "");

// path_beside() or, if no such file exists, a path that differs only in the case of ASCII letters, as on systems that
// ignore case.
std::string find_beside(const std::string& scene_path, const std::string& name, const std::string& root = "");
Bytes read_beside(const std::string& scene_path, const std::string& name, std::uint64_t byte_count_max,
                  FilesRead* files);

// Returns a glTF URI's bytes: "data:…;base64,…" or a percent-encoded relative path.
Bytes read_uri(const std::string& scene_path, const std::string& uri, std::uint64_t byte_count_max, FilesRead* files);

// Returns the lower-case ending without the dot; "" if none. path_stem(): the name without folders and ending.
std::string path_ending(const std::string& path);
std::string path_stem(const std::string& path);

}  // namespace pocketray
