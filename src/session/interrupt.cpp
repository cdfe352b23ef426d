#include "session/interrupt.h"

#include <csignal>

namespace pocketray {

std::atomic<bool> interrupted{false};

namespace {
extern "C" void on_interrupt(int number) {
  interrupted.store(true);
  std::signal(number, SIG_DFL);
}
}  // namespace

void catch_interrupts() {
  std::signal(SIGINT, on_interrupt);
  std::signal(SIGTERM, on_interrupt);
}

}  // namespace pocketray
