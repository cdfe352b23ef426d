// Files are replaced as a whole and keep their permissions, links and devices.
#include <doctest/doctest.h>
#include <fcntl.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <functional>
#include <string>
#include <vector>

#include "folder.h"

using namespace folder_test;

namespace {

// Called with each descriptor flushed to the disk; its result is that of fsync().
std::function<int(int)> on_fsync;

mode_t mode_of(const std::string& path) {
  struct stat info = {};
  CHECK(lstat(path.c_str(), &info) == 0);
  return info.st_mode;
}

bool is_root() { return geteuid() == 0; }

}  // namespace

// Replaces the system's.
extern "C" int fsync(int descriptor) {
  if (on_fsync) return on_fsync(descriptor);
  return static_cast<int>(syscall(SYS_fsync, descriptor));
}

// Goal: a file is replaced as a whole, and readers keep the old one until then. Method: write, write again, read in
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

// Goal: bytes of a file can be written anew, those of a pipe cannot. Method: the middle of a file; a pipe.
TEST_CASE("file_bytes_are_rewritten") {
  Folder folder;
  FileError error;
  FileWriter writer;
  REQUIRE(open_writer(folder.file("a").c_str(), &writer, &error));
  write_bytes(&writer, "abcdef", 6);
  CHECK(rewrite_bytes(&writer, 2, "XY", 2));
  write_bytes(&writer, "g", 1);
  REQUIRE(close_writer(&writer, &error));
  CHECK(content_of(folder.file("a")) == "abXYefg");
  int ends[2];
  REQUIRE(pipe(ends) == 0);
  REQUIRE(open_writer(("/dev/fd/" + std::to_string(ends[1])).c_str(), &writer, &error));
  CHECK_FALSE(rewrite_bytes(&writer, 0, "XY", 2));
  CHECK(close_writer(&writer, &error));
  close(ends[0]), close(ends[1]);
}

// Goal: standard output kept for data gets nothing else. Method: in another process with both outputs in files, data
// and prints before and after.
TEST_CASE("file_output_is_kept_for_data") {
  Folder folder;
  pid_t child = fork();
  if (child == 0) {
    FileError error;
    FileWriter writer;
    bool ok =
        std::freopen(folder.file("out").c_str(), "w", stdout) && std::freopen(folder.file("told").c_str(), "w", stderr);
    std::printf("before ");
    ok = ok && !is_output_for_data() && keep_output_for_data(&error) && is_output_for_data();
    std::printf("after ");
    ok = ok && keep_output_for_data(&error) && open_writer("-", &writer, &error);
    if (ok) write_bytes(&writer, "data", 4);
    ok = ok && close_writer(&writer, &error);
    std::fflush(stdout);
    _exit(ok ? 0 : 1);
  }
  int status = 1;
  REQUIRE(waitpid(child, &status, 0) == child);
  CHECK(status == 0);
  CHECK(content_of(folder.file("out")) == "before data");
  CHECK(content_of(folder.file("told")) == "after ");
}

// Goal: two programs that write one file both succeed, and the last one's content is complete. Method: another process
// writes it while this one does.
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

// Goal: a full disk neither loses the old file nor leaves half a new one. Method: a file size limit, which makes
// write() return short and then fail, as a full disk does.
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

// Goal: devices stay devices, and one that accepts nothing is noticed. Method: a link to /dev/full and to /dev/null.
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

// Goal: a power cut leaves either the old file or the new one, complete. Method: the content under the name and the
// files flushed to the disk, in the order of the calls; a disk that fails at that point.
TEST_CASE("file_reaches_the_disk_before_its_name") {
  Folder folder;
  FileError error;
  REQUIRE(write_file(folder.file("a"), "old", &error));
  std::vector<std::string> seen;
  on_fsync = [&](int descriptor) {
    struct stat info = {};
    fstat(descriptor, &info);
    seen.push_back((S_ISDIR(info.st_mode) ? "folder " : "file ") + content_of(folder.file("a")));
    return 0;
  };
  CHECK(write_file(folder.file("a"), "new", &error));
  CHECK(seen == std::vector<std::string>{"file old", "folder new"});
  on_fsync = [](int) { return errno = EIO, -1; };
  CHECK_FALSE(write_file(folder.file("a"), "lost", &error));
  on_fsync = nullptr;
  CHECK(content_of(folder.file("a")) == "new");
  CHECK(folder.names() == std::vector<std::string>{"a"});
}

// Goal: a replaced file keeps its permissions and its owner, a new one follows the umask. Method: modes that no umask
// gives; as root, another user's file; without root, a group that cannot be kept.
TEST_CASE("file_keeps_its_permissions") {
  Folder folder;
  FileError error;
  mode_t before = umask(027);
  REQUIRE(write_file(folder.file("a"), "new", &error));
  CHECK(mode_of(folder.file("a")) == (S_IFREG | 0640));
  for (mode_t mode : {0600u, 0664u, 0755u, 0606u}) {
    CAPTURE(mode);
    REQUIRE(chmod(folder.file("a").c_str(), mode) == 0);
    if (is_root()) REQUIRE(chown(folder.file("a").c_str(), 1234, 5678) == 0);
    CHECK(write_file(folder.file("a"), "other", &error));
    CHECK(mode_of(folder.file("a")) == (S_IFREG | mode));
    struct stat info = {};
    CHECK(stat(folder.file("a").c_str(), &info) == 0);
    if (is_root()) CHECK((info.st_uid == 1234 && info.st_gid == 5678));
  }
  umask(before);
}

