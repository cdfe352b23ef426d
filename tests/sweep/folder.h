// A folder that is removed at the end of a test.
#pragma once
#include <doctest/doctest.h>
#include <stdlib.h>

#include <cstdio>
#include <string>
#include <vector>

#include "platform/file.h"

namespace pocketray {

// Removes a folder's files; it may have folders of that depth.
inline void remove_folder(const std::string& path, int depth) {
  std::vector<std::string> names;
  auto found = [](void* context, const char* name) {
    static_cast<std::vector<std::string>*>(context)->push_back(name);
  };
  platform::FileError error;
  (void)platform::list_folder(path.c_str(), found, &names, &error);
  for (const std::string& name : names) {
    std::remove((path + "/" + name).c_str());
    if (depth > 0) remove_folder(path + "/" + name, depth - 1);
  }
  std::remove(path.c_str());
}

// A folder for a sweep, which also has its cache.
struct Folder {
  char path[32] = "/tmp/pocketray_XXXXXX";
  Folder() { REQUIRE(mkdtemp(path) != nullptr); }
  ~Folder() { remove_folder(path, 2); }
  std::string file(const std::string& name) const { return std::string(path) + "/" + name; }
  std::string cache() const { return file("cache"); }
};

}  // namespace pocketray
