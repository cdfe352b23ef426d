#include "session/interrupt.h"

#include <csignal>

#include "platform/file.h"

namespace pocketray {

std::atomic<bool> interrupted{false};

namespace {
extern "C" void on_interrupt(int number) {
  interrupted.store(true);
  std::signal(number, SIG_DFL);
}
// The write that raised it fails, and so do later ones.
extern "C" void on_closed_pipe(int) { interrupted.store(true); }
}  // namespace

void catch_interrupts() {
  platform::stop_waiting_if([] { return interrupted.load(); });
  std::signal(SIGINT, on_interrupt);
  std::signal(SIGTERM, on_interrupt);
  std::signal(SIGPIPE, on_closed_pipe);
  std::signal(SIGXFSZ, SIG_IGN);                                                   // the write fails
  if (std::signal(SIGHUP, on_interrupt) == SIG_IGN) std::signal(SIGHUP, SIG_IGN);  // by nohup
}

}  // namespace pocketray
