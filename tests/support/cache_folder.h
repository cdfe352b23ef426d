// A cache of its own for a test, as $XDG_CACHE_HOME.
#pragma once
#include <doctest/doctest.h>
#include <stdlib.h>

#include <string>
#include <vector>

#include "platform/file.h"

namespace pocketray {

struct CacheFolder {
  char path[256];

  CacheFolder() {
    platform::FileError error;
    if (!platform::make_temporary_folder(path, sizeof path, &error)) FAIL(error.text);
    setenv("XDG_CACHE_HOME", path, 1);
  }
  CacheFolder(const CacheFolder&) = delete;
  CacheFolder& operator=(const CacheFolder&) = delete;
  ~CacheFolder() {
    platform::remove_folder(kept().c_str());
    platform::remove_folder(path);
    setenv("XDG_CACHE_HOME", "/dev/null", 1);
  }
  std::string kept() const { return std::string(path) + "/pocketray"; }
  std::vector<std::string> names() const {
    std::vector<std::string> found;
    platform::FileError error;
    auto add = [](void* list, const char* name) { static_cast<std::vector<std::string>*>(list)->push_back(name); };
    platform::list_folder(kept().c_str(), add, &found, &error);
    return found;
  }
};

// The light of rooms for all tests of a program, which it solves once.
inline const CacheFolder& light_of_rooms() {
  static const CacheFolder folder;
  setenv("XDG_CACHE_HOME", folder.path, 1);
  return folder;
}

}  // namespace pocketray
