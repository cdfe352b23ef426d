// Quoting for gnuplot and the shell. Header only, so that programs without the accuracy library can use it.
#pragma once
#include <string>

namespace pocketray {

// Quotes text as a shell word or a gnuplot string, on one line whatever bytes it holds.
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

}  // namespace pocketray
