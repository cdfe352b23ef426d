// Standard input, output and error of a program whose parent may have closed them, or may close them later. Standard
// types only.
#pragma once
#include "platform/file.h"

namespace platform {

// Opens descriptors 0, 1 and 2 if the parent left them closed, so that no file or socket takes their place and is
// written to by mistake. Using a descriptor opened here fails, as it would have without. Must be called first.
void open_standard_streams();

// From here on, a write to a pipe without a reader fails instead of ending the program.
void survive_closed_pipes();
// True if standard output is a pipe or socket whose reader has gone.
bool is_output_closed();

// Columns of the terminal that standard output is; 80 if it does not tell, and 0 if it is no terminal.
int terminal_columns();

// From here on, standard output and error go to the end of that file, which is created if missing.
bool log_to_file(const char* path, FileError* error);
// Reverts that: the file has its previous content again, and printed text goes to its previous destination.
void withdraw_log();

// From here on, printed text is lost, except that its end goes to the original standard error if the program
// aborts.
void keep_quiet();

// Writes a line with its terminator to standard output. Never waits and never fails: false means that the reader is
// gone or currently takes nothing, and that the line is lost.
bool print_line_at_once(const char* line);

}  // namespace platform
