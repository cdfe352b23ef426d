// Text of files and peers made fit for a terminal: what it would take for a command, or what would show other text than
// there is, becomes question marks.
#pragma once
#include <cstddef>

namespace pocketray {

// In place, byte for byte: control characters (C0, DEL, C1 whether or not as UTF-8, line and paragraph separators),
// what changes the direction of text or takes no room, and bytes that are no UTF-8.
void make_printable(char* text, std::size_t byte_count);

}  // namespace pocketray
