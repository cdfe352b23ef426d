// A helper process that restores the console if this program is killed (SIGKILL, out of memory) and no handler of its
// own can run. If the helper is killed, too, the console stays as it is.
#pragma once

namespace platform {

// Starts the helper, which calls `restore` if this program ends without keeper_dismiss(). It keeps only `console` open.
// Without room for another process, no helper is started.
void keeper_start(int console, void (*restore)());
// Tells the helper that nothing is left to restore. Safe in a signal handler; only the first call has an effect.
void keeper_dismiss();
// Dismisses the helper and waits until it has ended.
void keeper_stop();

}  // namespace platform
