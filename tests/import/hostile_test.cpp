// Files made to break a reader: each ends in a scene or in one line of explanation.
#include <dirent.h>

#include <algorithm>
#include <vector>

#include "import/import_testing.h"

using namespace pocketray;

static void list_files(const std::string& folder, std::vector<std::string>* files) {
  DIR* dir = opendir(folder.c_str());
  if (!dir) return;
  while (dirent* entry = readdir(dir)) {
    std::string name = entry->d_name, path = folder + "/" + name;
    if (name == "." || name == "..") continue;
    struct stat info;
    if (stat(path.c_str(), &info) != 0) continue;
    if (S_ISDIR(info.st_mode)) list_files(path, files);
    if (S_ISREG(info.st_mode)) files->push_back(path);
  }
  closedir(dir);
}

// Goal: no file crashes the reader or lets an exception out, and every refusal is one clear line. Method: import every
// file of the hostile collection whose ending the reader knows; run under the sanitizers as well.
TEST_CASE("import_hostile_files_end_in_a_scene_or_one_line") {
  if (!have(shared_scene("hostile"))) return;
  std::vector<std::string> files;
  list_files(shared_scene("hostile"), &files);
  std::sort(files.begin(), files.end());
  CHECK(files.size() > 300);
  int read = 0, refused = 0;
  for (const std::string& path : files) {
    CAPTURE(path);
    ImportOptions options;
    options.byte_count_max = 64 << 20;
    ImportedScene result;
    Status status = import_scene(path, options, &result);
    if (status.ok) ++read;
    if (!status.ok) {
      ++refused;
      std::string message = status.message;
      CHECK(message.size() > path.size() + 10);
      CHECK(message.find('\n') == std::string::npos);
    }
    if (std::getenv("POCKETRAY_VERBOSE"))
      std::printf("%s | %s\n", path.c_str(), status.ok ? ("OK " + result.warning).c_str() : status.message);
  }
  std::printf("hostile: %d read, %d refused\n", read, refused);
  CHECK(read > 0);
  CHECK(refused > 0);
}
