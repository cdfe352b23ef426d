#include "platform/standard_streams.h"

#include <doctest/doctest.h>
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <sys/ioctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <initializer_list>

using namespace platform;

namespace {

// Runs `body` in a separate process; returns whether it returned true.
template <class Body>
bool holds_in_child(Body body) {
  pid_t child = fork();
  if (child == 0) _exit(body() ? 0 : 1);
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

}  // namespace

// Goal: nothing else takes the place of a standard stream, and one that was closed stays unusable. Method: each subset
// closed, in a separate process.
TEST_CASE("standard_streams_are_all_open") {
  for (int closed = 0; closed < 8; ++closed) {
    CAPTURE(closed);
    CHECK(holds_in_child([=] {
      for (int i = 0; i < 3; ++i)
        if (closed >> i & 1) close(i);
      open_standard_streams();
      bool ok = true;
      for (int i = 0; i < 3; ++i) ok = ok && fcntl(i, F_GETFD) >= 0;
      char byte = 'x';
      if (closed & 1) ok = ok && read(0, &byte, 1) < 0;
      for (int i = 1; i < 3; ++i)
        if (closed >> i & 1) ok = ok && write(i, &byte, 1) < 0;
      int next = open("/dev/null", O_RDONLY);
      return ok && next > 2;
    }));
  }
}

// Goal: a line is printed or lost, without waiting. Method: a pipe that is read, one that nobody reads until it is
// full, one whose reader has gone.
TEST_CASE("line_is_printed_at_once_or_lost") {
  CHECK(holds_in_child([] {
    alarm(20);
    int ends[2];
    if (pipe(ends) != 0 || dup2(ends[1], 1) != 1) return false;
    char text[8] = {0};
    if (!print_line_at_once("hello") || read(ends[0], text, 7) != 6 || std::strcmp(text, "hello\n") != 0) return false;
    int lines = 0;
    while (lines < 1'000'000 && print_line_at_once("what nobody reads")) ++lines;
    return lines > 10 && lines < 1'000'000;
  }));
  CHECK(holds_in_child([] {
    survive_closed_pipes();
    int ends[2];
    if (pipe(ends) != 0 || dup2(ends[1], 1) != 1) return false;
    close(ends[0]);
    return !print_line_at_once("hello") && !print_line_at_once("again");
  }));
}

// Goal: a quiet program prints nothing, but if it aborts, the end of what it printed is seen, or its death would be a
// riddle. Method: in a child whose outputs are pipes, with and without an abort.
TEST_CASE("quiet_program_is_heard_only_when_it_aborts") {
  for (bool aborts : {false, true}) {
    CAPTURE(aborts);
    int outputs[2], errors[2];
    REQUIRE(pipe(outputs) == 0);
    REQUIRE(pipe(errors) == 0);
    std::fflush(nullptr);  // or the child does
    pid_t child = fork();
    if (child == 0) {
      dup2(outputs[1], 1), dup2(errors[1], 2);
      keep_quiet();
      std::printf("table\n");
      for (int i = 0; i < 1000; ++i) std::fprintf(stderr, "note %d\n", i);
      std::fflush(nullptr);
      if (aborts) std::abort();
      _exit(0);
    }
    close(outputs[1]), close(errors[1]);
    char text[2000] = {0};
    CHECK(read(outputs[0], text, sizeof text - 1) == 0);
    ssize_t length = read(errors[0], text, sizeof text - 1);
    CHECK(length == (aborts ? 512 : 0));
    if (aborts) CHECK(std::strcmp(text + 512 - 9, "note 999\n") == 0);
    int status = 0;
    waitpid(child, &status, 0);
    CHECK(WIFSIGNALED(status) == aborts);
    if (aborts) CHECK(WTERMSIG(status) == SIGABRT);
    close(outputs[0]), close(errors[0]);
  }
}

// Goal: the width is the terminal's, 80 if it has none, and 0 where there is no terminal. Method: a pseudo-terminal of
// each width as standard output, and a pipe.
TEST_CASE("standard_streams_know_the_terminals_width") {
  for (int columns : {0, 57, 132}) {
    CAPTURE(columns);
    CHECK(holds_in_child([=] {
      const int master = posix_openpt(O_RDWR | O_NOCTTY);
      if (master < 0 || grantpt(master) != 0 || unlockpt(master) != 0) return false;
      const int terminal = open(ptsname(master), O_RDWR | O_NOCTTY);
      winsize size = {};
      size.ws_col = static_cast<unsigned short>(columns);
      if (ioctl(terminal, TIOCSWINSZ, &size) != 0) return false;
      dup2(terminal, STDOUT_FILENO);
      return terminal_columns() == (columns ? columns : 80);
    }));
  }
  CHECK(holds_in_child([] {
    int ends[2];
    if (pipe(ends) != 0) return false;
    dup2(ends[1], STDOUT_FILENO);
    return terminal_columns() == 0;
  }));
}
