#include "platform/linux/console.h"

#include <errno.h>
#include <fcntl.h>
#include <linux/kd.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>

#include "platform/linux/console_keeper.h"

namespace platform {
namespace {

// The first ones ask the program to end, and it may handle them itself. The others end it.
constexpr int kSignals[] = {SIGHUP, SIGINT, SIGQUIT, SIGTERM, SIGSEGV, SIGBUS,
                            SIGFPE, SIGILL, SIGABRT, SIGSYS,  SIGTRAP};
constexpr int kSignalCount = sizeof kSignals / sizeof kSignals[0];
constexpr int kPoliteCount = 4;

// Read by the signal handler: written before `armed` is set, and again only after it is cleared.
struct Console {
  const Driver* driver = nullptr;
  int file = -1;
  int mode = KD_TEXT, keyboard = K_UNICODE;  // before we changed them
  struct sigaction previous[kSignalCount];
  bool caught[kSignalCount] = {};
  bool exit_registered = false;
};
Console console;
volatile sig_atomic_t armed = 0;
volatile sig_atomic_t quit_requested = 0;
alignas(16) unsigned char signal_stack[16384];  // after a stack overflow the handler cannot run on the stack

void* number(int value) { return reinterpret_cast<void*>(static_cast<std::intptr_t>(value)); }

void set_modes() {
  console.driver->ioctl(console.file, KDSKBMODE, number(console.keyboard));
  console.driver->ioctl(console.file, KDSETMODE, number(console.mode));
}

void on_signal(int signal, siginfo_t* info, void* context) {
  int saved_errno = errno;
  int index = 0;
  while (index < kSignalCount - 1 && kSignals[index] != signal) ++index;
  const struct sigaction& previous = console.previous[index];
  bool has_handler =
      (previous.sa_flags & SA_SIGINFO) || (previous.sa_handler != SIG_DFL && previous.sa_handler != SIG_IGN);
  if (index < kPoliteCount && has_handler) {
    quit_requested = 1;
    if (previous.sa_flags & SA_SIGINFO)
      previous.sa_sigaction(signal, info, context);
    else
      previous.sa_handler(signal);
  } else {
    console_restore();
    sigaction(signal, &previous, nullptr);
    raise(signal);  // blocked until this handler returns; the program then ends as it would have without it
  }
  errno = saved_errno;
}

void catch_signals() {
  stack_t stack = {};
  stack.ss_sp = signal_stack;
  stack.ss_size = sizeof signal_stack;
  stack_t stack_before;
  if (sigaltstack(nullptr, &stack_before) == 0 && (stack_before.ss_flags & SS_DISABLE)) sigaltstack(&stack, nullptr);
  struct sigaction action;
  memset(&action, 0, sizeof action);
  action.sa_sigaction = on_signal;
  action.sa_flags = SA_SIGINFO | SA_ONSTACK;
  sigemptyset(&action.sa_mask);
  for (int i = 0; i < kSignalCount; ++i) {
    console.caught[i] = false;
    if (sigaction(kSignals[i], nullptr, &console.previous[i]) != 0) continue;
    if (console.previous[i].sa_handler == SIG_IGN) continue;  // set on purpose, for example by nohup
    console.caught[i] = sigaction(kSignals[i], &action, nullptr) == 0;
  }
}

// Opens the foreground virtual terminal: our own if it is one, otherwise the visible one.
int open_terminal(const Driver& driver) {
  const char* const paths[] = {"/dev/tty", "/dev/tty0"};
  for (const char* path : paths) {
    int file = driver.open(path, O_RDWR | O_NOCTTY);
    int mode;
    if (file >= 0 && driver.ioctl(file, KDGETMODE, &mode) == 0) return file;
    if (file >= 0) driver.close(file);
  }
  return -1;
}

}  // namespace

bool console_open(const Driver& driver) {
  console_close();
  quit_requested = 0;
  int file = open_terminal(driver);
  if (file < 0) return false;
  console.driver = &driver;
  console.file = file;
  if (driver.ioctl(file, KDGETMODE, &console.mode) != 0) console.mode = KD_TEXT;
  // Left by a program that crashed without restoring; returning to these would keep the console dead.
  if (console.mode == KD_GRAPHICS) console.mode = KD_TEXT;
  if (driver.ioctl(file, KDGKBMODE, &console.keyboard) != 0 || console.keyboard == K_OFF) console.keyboard = K_UNICODE;
  if (!console.exit_registered) console.exit_registered = atexit(console_restore) == 0;
  keeper_start(file, set_modes);
  catch_signals();
  armed = 1;
  bool graphics = driver.ioctl(file, KDSETMODE, number(KD_GRAPHICS)) == 0;
  bool keyboard = driver.ioctl(file, KDSKBMODE, number(K_OFF)) == 0;
  if (graphics && keyboard) return true;
  console_close();
  return false;
}

void console_restore() {
  if (!armed) return;
  armed = 0;
  set_modes();
  keeper_dismiss();
}

bool console_quit_requested() { return quit_requested != 0; }

void console_close() {
  if (console.file < 0) return;
  console_restore();
  keeper_stop();
  for (int i = 0; i < kSignalCount; ++i)
    if (console.caught[i]) sigaction(kSignals[i], &console.previous[i], nullptr);
  console.driver->close(console.file);
  console.file = -1;
}

}  // namespace platform
