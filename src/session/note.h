// Notes for the user, one line each on stderr.
#pragma once
#include <string>

namespace pocketray {

// Prints "pocketray: text", with control characters in names of files and peers made harmless.
void print_note(std::string text);

}  // namespace pocketray
