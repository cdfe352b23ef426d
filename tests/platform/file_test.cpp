#include "platform/file.h"

#include <doctest/doctest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdio>
#include <cstring>
#include <string>

#include "folder.h"

using namespace folder_test;

// Goal: errors of reading and writing state their cause. Method: each kind.
TEST_CASE("file_errors_say_why") {
  Folder folder;
  FileError error;
  CHECK(content_of(folder.file("a")) == "cannot be opened: No such file or directory");
  CHECK(content_of(folder.path) == "is a folder, a pipe or a device: put a regular file there");
  REQUIRE(write_file(folder.file("a"), "", &error));
  CHECK(content_of(folder.file("a")) == "is empty: create it again");
  CHECK_FALSE(write_file(folder.file("no/a"), "x", &error));
  CHECK(std::strstr(error.text, "No such file") != nullptr);
  CHECK_FALSE(write_file("/tmp/" + std::string(2000, 'x'), "x", &error));
  CHECK(std::strstr(error.text, "longer than") != nullptr);
  CHECK_FALSE(write_file(folder.path, "x", &error));  // a folder
  CHECK(std::strstr(error.text, "is a folder") != nullptr);
  CHECK_FALSE(write_file("", "x", &error));
  CHECK(std::strstr(error.text, "path is empty") != nullptr);
}

// Goal: a missing folder is made, and an existing one is accepted; anything else is an error. Method: twice, within a
// missing folder, over a file.
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

// Goal: anything but a regular file is refused without waiting. Method: a pipe that nobody writes to, a device, a loop
// of links; an alarm ends the test if it hangs.
TEST_CASE("file_that_is_none_is_refused_at_once") {
  Folder folder;
  REQUIRE(mkfifo(folder.file("pipe").c_str(), 0600) == 0);
  REQUIRE(symlink("loop", folder.file("loop").c_str()) == 0);
  alarm(20);
  CHECK(content_of(folder.file("pipe")) == "is a folder, a pipe or a device: put a regular file there");
  CHECK(content_of("/dev/zero") == "is a folder, a pipe or a device: put a regular file there");
  CHECK(content_of("/dev/tty").find("bytes") == std::string::npos);
  CHECK(content_of(folder.file("loop")).find("cannot be opened") == 0);
  alarm(0);
}

// Goal: data in memory does not change with the file, and a file truncated while being read is an error, not a signal.
// Method: truncate and overwrite the same inode, as `cp` and a full disk do.
TEST_CASE("file_in_memory_does_not_follow_the_file") {
  Folder folder;
  FileError error;
  const std::string path = folder.file("a"), content(100'000, 'x');
  REQUIRE(write_file(path, content, &error));
  LoadedFile file;
  REQUIRE(load_file(path.c_str(), &file, &error));
  REQUIRE(file.byte_count == content.size());
  std::FILE* over = std::fopen(path.c_str(), "r+b");
  REQUIRE(over != nullptr);
  CHECK(std::fwrite("changed", 1, 7, over) == 7);
  std::fclose(over);
  CHECK(std::memcmp(file.bytes, content.data(), content.size()) == 0);
  REQUIRE(truncate(path.c_str(), 0) == 0);
  CHECK(std::memcmp(file.bytes, content.data(), content.size()) == 0);
  unload_file(&file);

  REQUIRE(write_file(path, content, &error));
  FileReader reader;
  std::string bytes(content.size(), 0);
  REQUIRE(open_reader(path.c_str(), &reader, &error));
  CHECK(reader.byte_count == content.size());
  CHECK(read_bytes(&reader, &bytes[0], 1000, &error));
  REQUIRE(truncate(path.c_str(), 5000) == 0);
  CHECK_FALSE(read_bytes(&reader, &bytes[1000], bytes.size() - 1000, &error));
  CHECK(std::strstr(error.text, "was truncated") != nullptr);
  close_reader(&reader);
  CHECK(reader.descriptor == -1);
}
