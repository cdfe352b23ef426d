// The text console, put aside while we draw: KD_GRAPHICS, so that it does not write over the picture, and its keyboard
// off, so that the keys pressed do not arrive in a shell. Both are given back on close, on exit(), on a signal that
// ends the program and on a crash. (Not on SIGKILL: nothing runs then.)
#pragma once
#include "platform/linux/driver.h"

namespace platform {

// Takes the console over. False: there is none, or we may not; drawing works all the same.
bool console_open(const Driver& driver);

// Gives it back. May be called at any time, from a signal handler too; only the first call does anything.
void console_restore();

// A signal asked us to end (SIGINT, SIGTERM …), and the program's own handler, which was called, wants to end in good
// order.
bool console_quit_requested();

// console_restore(), and the signals as they were.
void console_close();

}  // namespace platform
