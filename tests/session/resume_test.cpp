// Lists of finished frames.
#include "session/resume.h"

#include <doctest/doctest.h>
#include <sys/stat.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <fstream>

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

// Goal: a place that cannot be written is told. Method: a missing folder, a folder in its place.
TEST_CASE("journal_needs_a_place") {
  Folder folder;
  FrameJournal journal;
  CHECK_FALSE(begin_journal(folder / "no/such.resume", "a", {}, &journal).ok);
  REQUIRE(mkdir((folder / "taken").c_str(), 0777) == 0);
  const Status status = begin_journal(folder / "taken", "a", {}, &journal);
  CHECK(std::strstr(status.message, "is a folder") != nullptr);
  CHECK(journal.file == nullptr);
}
