// A helper process that restores the console if this program is killed (SIGKILL, out of memory), when no handler of its
// own can run. Whoever kills the helper, too, leaves the console as it is.
#pragma once

namespace platform {

// Starts the helper, which calls `restore` if this program ends without keeper_dismiss(). It keeps only `console` open.
// Without room for another process there is none.
void keeper_start(int console, void (*restore)());
// There is nothing left to restore. Safe in a signal handler; only the first call has an effect.
void keeper_dismiss();
// Dismisses the helper and waits until it is gone.
void keeper_stop();

}  // namespace platform
