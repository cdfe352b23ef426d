#include "platform/standard_streams.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include "platform/check.h"

namespace platform {
namespace {

// poll() reports a pipe as writable only if it takes this many bytes at once [POSIX, pipe(7)], so that write() cannot
// block.
constexpr size_t kLineBytesMax = 4096;

// Previous destinations of a program that logs to a file, and that file's size then.
int printed_to = -1, complained_to = -1;
off_t logged_before = 0;

int duplicate(int descriptor) { return fcntl(descriptor, F_DUPFD_CLOEXEC, STDERR_FILENO + 1); }

// The original standard error of a program that keeps quiet.
int loud_error = -1;

extern "C" void on_abort(int number) {
  char last[512];
  const off_t end = lseek(STDERR_FILENO, 0, SEEK_END), size = static_cast<off_t>(sizeof last);
  const ssize_t length = pread(STDERR_FILENO, last, sizeof last, end > size ? end - size : 0);
  if (length > 0 && write(loud_error, last, static_cast<size_t>(length)) < 0) loud_error = -1;
  signal(number, SIG_DFL);
  raise(number);
}

}  // namespace

void open_standard_streams() {
  for (int descriptor = 0; descriptor <= 2; ++descriptor) {
    if (fcntl(descriptor, F_GETFD) >= 0 || errno != EBADF) continue;
    // The lowest free number is this one. Opened in the wrong direction, so that using it is an error rather than
    // silent.
    int opened = open("/dev/null", descriptor == 0 ? O_WRONLY : O_RDONLY);
    if (opened > 2) close(opened);
  }
}

void survive_closed_pipes() { signal(SIGPIPE, SIG_IGN); }

bool is_output_closed() {
  pollfd output = {STDOUT_FILENO, POLLOUT, 0};
  return poll(&output, 1, 0) == 1 && (output.revents & (POLLERR | POLLHUP)) != 0;
}

int terminal_columns() {
  if (!isatty(STDOUT_FILENO)) return 0;
  winsize size = {};
  return ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : 80;
}

bool log_to_file(const char* path, FileError* error) {
  PLATFORM_CHECK(path != nullptr && error != nullptr);
  // Does not wait: a pipe would otherwise need its reader before anything is shown.
  int file = open(path, O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC | O_NOCTTY | O_NONBLOCK, 0666);
  if (file < 0 && errno == ENXIO) {
    snprintf(error->text, sizeof error->text, "is a pipe that nobody reads: start its reader first");
    return false;
  }
  if (file >= 0) fcntl(file, F_SETFL, fcntl(file, F_GETFL) & ~O_NONBLOCK);
  fflush(nullptr);
  if (printed_to < 0) printed_to = duplicate(STDOUT_FILENO), complained_to = duplicate(STDERR_FILENO);
  logged_before = file >= 0 ? lseek(file, 0, SEEK_END) : 0;
  bool ok = file >= 0 && dup2(file, STDOUT_FILENO) >= 0 && dup2(file, STDERR_FILENO) >= 0;
  if (!ok) snprintf(error->text, sizeof error->text, "cannot be written: %s", strerror(errno));
  if (file > STDERR_FILENO) close(file);
  return ok;
}

void withdraw_log() {
  PLATFORM_CHECK(printed_to >= 0);
  fflush(nullptr);
  // Pipes and devices keep what they have received.
  if (logged_before >= 0 && ftruncate(STDERR_FILENO, logged_before) != 0) errno = 0;
  dup2(printed_to, STDOUT_FILENO);
  dup2(complained_to, STDERR_FILENO);
}

void keep_quiet() {
  PLATFORM_CHECK(loud_error < 0);
  FILE* printed = tmpfile();
  const int nowhere = printed ? fileno(printed) : open("/dev/null", O_RDWR | O_CLOEXEC);
  loud_error = duplicate(STDERR_FILENO);
  fflush(nullptr);
  dup2(nowhere, STDERR_FILENO);
  const int output = open("/dev/null", O_WRONLY | O_CLOEXEC);
  dup2(output, STDOUT_FILENO);
  if (output > STDERR_FILENO) close(output);
  signal(SIGABRT, on_abort);
}

bool print_line_at_once(const char* line) {
  char bytes[kLineBytesMax];
  size_t length = strlen(line);
  if (length > sizeof bytes - 1) length = sizeof bytes - 1;
  memcpy(bytes, line, length);
  bytes[length++] = '\n';
  pollfd output = {STDOUT_FILENO, POLLOUT, 0};
  if (poll(&output, 1, 0) != 1 || (output.revents & POLLOUT) == 0) return false;
  return write(STDOUT_FILENO, bytes, length) == static_cast<ssize_t>(length);
}

}  // namespace platform
