// Lists of finished frames.
#include "session/resume.h"

#include <doctest/doctest.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>

#include "platform/file.h"

using namespace pocketray;

namespace {

using Frames = std::vector<std::uint32_t>;

struct Folder {
  char path[32] = "/tmp/pocketray_XXXXXX";
  Folder() { REQUIRE(mkdtemp(path) != nullptr); }
  ~Folder() { platform::remove_folder(path); }
  std::string operator/(const char* name) const { return std::string(path) + "/" + name; }
};

void write_text(const std::string& path, const std::string& text) { std::ofstream(path, std::ios::binary) << text; }

std::string text_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return std::string(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>());
}

// The frames that a file of this text lists for "identity"; its error in *told.
Frames frames_in(const std::string& text, std::string* told) {
  Folder folder;
  Frames frames = {99};
  write_text(folder / "j", text);
  const Status status = read_journal(folder / "j", "identity", &frames);
  *told = status.ok ? "" : status.message;
  return frames;
}

}  // namespace

// Goal: what is added is found again, by the next run and the one after it, until the file is removed. Method: two runs
// of a sequence.
TEST_CASE("journal_lists_finished_frames") {
  Folder folder;
  const std::string path = journal_path(folder / "out.png");
  CHECK(path == folder / "out.png.resume");
  Frames frames = {7};
  REQUIRE(read_journal(path, "a", &frames).ok);
  CHECK(frames.empty());
  {
    FrameJournal journal;
    REQUIRE(begin_journal(path, "a", {}, &journal).ok);
    for (std::uint32_t frame : {0u, 1u, 999999u}) add_to_journal(&journal, frame);
    REQUIRE(read_journal(path, "a", &frames).ok);  // while it is written
    CHECK(frames == Frames{0, 1, 999999});
  }
  FrameJournal journal;
  REQUIRE(begin_journal(path, "a", frames, &journal).ok);
  add_to_journal(&journal, 2);
  REQUIRE(read_journal(path, "a", &frames).ok);
  CHECK(frames == Frames{0, 1, 999999, 2});
  CHECK_FALSE(read_journal(path, "b", &frames).ok);
  remove_journal(&journal);
  add_to_journal(&journal, 3);
  CHECK(platform::file_stamp(path.c_str()) == 0);
}

// Goal: a list cut off or damaged lists fewer frames or is refused, never others. Method: every prefix; other texts.
TEST_CASE("journal_of_a_crashed_run_lists_whole_lines") {
  const std::string head = "pocketray-resume 1 identity\n", text = head + "0\n12\n345\n";
  std::string told;
  CHECK(frames_in(text, &told) == Frames{0, 12, 345});
  for (std::size_t count = 1; count < text.size(); ++count) {
    CAPTURE(count);
    const Frames frames = frames_in(text.substr(0, count), &told);
    CHECK(told.empty() == (count >= head.size()));
    CHECK(frames.size() ==
          static_cast<std::size_t>(std::count(text.begin(), text.begin() + static_cast<long>(count), '\n')) -
              (count >= head.size()));
  }
  CHECK(frames_in(head + "1\n-2\n3\n", &told) == Frames{1});
  CHECK(frames_in(head + "1\n99999999999\n3\n", &told) == Frames{1});
  CHECK(frames_in(head + std::string("1\n\0\n2\n", 6), &told) == Frames{1});
  frames_in("PNG", &told);
  CHECK(told.find("is not a list of finished frames: delete it") != std::string::npos);
  frames_in("pocketray-resume 1 other\n0\n", &told);
  CHECK(told.find("another scene, version or options") != std::string::npos);
}

