// Makes text from files and peers safe for a terminal: question marks replace anything that the terminal would treat as
// a command or that would disguise the text.
#pragma once
#include <cstddef>

namespace pocketray {

// In place, byte for byte: replaces control characters (C0, DEL, C1 in UTF-8 or not, line and paragraph separators),
// characters that change the text direction or have no width, and bytes that are not UTF-8.
void make_printable(char* text, std::size_t byte_count);

}  // namespace pocketray
