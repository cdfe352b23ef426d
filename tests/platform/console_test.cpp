#if defined(__linux__)
#include <doctest/doctest.h>
#include <linux/kd.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <vector>

#include "platform/linux/console.h"
#include "platform/linux/linux.h"
#include "recorded_driver.h"

using namespace platform;
using recorded::Machine;

namespace {

const recorded::Geometry kPanel = {"panel", 320, 240, 240, 16, 640, {11, 5}, {5, 6}, {0, 5}, {}};

// A child's effect on the console, as seen by its parent.
struct Seen {
  volatile int mode, keyboard;
  volatile int mode_while_running, keyboard_while_running;
  volatile int handler_calls, quit_events, restores;
};
Seen* seen = nullptr;

recorded::Machine child_machine;
int (*recorded_ioctl)(int, unsigned long, void*) = nullptr;
int shared_ioctl(int file, unsigned long request, void* argument) {
  int result = recorded_ioctl(file, request, argument);
  if (request == KDSETMODE && child_machine.console_mode == KD_TEXT) seen->restores = seen->restores + 1;
  seen->mode = child_machine.console_mode;
  seen->keyboard = child_machine.keyboard_mode;
  return result;
}

void count_call(int) { seen->handler_calls = seen->handler_calls + 1; }

int overflow_stack(int depth) {
  volatile char room[4096];
  room[0] = static_cast<char>(depth);
  return depth < 0 ? 0 : overflow_stack(depth + 1) + room[0];
}

// Runs `body` in a child with the screen open; returns how the child ended.
template <class Body>
int run_child(Body body, void (*term_handler)(int) = SIG_DFL) {
  void* shared = mmap(nullptr, sizeof(Seen), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  REQUIRE(shared != MAP_FAILED);
  seen = static_cast<Seen*>(shared);
  std::fflush(stdout);
  pid_t child = fork();
  if (child == 0) {
    for (int signal = 1; signal < 32; ++signal) ::signal(signal, SIG_DFL);
    ::signal(SIGTERM, term_handler);
    static std::vector<std::uint32_t> memory(320 * 240);
    recorded::reset(&child_machine, kPanel);
    recorded_ioctl = recorded::kDriver.ioctl;
    static Driver driver = recorded::kDriver;
    driver.ioctl = shared_ioctl;
    linux_driver = &driver;
    ScreenOptions options;
    options.memory = memory.data();
    options.memory_bytes = memory.size() * 4;
    ScreenFormat format;
    Error error;
    if (!kLinuxBackend.open(options, &format, &error)) _exit(99);
    seen->mode_while_running = seen->mode;
    seen->keyboard_while_running = seen->keyboard;
    body();
    _exit(98);
  }
  int status = 0;
  waitpid(child, &status, 0);
  return status;
}

void check_restored() {
  CHECK(seen->mode_while_running == KD_GRAPHICS);
  CHECK(seen->keyboard_while_running == K_OFF);
  CHECK(seen->mode == KD_TEXT);
  CHECK(seen->keyboard == K_UNICODE);
  CHECK(seen->restores == 1);
  munmap(const_cast<Seen*>(seen), sizeof(Seen));
}

}  // namespace

// Goal: console and keyboard are restored on close, on exit(), on every signal that ends a program and on a crash, and
// the program ends as it would have without us. Method: children that end in each way, against the recorded console.
TEST_CASE("console_is_restored_on_close_and_exit") {
  int status = run_child([] {
    kLinuxBackend.close();
    _exit(7);
  });
  CHECK(WEXITSTATUS(status) == 7);
  check_restored();
  status = run_child([] { std::exit(8); });
  CHECK(WEXITSTATUS(status) == 8);
  check_restored();
}
TEST_CASE("console_is_restored_on_signals_that_end_the_program") {
  for (int signal : {SIGHUP, SIGINT, SIGQUIT, SIGTERM, SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGSYS, SIGTRAP}) {
    CAPTURE(signal);
    int status = run_child([signal] { kill(getpid(), signal); });
    CHECK(WIFSIGNALED(status));
    CHECK(WTERMSIG(status) == signal);
    check_restored();
  }
}
TEST_CASE("console_is_restored_on_a_crash") {
  int status = run_child([] { std::abort(); });
  CHECK(WTERMSIG(status) == SIGABRT);
  check_restored();
  status = run_child([] {
    volatile std::uintptr_t nowhere = 64;
    *reinterpret_cast<volatile int*>(nowhere) = 1;
  });
  CHECK(WTERMSIG(status) == SIGSEGV);
  check_restored();
  status = run_child([] { std::_Exit(overflow_stack(1)); });
  CHECK(WTERMSIG(status) == SIGSEGV);
  check_restored();
}

// Goal: a program that is killed leaves a usable console behind. Method: the helper outlives the child, so wait for it.
TEST_CASE("console_is_restored_after_a_kill") {
  int status = run_child([] { kill(getpid(), SIGKILL); });
  CHECK(WTERMSIG(status) == SIGKILL);
  for (int i = 0; i < 1000 && seen->restores == 0; ++i) usleep(10'000);
  check_restored();
}

// Goal: a program that handles SIGTERM itself is asked to quit and ends in order. Method: its handler is called, poll()
// reports quit once, and we keep the console until close().
TEST_CASE("console_leaves_polite_signals_to_the_programs_own_handler") {
  int status = run_child(
      [] {
        kill(getpid(), SIGTERM);
        Event event;
        while (kLinuxBackend.poll(&event)) seen->quit_events = seen->quit_events + (event.type == EventType::quit);
        if (seen->mode != KD_GRAPHICS) _exit(97);
        kLinuxBackend.close();
        _exit(5);
      },
      count_call);
  CHECK(WEXITSTATUS(status) == 5);
  CHECK(seen->handler_calls == 1);
  CHECK(seen->quit_events == 1);
  check_restored();
}
TEST_CASE("console_ignores_signals_that_were_ignored") {
  int status = run_child(
      [] {
        kill(getpid(), SIGTERM);
        if (seen->mode != KD_GRAPHICS) _exit(97);
        kLinuxBackend.close();
        _exit(4);
      },
      SIG_IGN);
  CHECK(WEXITSTATUS(status) == 4);
  check_restored();
}

// Goal: the console left by a crashed program is repaired, and a machine without a console works. Method: both.
TEST_CASE("console_repairs_what_was_left_behind_and_may_be_absent") {
  Machine machine;
  recorded::reset(&machine, kPanel);
  machine.console_mode = KD_GRAPHICS;
  machine.keyboard_mode = K_OFF;
  REQUIRE(console_open(recorded::kDriver));
  CHECK(machine.files_open == 1);
  console_close();
  CHECK(machine.console_mode == KD_TEXT);
  CHECK(machine.keyboard_mode == K_UNICODE);
  machine.has_console = false;
  CHECK_FALSE(console_open(recorded::kDriver));
  console_close();
  CHECK(machine.files_open == 0);
}
#endif
