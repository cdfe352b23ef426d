// Ctrl-C sets a flag, so that commands stop and keep finished work.
#pragma once
#include <atomic>

namespace pocketray {

extern std::atomic<bool> interrupted;

// Catches SIGINT, SIGTERM and SIGHUP from now on; a second one ends the program at once. SIGPIPE, raised when nobody
// reads the output any more, also sets the flag.
void catch_interrupts();

}  // namespace pocketray
