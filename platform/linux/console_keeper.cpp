#include "platform/linux/console_keeper.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "platform/check.h"

namespace platform {
namespace {

constexpr int kDescriptorsMax = 1024;  // of a program that has just started

pid_t keeper = 0;
volatile sig_atomic_t to_keeper = -1;  // a byte says that nothing is left to restore; the end of the file does not

[[noreturn]] void keep(int console, int from_program, void (*restore)()) {
  setsid();  // survives a kill of the program's process group
  prctl(PR_SET_NAME, "console-keeper");
  const int polite[] = {SIGHUP, SIGINT, SIGQUIT, SIGTERM};
  for (int signal : polite) ::signal(signal, SIG_IGN);
  for (int i = 0; i < kDescriptorsMax; ++i)
    if (i != console && i != from_program) close(i);
  char byte;
  ssize_t count;
  do count = read(from_program, &byte, 1);
  while (count < 0 && errno == EINTR);
  if (count == 0) restore();
  _exit(0);
}

}  // namespace

void keeper_start(int console, void (*restore)()) {
  PLATFORM_CHECK(restore != nullptr);
  keeper_stop();
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) return;
  pid_t child = fork();
  if (child == 0) keep(console, ends[0], restore);
  close(ends[0]);
  if (child > 0) {
    keeper = child;
    to_keeper = ends[1];
  } else {
    close(ends[1]);
  }
}

void keeper_dismiss() {
  int pipe = to_keeper;
  if (pipe < 0) return;
  to_keeper = -1;
  int saved_errno = errno;
  ssize_t written = write(pipe, "", 1);  // fails only if the helper is gone
  (void)written;
  close(pipe);
  errno = saved_errno;
}

void keeper_stop() {
  keeper_dismiss();
  if (keeper == 0) return;
  while (waitpid(keeper, nullptr, 0) < 0 && errno == EINTR) continue;
  keeper = 0;
}

}  // namespace platform
