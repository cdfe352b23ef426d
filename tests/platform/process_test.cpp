// Starting programs.
#include "platform/process.h"

#include <doctest/doctest.h>
#include <signal.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

#include <chrono>
#include <cstring>
#include <fstream>
#include <string>
#include <thread>
#include <vector>

using namespace platform;

namespace {

struct Folder {
  char path[1024] = {0};
  Folder() {
    FileError error;
    REQUIRE_MESSAGE(make_temporary_folder(path, sizeof path, &error), error.text);
  }
  ~Folder() { remove_folder(path); }
  std::string file(const char* name) const { return std::string(path) + "/" + name; }
};

bool start_shell(const char* script, const char* word, const char* folder, Process* process) {
  const char* words[] = {"sh", "-c", script, "sh", word, nullptr};
  FileError error;
  return start_program("/bin/sh", words, folder, process, &error);
}

bool is_there(const std::string& path) { return access(path.c_str(), F_OK) == 0; }

}  // namespace

// Goal: a program receives its words unchanged and runs in its folder; its end is reported. Method: a shell that
// compares a word that no shell would leave unchanged, writes a file and ends with either status or a signal, or does
// not exist.
TEST_CASE("process_runs_with_its_words_in_its_folder") {
  Folder folder;
  Process process;
  REQUIRE(
      start_shell("test \"$1\" = 'a b$HOME\"*' && echo >made && ! read line", "a b$HOME\"*", folder.path, &process));
  CHECK(wait_for(&process));
  CHECK(is_there(folder.file("made")));
  CHECK_FALSE(is_there("made"));
  CHECK(process.id == 0);
  CHECK(look_at(&process) == ProcessState::failed);
  for (const char* script : {"exit 3", "kill -TERM $$"}) {
    REQUIRE(start_shell(script, "", nullptr, &process));
    CHECK_FALSE(wait_for(&process));
  }
  const char* words[] = {"none", nullptr};
  FileError error;
  REQUIRE(start_program(folder.file("none").c_str(), words, nullptr, &process, &error));
  CHECK_FALSE(wait_for(&process));
  REQUIRE(start_shell("exit 0", "", folder.file("none").c_str(), &process));
  CHECK_FALSE(wait_for(&process));
}

// Goal: a program reads what it is fed, to the last byte, and its errors arrive in a file; one that ends early is
// noticed and ends nothing else. Method: a shell that counts more bytes than a pipe holds; one that reads none.
TEST_CASE("process_is_fed") {
  Folder folder;
  Process process;
  FileError error;
  const std::string counted = folder.file("counted"), errors = folder.file("errors");
  const std::string count = "wc -c >'" + counted + "'; echo told >&2";
  const char* counting[] = {"sh", "-c", count.c_str(), nullptr};
  REQUIRE(start_fed_program("/bin/sh", counting, errors.c_str(), &process, &error));
  const std::vector<char> bytes(300'000, 'x');
  CHECK(feed(&process, bytes.data(), bytes.size()));
  CHECK(feed(&process, bytes.data(), 7));
  end_feed(&process);
  CHECK(wait_for(&process));
  std::ifstream number(counted), line(errors);
  int sum = 0;
  std::string told;
  CHECK((number >> sum && sum == 300'007));
  CHECK((line >> told && told == "told"));

  const auto usual = signal(SIGPIPE, SIG_IGN);
  const char* deaf[] = {"sh", "-c", "exec <&-; exit 4", nullptr};
  REQUIRE(start_fed_program("/bin/sh", deaf, errors.c_str(), &process, &error));
  bool taken = true;
  for (int i = 0; i < 100 && taken; ++i) taken = feed(&process, bytes.data(), bytes.size());
  CHECK_FALSE(taken);
  kill_process(&process);
  CHECK(process.input < 0);
  signal(SIGPIPE, usual);
}

// Goal: a program is watched without waiting, and killed. Method: one that sleeps for longer than the test may take.
TEST_CASE("process_is_watched_and_killed") {
  Process process;
  REQUIRE(start_shell("exec sleep 600", "", nullptr, &process));
  pid_t id = static_cast<pid_t>(process.id);
  CHECK(look_at(&process) == ProcessState::running);
  kill_process(&process);
  CHECK(process.id == 0);
  CHECK(kill(id, 0) != 0);
  kill_process(&process);  // nothing
  REQUIRE(start_shell("exit 0", "", nullptr, &process));
  ProcessState state;
  while ((state = look_at(&process)) == ProcessState::running)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  CHECK(state == ProcessState::succeeded);
}

// Goal: no program outlives the thread that started it. Method: a sleeping one, started by a thread that ends.
TEST_CASE("process_ends_with_who_started_it") {
  Process process;
  Folder folder;
  std::thread([&] {
    CHECK(start_shell("echo >started; exec sleep 600", "", folder.path, &process));
    while (!is_there(folder.file("started"))) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }).join();
  CHECK_FALSE(wait_for(&process));
}

// Goal: programs are found as by a shell. Method: a PATH with an empty folder, a missing one, one with a non-executable
// file and one with the program; room for the path, and one byte less.
TEST_CASE("process_program_is_found_along_the_path") {
  Folder data, programs;
  std::string old_path = getenv("PATH") ? getenv("PATH") : "";
  for (const Folder* folder : {&data, &programs}) {
    FileWriter writer;
    FileError error;
    REQUIRE(open_writer(folder->file("tool").c_str(), &writer, &error));
    REQUIRE(close_writer(&writer, &error));
  }
  REQUIRE(chmod(programs.file("tool").c_str(), 0755) == 0);
  setenv("PATH", (":/none:" + std::string(data.path) + ":" + programs.path).c_str(), 1);
  char path[1024];
  std::string expected = programs.file("tool");
  CHECK(find_program("tool", path, sizeof path));
  CHECK(path == expected);
  CHECK(find_program("tool", path, expected.size() + 1));
  CHECK_FALSE(find_program("tool", path, expected.size()));
  CHECK_FALSE(find_program("no_tool", path, sizeof path));
  setenv("PATH", old_path.c_str(), 1);
}

// Goal: a program knows its file and its words. Method: this test's; one byte too little room.
TEST_CASE("process_knows_what_it_was_started_as") {
  char path[1024], words[8192];
  REQUIRE(own_program(path, sizeof path));
  CHECK(std::string(path).find("test_platform") != std::string::npos);
  CHECK_FALSE(own_program(path, std::strlen(path)));
  std::size_t bytes = own_words(words, sizeof words);
  REQUIRE(bytes > 1);
  CHECK(std::string(words).find("test_platform") != std::string::npos);
  CHECK(own_words(words, bytes) == 0);
  CHECK(own_words(words, bytes + 1) == bytes);
}