// Goal: nothing of the user's is overwritten, through links of either kind or by the list itself. Method: a file that
// is no list, an empty one, symbolic links to a list, to another file and to nothing, and a list with a second name; a
// run that fails leaves all as it was.
TEST_CASE("journal_overwrites_nothing_but_a_list") {
  Folder folder;
  const std::string list = "pocketray-resume 1 other\n7\n";
  write_text(folder / "diary", "dear diary, nothing happened today");
  write_text(folder / "list", list);
  write_text(folder / "empty", "");
  for (const char* target : {"diary", "list", "nothing"})
    REQUIRE(symlink(target, (folder / (std::string("to_") + target).c_str()).c_str()) == 0);
  for (const char* name : {"diary", "empty", "to_diary", "to_list", "to_nothing"}) {
    CAPTURE(name);
    FrameJournal journal;
    const Status status = begin_journal(folder / name, "a", {}, &journal);
    CHECK_FALSE(status.ok);
    CHECK_MESSAGE(std::strstr(status.message, "remove it, or name another -o") != nullptr, status.message);
    add_to_journal(&journal, 1);
    remove_journal(&journal);
  }
  CHECK(text_of(folder / "diary") == "dear diary, nothing happened today");
  CHECK(text_of(folder / "list") == list);
  CHECK(platform::file_stamp((folder / "nothing").c_str()) == 0);
  CHECK(platform::file_stamp((folder / "to_list").c_str()) != 0);

  REQUIRE(link((folder / "list").c_str(), (folder / "second").c_str()) == 0);
  REQUIRE(chmod((folder / "list").c_str(), 0640) == 0);
  FrameJournal journal;
  REQUIRE(begin_journal(folder / "list", "a", {3}, &journal).ok);
  add_to_journal(&journal, 4);
  CHECK(text_of(folder / "list") == "pocketray-resume 1 a\n3\n4\n");
  CHECK(text_of(folder / "second") == list);
  struct stat info;
  REQUIRE(stat((folder / "list").c_str(), &info) == 0);
  CHECK((info.st_mode & 0777) == 0640);
}

// Goal: what is no file is refused at once: opening a pipe would wait for a reader, perhaps forever. Method: a pipe
// that nobody reads, and a link to a device, in a process with an alarm.
TEST_CASE("journal_does_not_wait_for_a_pipe") {
  Folder folder;
  REQUIRE(mkfifo((folder / "pipe").c_str(), 0666) == 0);
  REQUIRE(symlink("/dev/null", (folder / "device").c_str()) == 0);
  for (const char* name : {"pipe", "device"}) {
    CAPTURE(name);
    const std::string path = folder / name;
    const pid_t child = fork();
    if (child == 0) {
      alarm(20);
      FrameJournal journal;
      const Status status = begin_journal(path, "a", {}, &journal);
      _exit(!status.ok && std::strstr(status.message, "remove it, or name another -o") ? 0 : 1);
    }
    int status = -1;
    REQUIRE(waitpid(child, &status, 0) == child);
    CHECK((WIFEXITED(status) && WEXITSTATUS(status) == 0));
  }
}

// Goal: each frame is in the file as soon as it is added, and no other file is left, even if the program is killed.
// Method: SIGKILL after the third frame.
TEST_CASE("journal_survives_being_killed") {
  Folder folder;
  const std::string path = folder / "j";
  const pid_t child = fork();
  if (child == 0) {
    FrameJournal journal;
    if (!begin_journal(path, "a", {5}, &journal).ok) _exit(1);
    for (std::uint32_t frame : {6u, 7u, 8u}) add_to_journal(&journal, frame);
    raise(SIGKILL);
  }
  int status = 0;
  REQUIRE(waitpid(child, &status, 0) == child);
  REQUIRE(WIFSIGNALED(status));
  Frames frames;
  REQUIRE(read_journal(path, "a", &frames).ok);
  CHECK(frames == Frames{5, 6, 7, 8});
  int count = 0;
  platform::FileError error;
  CHECK(platform::list_folder(
      folder.path, [](void* counted, const char*) { ++*static_cast<int*>(counted); }, &count, &error));
  CHECK(count == 1);
}

// Goal: a place that cannot be written is told. Method: a missing folder, a folder in its place.
TEST_CASE("journal_needs_a_place") {
  Folder folder;
  FrameJournal journal;
  CHECK_FALSE(begin_journal(folder / "no/such.resume", "a", {}, &journal).ok);
  REQUIRE(mkdir((folder / "taken").c_str(), 0777) == 0);
  const Status status = begin_journal(folder / "taken", "a", {}, &journal);
  CHECK(std::strstr(status.message, "is a folder") != nullptr);
  CHECK(journal.writer.descriptor < 0);
}
