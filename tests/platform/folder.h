// A private folder for a test, and whole files in it.
#pragma once
#include <doctest/doctest.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "platform/file.h"

namespace folder_test {

using namespace platform;

struct Folder {
  char path[32] = "/tmp/pocketray_XXXXXX";
  Folder() { REQUIRE(mkdtemp(path) != nullptr); }
  ~Folder() {
    for (const std::string& name : names()) std::remove(file(name.c_str()).c_str());
    rmdir(path);
  }
  // Of all its entries, sorted.
  std::vector<std::string> names() const {
    std::vector<std::string> all;
    FileError error;
    auto add = [](void* context, const char* name) {
      static_cast<std::vector<std::string>*>(context)->push_back(name);
    };
    CHECK(list_folder(path, add, &all, &error));
    std::sort(all.begin(), all.end());
    return all;
  }
  std::string file(const char* name) const { return std::string(path) + "/" + name; }
};

inline bool write_file(const std::string& path, const std::string& content, FileError* error) {
  FileWriter writer;
  if (!open_writer(path.c_str(), &writer, error)) return false;
  write_bytes(&writer, content.data(), content.size());
  return close_writer(&writer, error);
}

inline std::string content_of(const std::string& path) {
  LoadedFile file;
  FileError error;
  if (!load_file(path.c_str(), &file, &error)) return error.text;
  std::string content(reinterpret_cast<const char*>(file.bytes), file.byte_count);
  unload_file(&file);
  return content;
}

}  // namespace folder_test
