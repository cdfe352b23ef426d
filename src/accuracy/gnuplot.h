// What whoever draws with gnuplot needs. All of it here, so that a program without the accuracy library may use it,
// too.
#pragma once
#include <cstdlib>
#include <string>
#include <vector>

namespace pocketray {

// As a word of the shell, and as a string of gnuplot: of one line, whatever bytes it holds.
inline std::string quoted(const std::string& text, const char* quote_within) {
  std::string result = "'";
  for (char c : text)
    if (c == '\'')
      result += quote_within;
    else
      result += c;
  return result + "'";
}
inline std::string shell_word(const std::string& text) { return quoted(text, "'\\''"); }
inline std::string gnuplot_string(const std::string& text) {
  std::string line = text;
  for (char& c : line)
    if (static_cast<unsigned char>(c) < ' ') c = ' ';
  return quoted(line, "''");
}

// Runs scripts, one after the other, in the folder that they are in. False: there is no gnuplot that did.
inline bool run_gnuplot(const std::string& folder, const std::vector<std::string>& scripts) {
  std::string command = "cd -- " + shell_word(folder) + " && gnuplot";
  for (const std::string& script : scripts) command += " " + shell_word(script);
  return std::system((command + " >/dev/null 2>&1").c_str()) == 0;
}

}  // namespace pocketray
