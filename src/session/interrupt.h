// Ctrl-C sets a flag, so that commands stop and keep finished work.
#pragma once
#include <atomic>

namespace pocketray {

extern std::atomic<bool> interrupted;

// Catches SIGINT, SIGTERM and SIGHUP from now on; a second one ends the program at once. SIGPIPE, where nobody reads
// what is printed any more, sets the flag too.
void catch_interrupts();

}  // namespace pocketray
