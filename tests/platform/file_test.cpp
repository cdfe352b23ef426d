#include "platform/file.h"

#include <doctest/doctest.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

using namespace platform;

namespace {

struct Folder {
  char path[32] = "/tmp/pocketray_XXXXXX";
  Folder() { REQUIRE(mkdtemp(path) != nullptr); }
  ~Folder() {
    for (const std::string& name : names()) std::remove(file(name.c_str()).c_str());
    rmdir(path);
  }
  // Of all that lies in it, sorted.
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

bool write_file(const std::string& path, const std::string& content, FileError* error) {
  FileWriter writer;
  if (!open_writer(path.c_str(), &writer, error)) return false;
  write_bytes(&writer, content.data(), content.size());
  return close_writer(&writer, error);
}

std::string content_of(const std::string& path) {
  MappedFile file;
  FileError error;
  if (!map_file(path.c_str(), &file, &error)) return error.text;
  std::string content(reinterpret_cast<const char*>(file.bytes), file.byte_count);
  unmap_file(&file);
  return content;
}

}  // namespace

// Goal: a file is replaced as a whole, and readers keep the old one until then. Method: write, write again, look in
// between.
TEST_CASE("file_is_replaced_as_a_whole") {
  Folder folder;
  FileError error;
  CHECK(file_stamp(folder.file("a").c_str()) == 0);
  REQUIRE(write_file(folder.file("a"), "first", &error));
  std::uint64_t stamp = file_stamp(folder.file("a").c_str());
  CHECK(stamp != 0);
  FileWriter writer;
  REQUIRE(open_writer(folder.file("a").c_str(), &writer, &error));
  write_bytes(&writer, "second one", 10);
  CHECK(content_of(folder.file("a")) == "first");
  CHECK(folder.names().size() == 2);
  CHECK(close_writer(&writer, &error));
  CHECK(content_of(folder.file("a")) == "second one");
  CHECK(file_stamp(folder.file("a").c_str()) != stamp);
  CHECK(folder.names() == std::vector<std::string>{"a"});
  REQUIRE(open_writer(folder.file("a").c_str(), &writer, &error));
  write_bytes(&writer, "third", 5);
  discard_writer(&writer);
  discard_writer(&writer);
  CHECK(content_of(folder.file("a")) == "second one");
  CHECK(folder.names() == std::vector<std::string>{"a"});
}

// Goal: two programs that write one file both succeed, and it is that of the last one as a whole. Method: another
// process writes it while this one does.
TEST_CASE("file_of_two_writers_is_whole") {
  Folder folder;
  FileError error;
  FileWriter writer;
  REQUIRE(open_writer(folder.file("a").c_str(), &writer, &error));
  write_bytes(&writer, "this one's", 10);
  pid_t child = fork();
  if (child == 0) _exit(write_file(folder.file("a"), "the other's", &error) ? 0 : 1);
  int status = -1;
  REQUIRE(waitpid(child, &status, 0) == child);
  CHECK((WIFEXITED(status) && WEXITSTATUS(status) == 0));
  CHECK(content_of(folder.file("a")) == "the other's");
  bool closed = close_writer(&writer, &error);
  INFO(error.text);
  CHECK(closed);
  CHECK(content_of(folder.file("a")) == "this one's");
  CHECK(folder.names() == std::vector<std::string>{"a"});
}

// Goal: a disk that is full loses neither the old file nor leaves half a new one. Method: a file size limit, which
// makes write() come up short and then fail, as a full disk does.
TEST_CASE("file_that_does_not_fit_leaves_the_old_one") {
  Folder folder;
  FileError error;
  REQUIRE(write_file(folder.file("a"), "old", &error));
  rlimit before;
  getrlimit(RLIMIT_FSIZE, &before);
  auto handler = signal(SIGXFSZ, SIG_IGN);
  rlimit small = {1000, before.rlim_max};
  setrlimit(RLIMIT_FSIZE, &small);
  bool written = write_file(folder.file("a"), std::string(5000, 'x'), &error);
  setrlimit(RLIMIT_FSIZE, &before);
  signal(SIGXFSZ, handler);
  CHECK_FALSE(written);
  CHECK(std::strstr(error.text, "disk full") != nullptr);
  CHECK(content_of(folder.file("a")) == "old");
  CHECK(folder.names() == std::vector<std::string>{"a"});
}

// Goal: devices stay devices, and one that takes nothing is noticed. Method: a link to /dev/full and to /dev/null.
TEST_CASE("file_writer_writes_devices_directly") {
  Folder folder;
  FileError error;
  for (const char* device : {"/dev/full", "/dev/null"}) {
    REQUIRE(symlink(device, folder.file("link").c_str()) == 0);
    CHECK(write_file(folder.file("link"), "bytes", &error) == (std::strcmp(device, "/dev/null") == 0));
    struct stat info;
    CHECK(lstat(folder.file("link").c_str(), &info) == 0);
    CHECK(S_ISLNK(info.st_mode));
    CHECK(folder.names() == std::vector<std::string>{"link"});
    std::remove(folder.file("link").c_str());
  }
  CHECK(std::strstr(error.text, "did not take all") != nullptr);
}

// Goal: what cannot be read or written is an error that says why. Method: each kind.
TEST_CASE("file_errors_say_why") {
  Folder folder;
  FileError error;
  CHECK(content_of(folder.file("a")) == "cannot be opened: No such file or directory");
  CHECK(content_of(folder.path) == "is not a regular file: name a scene file");
  REQUIRE(write_file(folder.file("a"), "", &error));
  CHECK(content_of(folder.file("a")) == "is empty: make it again");
  CHECK_FALSE(write_file(folder.file("no/a"), "x", &error));
  CHECK(std::strstr(error.text, "No such file") != nullptr);
  CHECK_FALSE(write_file("/tmp/" + std::string(2000, 'x'), "x", &error));
  CHECK(std::strstr(error.text, "longer than") != nullptr);
  CHECK_FALSE(write_file(folder.path, "x", &error));  // a folder
  CHECK(std::strstr(error.text, "cannot be replaced") != nullptr);
}

// Goal: a folder is made where there is none, and one that is there will do; anything else is an error. Method: twice,
// within a missing folder, over a file.
TEST_CASE("file_folder_is_made_or_there") {
  Folder folder;
  FileError error;
  REQUIRE(write_file(folder.file("a"), "x", &error));
  std::string made = folder.file("made");
  CHECK(make_folder(made.c_str(), &error));
  CHECK(make_folder(made.c_str(), &error));
  REQUIRE(write_file(made + "/a", "x", &error));
  CHECK_FALSE(make_folder(folder.file("no/such").c_str(), &error));
  CHECK(error.text[0] != 0);
  CHECK_FALSE(make_folder(folder.file("a").c_str(), &error));
  std::remove((made + "/a").c_str());
  rmdir(made.c_str());
}
