#include "platform/process.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <initializer_list>

#include "platform/check.h"

namespace platform {
namespace {

constexpr int kNotStarted = 127;  // as in shells

// Runs between fork() and exec, where hardly anything but system calls is allowed.
[[noreturn]] void become(const char* path, const char* const* words, const char* folder, pid_t parent) {
  int nothing = open("/dev/null", O_RDWR);
  bool ok = nothing >= 0;
  for (int descriptor = 0; descriptor <= 2; ++descriptor) ok = ok && dup2(nothing, descriptor) >= 0;
  if (nothing > 2) close(nothing);
  ok = ok && prctl(PR_SET_PDEATHSIG, SIGKILL) == 0 && getppid() == parent;
  if (ok && (!folder || chdir(folder) == 0)) execv(path, const_cast<char* const*>(words));
  _exit(kNotStarted);
}

// become() for a program fed through a pipe.
[[noreturn]] void become_fed(const char* path, const char* const* words, int input, const char* errors, pid_t parent) {
  int nothing = open("/dev/null", O_WRONLY), told = open(errors, O_WRONLY | O_CREAT | O_TRUNC | O_NOCTTY, 0600);
  bool ok = nothing >= 0 && told >= 0 && dup2(input, 0) >= 0 && dup2(nothing, 1) >= 0 && dup2(told, 2) >= 0;
  for (int descriptor : {nothing, told, input})
    if (descriptor > 2) close(descriptor);
  signal(SIGPIPE, SIG_DFL);
  ok = ok && setpgid(0, 0) == 0 && prctl(PR_SET_PDEATHSIG, SIGKILL) == 0 && getppid() == parent;
  if (ok) execv(path, const_cast<char* const*>(words));
  _exit(kNotStarted);
}

ProcessState collect(Process* process, int options) {
  if (process->id == 0) return ProcessState::failed;
  int status = 0;
  pid_t ended;
  do ended = waitpid(static_cast<pid_t>(process->id), &status, options);
  while (ended < 0 && errno == EINTR);
  if (ended == 0) return ProcessState::running;
  process->id = 0;
  return ended > 0 && WIFEXITED(status) && WEXITSTATUS(status) == 0 ? ProcessState::succeeded : ProcessState::failed;
}

}  // namespace

bool find_program(const char* name, char* path, std::size_t path_bytes) {
  PLATFORM_CHECK(name != nullptr && path != nullptr && path_bytes > 0);
  const char* folders = getenv("PATH");
  while (folders && *folders) {
    size_t length = strcspn(folders, ":");
    int path_length = snprintf(path, path_bytes, "%.*s/%s", static_cast<int>(length), folders, name);
    struct stat info;
    if (length > 0 && path_length > 0 && static_cast<size_t>(path_length) < path_bytes && stat(path, &info) == 0 &&
        S_ISREG(info.st_mode) && access(path, X_OK) == 0)
      return true;
    folders += length + (folders[length] == ':');
  }
  return false;
}

bool start_program(const char* path, const char* const* words, const char* folder, Process* process, FileError* error) {
  PLATFORM_CHECK(path != nullptr && words != nullptr && words[0] != nullptr);
  PLATFORM_CHECK_EQ(process->id, 0);  // the previous one has been seen to end
  pid_t parent = getpid(), child = fork();
  if (child == 0) become(path, words, folder, parent);
  process->id = child > 0 ? child : 0;
  if (child < 0) snprintf(error->text, sizeof error->text, "cannot be started: %s", strerror(errno));
  return child > 0;
}

bool start_fed_program(const char* path, const char* const* words, const char* errors, Process* process,
                       FileError* error) {
  PLATFORM_CHECK(path != nullptr && words != nullptr && words[0] != nullptr && errors != nullptr);
  PLATFORM_CHECK_EQ(process->id, 0);  // the previous one has been seen to end
  PLATFORM_CHECK_LT(process->input, 0);
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) {
    snprintf(error->text, sizeof error->text, "cannot be started: %s", strerror(errno));
    return false;
  }
  pid_t parent = getpid(), child = fork();
  if (child == 0) become_fed(path, words, ends[0], errors, parent);
  int number = errno;
  close(ends[0]);
  process->id = child > 0 ? child : 0;
  process->input = ends[1];
  if (child > 0) return true;
  end_feed(process);
  snprintf(error->text, sizeof error->text, "cannot be started: %s", strerror(number));
  return false;
}

bool feed(Process* process, const void* bytes, std::size_t byte_count) {
  PLATFORM_CHECK_GE(process->input, 0);
  PLATFORM_CHECK(bytes != nullptr);
  const char* at = static_cast<const char*>(bytes);
  while (byte_count > 0) {
    ssize_t n = write(process->input, at, byte_count);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return false;
    at += n, byte_count -= static_cast<size_t>(n);
  }
  return true;
}

void end_feed(Process* process) {
  if (process->input >= 0) close(process->input);
  process->input = -1;
}

ProcessState look_at(Process* process) { return collect(process, WNOHANG); }

bool wait_for(Process* process) { return collect(process, 0) == ProcessState::succeeded; }

void kill_process(Process* process) {
  end_feed(process);
  if (process->id == 0) return;
  kill(static_cast<pid_t>(process->id), SIGKILL);
  collect(process, 0);
}

bool own_program(char* path, std::size_t path_bytes) {
  PLATFORM_CHECK(path != nullptr && path_bytes > 0);
  ssize_t length = readlink("/proc/self/exe", path, path_bytes);
  if (length <= 0 || static_cast<size_t>(length) >= path_bytes) return false;
  path[length] = 0;
  return true;
}

std::size_t own_words(char* words, std::size_t words_bytes) {
  PLATFORM_CHECK(words != nullptr && words_bytes > 0);
  int descriptor = open("/proc/self/cmdline", O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) return 0;
  size_t count = 0;
  ssize_t n = 1;
  while (n > 0 && count < words_bytes) {
    n = read(descriptor, words + count, words_bytes - count);
    if (n > 0) count += static_cast<size_t>(n);
  }
  close(descriptor);
  return n == 0 && count > 0 && words[count - 1] == 0 ? count : 0;
}

}  // namespace platform
