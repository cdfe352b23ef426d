// Quoting for gnuplot and the shell. Header only, so that programs without the accuracy library can use it.
#pragma once
#include <algorithm>
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

// A gnuplot string broken at spaces into lines of at most `line_bytes` bytes, where possible.
inline std::string gnuplot_lines(const std::string& text, std::size_t line_bytes) {
  std::string lines;
  for (std::size_t begin = 0; begin < text.size();) {
    std::size_t end = text.size();
    if (end - begin > line_bytes) {
      end = text.rfind(' ', begin + line_bytes);
      if (end == std::string::npos || end <= begin) end = std::min(text.find(' ', begin), text.size());
    }
    if (begin > 0) lines += ".\"\\n\".";
    lines += gnuplot_string(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return lines.empty() ? gnuplot_string(text) : lines;
}

}  // namespace pocketray
