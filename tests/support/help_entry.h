// Looks up an option in a program's help.
#pragma once
#include <algorithm>

#include "app/command_line.h"

namespace pocketray {

// The help's entry on an option of the program: name, type, default and description; empty if there is none.
inline std::string help_entry(CommandLine* line, const std::string& option) {
  const std::string help = line->parse({"--help"}).help;
  const std::size_t begin = help.find("\n  " + option + " ");
  if (begin == std::string::npos) return "";
  return help.substr(begin + 1, std::min(help.find("\n  -", begin + 1), help.find("\n\n", begin)) - begin);
}

}  // namespace pocketray
