// A folder for a test's files, removed at the end.
#pragma once
#include <doctest/doctest.h>

#include <fstream>
#include <string>

#include "platform/file.h"

namespace pocketray {

struct PictureFolder {
  char path[256] = {};
  PictureFolder() {
    platform::FileError error;
    REQUIRE_MESSAGE(platform::make_temporary_folder(path, sizeof path, &error), error.text);
  }
  ~PictureFolder() { platform::remove_folder(path); }
  std::string operator/(const char* name) const { return std::string(path) + "/" + name; }
};

inline void save(const std::string& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

}  // namespace pocketray