// Goal: a protected file is not replaced. Method: a file without write permission, in a child that gives up root.
TEST_CASE("file_that_is_read_only_stays") {
  Folder folder;
  FileError error;
  REQUIRE(write_file(folder.file("a"), "old", &error));
  REQUIRE(chmod(folder.file("a").c_str(), 0444) == 0);
  REQUIRE(chmod(folder.path, 0777) == 0);
  pid_t child = fork();
  if (child == 0) {
    if (is_root() && setuid(1234) != 0) _exit(2);
    bool refused = !can_write(folder.file("a").c_str(), &error) && !write_file(folder.file("a"), "new", &error);
    _exit(refused && std::strstr(error.text, "cannot be written") ? 0 : 1);
  }
  int status = -1;
  REQUIRE(waitpid(child, &status, 0) == child);
  CHECK((WIFEXITED(status) && WEXITSTATUS(status) == 0));
  CHECK(content_of(folder.file("a")) == "old");
}

// Goal: a link stays a link, and its target is written, whether or not it exists; circular links are an error. Method:
// links of one and two steps, relative ones from another folder, one to nothing.
TEST_CASE("file_behind_a_link_is_written") {
  Folder folder;
  FileError error;
  std::string within = folder.file("within");
  REQUIRE(make_folder(within.c_str(), &error));
  REQUIRE(write_file(within + "/a", "old", &error));
  REQUIRE(symlink("within/a", folder.file("one").c_str()) == 0);
  REQUIRE(symlink("../one", (within + "/two").c_str()) == 0);
  REQUIRE(symlink((within + "/new").c_str(), folder.file("new").c_str()) == 0);
  CHECK(write_file(within + "/two", "through two", &error));
  CHECK(content_of(within + "/a") == "through two");
  CHECK(write_file(folder.file("new"), "made", &error));
  CHECK(content_of(within + "/new") == "made");
  for (const char* name : {"one", "new", "within/two"}) CHECK(S_ISLNK(mode_of(folder.file(name))));
  CHECK(folder.names() == std::vector<std::string>{"new", "one", "within"});
  REQUIRE(symlink("circle", folder.file("circle").c_str()) == 0);
  CHECK_FALSE(can_write(folder.file("circle").c_str(), &error));
  CHECK_FALSE(write_file(folder.file("circle"), "x", &error));
  CHECK(S_ISLNK(mode_of(folder.file("circle"))));
  remove_folder(within.c_str());
}

// Goal: a growing file replaces what has its name, at once and as a whole, and touches nothing that a link leads to; a
// pipe is not waited for. Method: nothing there, a file with a second name, a link, a pipe; a folder stays.
TEST_CASE("file_grows_under_its_name") {
  Folder folder;
  FileError error;
  REQUIRE(write_file(folder.file("precious"), "untouched", &error));
  REQUIRE(link(folder.file("precious").c_str(), folder.file("hard").c_str()) == 0);
  REQUIRE(chmod(folder.file("hard").c_str(), 0640) == 0);
  REQUIRE(symlink("precious", folder.file("soft").c_str()) == 0);
  REQUIRE(mkfifo(folder.file("pipe").c_str(), 0600) == 0);
  for (const char* name : {"hard", "new", "pipe", "soft"}) {
    CAPTURE(name);
    CHECK(is_plain_or_absent(folder.file(name).c_str()) == (std::string(name) == "hard" || std::string(name) == "new"));
    FileWriter writer;
    REQUIRE(open_growing_writer(folder.file(name).c_str(), "one", 3, &writer, &error));
    CHECK(content_of(folder.file(name)) == "one");
    write_bytes(&writer, " two", 4);
    CHECK(content_of(folder.file(name)) == "one two");
    CHECK(close_writer(&writer, &error));
    CHECK(S_ISREG(mode_of(folder.file(name))));
  }
  CHECK((mode_of(folder.file("hard")) & 0777) == 0640);
  CHECK(content_of(folder.file("precious")) == "untouched");
  CHECK(folder.names() == std::vector<std::string>{"hard", "new", "pipe", "precious", "soft"});
  FileWriter writer;
  REQUIRE(make_folder(folder.file("within").c_str(), &error));
  CHECK_FALSE(open_growing_writer(folder.file("within").c_str(), "one", 3, &writer, &error));
  CHECK(writer.descriptor < 0);
  CHECK(folder.names().size() == 6);
}

