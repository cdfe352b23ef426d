// Notes for the user, one line each on stderr.
#pragma once
#include <string>

namespace pocketray {

// Returns the text with control characters, as in names of files and peers, made harmless for a terminal.
std::string shown(std::string text);
// Prints "pocketray: text", shown().
void print_note(const std::string& text);

}  // namespace pocketray
