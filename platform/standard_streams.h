// Standard input, output and error of a program whose parent may have closed them, or may close them later. Standard
// types only.
#pragma once
#include <cstddef>

namespace platform {

// Opens descriptors 0, 1 and 2 where the parent left them closed, so that no file or socket takes their place and is
// written to by mistake. Reading from or writing to one opened here fails, as it would have without. Call first of all.
void open_standard_streams();

// From here on a write to a pipe that nobody reads fails instead of ending the program.
void survive_closed_pipes();

// Writes a line and its end to standard output. Never waits and never fails: false means that the reader has gone, or
// takes nothing at the moment, and the line is lost.
bool print_line_at_once(const char* line);

}  // namespace platform