// Goal: a link planted at the part's name cannot make us write another file, and files left by killed programs do no
// harm. Method: links and files of all the likely names, to a file that must not change.
TEST_CASE("file_part_is_no_one_elses") {
  Folder folder;
  FileError error;
  REQUIRE(write_file(folder.file("precious"), "untouched", &error));
  std::string part = folder.file("a.") + std::to_string(getpid());
  for (const std::string& name : {part + ".part", part + "-0.part", part + "-1.part"})
    REQUIRE(symlink("precious", name.c_str()) == 0);
  REQUIRE(write_file(part + "-2.part", "left", &error));
  CHECK(can_write(folder.file("a").c_str(), &error));
  CHECK(write_file(folder.file("a"), "written", &error));
  CHECK(content_of(folder.file("a")) == "written");
  CHECK(content_of(folder.file("precious")) == "untouched");
  CHECK(content_of(part + "-2.part") == "left");
  CHECK(folder.names().size() == 6);
}

// Goal: a file with the longest possible name can be written. Method: 255 bytes.
TEST_CASE("file_of_the_longest_name_is_written") {
  Folder folder;
  FileError error;
  std::string name(255, 'n');
  CHECK(write_file(folder.file(name.c_str()), "long", &error));
  CHECK(content_of(folder.file(name.c_str())) == "long");
}

// Goal: descriptors and pipes are written directly. Method: a file's descriptor by number, after data already written;
// a FIFO that a child reads.
TEST_CASE("file_writer_writes_descriptors_and_pipes") {
  Folder folder;
  FileError error;
  int file = open(folder.file("a").c_str(), O_RDWR | O_CREAT, 0666);
  REQUIRE(file >= 0);
  CHECK(write(file, "before ", 7) == 7);
  std::string named = "/dev/fd/" + std::to_string(file);
  REQUIRE(symlink(named.c_str(), folder.file("link").c_str()) == 0);
  CHECK(write_file(named, "and ", &error));
  CHECK(write_file(folder.file("link"), "after", &error));
  CHECK(content_of(folder.file("a")) == "before and after");
  close(file);
  CHECK_FALSE(can_write(named.c_str(), &error));
  REQUIRE(mkfifo(folder.file("pipe").c_str(), 0600) == 0);
  CHECK(can_write(folder.file("pipe").c_str(), &error));  // without waiting for a reader
  pid_t child = fork();
  if (child == 0) {
    char text[16] = {0};
    int pipe = open(folder.file("pipe").c_str(), O_RDONLY);
    ssize_t n = read(pipe, text, sizeof text - 1);
    _exit(n == 5 && std::strcmp(text, "piped") == 0 ? 0 : 1);
  }
  CHECK(write_file(folder.file("pipe"), "piped", &error));
  int status = -1;
  REQUIRE(waitpid(child, &status, 0) == child);
  CHECK((WIFEXITED(status) && WEXITSTATUS(status) == 0));
  CHECK(S_ISFIFO(mode_of(folder.file("pipe"))));
  FileWriter writer;
  stop_waiting_if([] { return true; });
  CHECK_FALSE(open_writer(folder.file("pipe").c_str(), &writer, &error));
  stop_waiting_if(nullptr);
  CHECK(std::string(error.text).find("nobody read") != std::string::npos);
}

// Goal: can_write() predicts open_writer() and leaves no trace. Method: each kind, compared with open_writer().
TEST_CASE("file_can_be_asked_for_beforehand") {
  Folder folder;
  FileError error, other;
  REQUIRE(write_file(folder.file("a"), "old", &error));
  std::vector<std::string> before = folder.names();
  for (const std::string& good : {folder.file("a"), folder.file("new"), std::string("/dev/null"), std::string("-")})
    CHECK(can_write(good.c_str(), &error));
  for (const std::string& bad : {folder.file("no/a"), std::string(folder.path), std::string(), folder.file("a/b")}) {
    CAPTURE(bad);
    FileWriter writer;
    CHECK_FALSE(can_write(bad.c_str(), &error));
    CHECK_FALSE(open_writer(bad.c_str(), &writer, &other));
    CHECK(std::string(error.text) == other.text);
  }
  CHECK(folder.names() == before);
  CHECK(content_of(folder.file("a")) == "old");
}

// Goal: two paths of one file are recognised, whether or not it exists. Method: links of both kinds, detours, others.
TEST_CASE("file_paths_of_one_file_are_known") {
  Folder folder;
  FileError error;
  for (const char* name : {"a", "b"}) REQUIRE(write_file(folder.file(name), name, &error));
  REQUIRE(symlink("a", folder.file("soft").c_str()) == 0);
  REQUIRE(symlink("new", folder.file("to_new").c_str()) == 0);
  REQUIRE(link(folder.file("a").c_str(), folder.file("hard").c_str()) == 0);
  auto same = [&](const char* one, const char* other) {
    bool found = is_same_file(folder.file(one).c_str(), folder.file(other).c_str());
    CHECK(is_same_file(folder.file(other).c_str(), folder.file(one).c_str()) == found);
    return found;
  };
  for (const char* name : {"a", "soft", "hard", "./a"}) CHECK(same("a", name));
  for (const char* name : {"new", "to_new", "./new"}) CHECK(same("new", name));
  for (const char* name : {"b", "new", "no/a"}) CHECK_FALSE(same("a", name));
  CHECK_FALSE(same("new", "newer"));
  CHECK_FALSE(is_same_file("/dev/null", "/dev/null"));  // two results may both be discarded
}
