// One line on stderr for what a person should know.
#pragma once
#include <string>

namespace pocketray {

// Prints "pocketray: text", fit for a terminal whatever names of files and peers are in it.
void print_note(std::string text);

}  // namespace pocketray
