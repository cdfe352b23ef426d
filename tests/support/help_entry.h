// Looks up an option in a program's help.
#pragma once
#include <string>

#include "app/command_line.h"

namespace pocketray {

// The help on one option of the program, its words separated by single spaces; empty if there is none.
inline std::string help_entry(CommandLine* line, const std::string& option) {
  std::string words;
  for (char c : line->parse({"--help", option}).help) {
    const bool is_space = c == ' ' || c == '\n';
    if (!is_space || (!words.empty() && words.back() != ' ')) words += is_space ? ' ' : c;
  }
  return words;
}

}  // namespace pocketray
