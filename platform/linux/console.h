// Suspends the text console while we draw: KD_GRAPHICS, so that it does not write over the picture, and its keyboard
// off, so that key presses do not reach a shell. Both are restored on close, on exit(), on a signal that ends the
// program, on a crash and, by a helper process, if the program is killed.
#pragma once
#include "platform/linux/driver.h"

namespace platform {

// Takes over the console. Returns false if there is none, or no permission; drawing works nevertheless.
bool console_open(const Driver& driver);

// Restores it. May be called at any time, even from a signal handler; only the first call has an effect.
void console_restore();

// Returns true if a signal asked the program to end (SIGINT, SIGTERM …), and the program's own handler was called and
// wants an orderly end.
bool console_quit_requested();

// console_restore(), and restores the signal handlers.
void console_close();

}  // namespace platform
