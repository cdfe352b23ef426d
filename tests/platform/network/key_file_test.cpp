// Files of keys: written once for their owner alone, and read only if they are that.
#include "platform/net/key_file.h"

#include <doctest/doctest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstring>

#include "platform/folder.h"

using namespace folder_test;

namespace {

SharedKey some_key() {
  SharedKey key;
  for (std::size_t i = 0; i < SharedKey::kByteCount; ++i) key.bytes[i] = static_cast<unsigned char>(7 * i + 150);
  return key;
}

bool is_same(const SharedKey& a, const SharedKey& b) { return std::memcmp(a.bytes, b.bytes, sizeof a.bytes) == 0; }

int mode_of(const std::string& path) {
  struct stat about = {};
  REQUIRE(stat(path.c_str(), &about) == 0);
  return static_cast<int>(about.st_mode & 07777);
}

}  // namespace

// Goal: a key is read back as it was written, from a file that only its owner may read, whatever the umask. Method:
// umasks that take nothing, and everything.
TEST_CASE("key_file_is_for_its_owner_alone") {
  for (mode_t mask : {0, 0777}) {
    Folder folder;
    const std::string path = folder.file("key");
    FileError error;
    mode_t before = umask(mask);
    bool created = create_key_file(path.c_str(), some_key(), &error);
    umask(before);
    REQUIRE_MESSAGE(created, error.text);
    CHECK_EQ(mode_of(path), 0600);
    SharedKey key;
    CHECK(read_key_file(path.c_str(), &key, &error));
    CHECK(is_same(key, some_key()));
    CHECK(content_of(path).substr(0, 20) == "pocketray-key-1:969d");
    CHECK_EQ(content_of(path).size(), 81u);
  }
}

// Goal: a key never replaces a file, nor writes through a link. Method: a file, and links to it and to nothing.
TEST_CASE("key_file_never_overwrites") {
  Folder folder;
  FileError error;
  REQUIRE(write_file(folder.file("file"), "old", &error));
  REQUIRE(symlink(folder.file("file").c_str(), folder.file("link").c_str()) == 0);
  REQUIRE(symlink(folder.file("none").c_str(), folder.file("dangling").c_str()) == 0);
  for (const char* name : {"file", "link", "dangling"}) {
    CAPTURE(name);
    CHECK_FALSE(create_key_file(folder.file(name).c_str(), some_key(), &error));
    CHECK(std::strstr(error.text, "a file of that name exists") != nullptr);
  }
  CHECK(content_of(folder.file("file")) == "old");
  CHECK_EQ(access(folder.file("none").c_str(), F_OK), -1);
  CHECK_FALSE(create_key_file(folder.file("no/where").c_str(), some_key(), &error));
  CHECK(std::strchr(error.text, '\n') == nullptr);
}

// Goal: a key that anyone else may read, write or execute is refused with the command that mends it. Method: every
// single bit.
TEST_CASE("key_file_refuses_what_others_may_use") {
  Folder folder;
  const std::string path = folder.file("key");
  FileError error;
  SharedKey key;
  REQUIRE(create_key_file(path.c_str(), some_key(), &error));
  for (mode_t bit = 1; bit <= 040; bit <<= 1) {
    CAPTURE(bit);
    REQUIRE(chmod(path.c_str(), 0600 | bit) == 0);
    CHECK_FALSE(read_key_file(path.c_str(), &key, &error));
    CHECK(std::string(error.text) == "others may read the key: chmod 600 " + path);
  }
  for (mode_t mode : {0600, 0400, 0700}) {
    REQUIRE(chmod(path.c_str(), mode) == 0);
    CHECK(read_key_file(path.c_str(), &key, &error));
  }
}

// Goal: anything but a whole key is refused in one line. Method: every prefix of a key's file, every byte replaced,
// bytes added, and what is no file.
TEST_CASE("key_file_refuses_what_is_no_key") {
  Folder folder;
  const std::string path = folder.file("key");
  FileError error;
  SharedKey key;
  REQUIRE(create_key_file(path.c_str(), some_key(), &error));
  const std::string good = content_of(path);
  auto is_refused = [&](const std::string& content) {
    REQUIRE(write_file(path, content, &error));
    error.text[0] = 0;
    return !read_key_file(path.c_str(), &key, &error) && std::strstr(error.text, "not a key: make one") == error.text;
  };
  for (std::size_t length = 0; length + 1 < good.size(); ++length) {
    CAPTURE(length);
    CHECK(is_refused(good.substr(0, length)));
  }
  for (std::size_t i = 0; i < good.size(); ++i) {
    CAPTURE(i);
    std::string bad = good;
    bad[i] = 'g';
    CHECK(is_refused(bad));
  }
  for (const char* more : {"\n", " ", "0", "00000000000000000000"}) CHECK(is_refused(good + more));
  CHECK_FALSE(is_refused(good.substr(0, good.size() - 1)));  // without the line's end it is one
  CHECK_FALSE(read_key_file(folder.path, &key, &error));
  CHECK(std::strstr(error.text, "not a file") != nullptr);
  CHECK_FALSE(read_key_file(folder.file("none").c_str(), &key, &error));
  CHECK(std::strstr(error.text, "no such file: make one with") != nullptr);
  REQUIRE(mkfifo(folder.file("fifo").c_str(), 0600) == 0);
  CHECK_FALSE(read_key_file(folder.file("fifo").c_str(), &key, &error));  // and does not wait
  CHECK(std::strstr(error.text, "not a file") != nullptr);
}
