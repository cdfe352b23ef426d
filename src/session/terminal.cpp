#include "session/terminal.h"

#include <algorithm>
#include <cstdlib>
#include <cstring>

#include "platform/standard_streams.h"

namespace pocketray {
namespace {

constexpr int kColumnsMin = 40, kColumnsMax = 120;  // chosen: longer lines are hard to read

constexpr struct {
  const char *text, *ascii;
} kReplacements[] = {{"…", "..."}, {"×", "x"}, {"→", "->"}, {"≤", "<="}, {"≥", ">="}, {"ꟻ", "F"},        {"–", "-"},
                     {"—", "-"},   {"’", "'"}, {"“", "\""}, {"”", "\""}, {"µ", "u"},  {"°", " degrees"}, {"²", "^2"}};

bool is_set(const char* name) {
  const char* value = std::getenv(name);
  return value && *value;
}

}  // namespace

TextStyle output_style() {
  TextStyle style;
  style.ascii_only = wants_ascii();
  const int columns = platform::terminal_columns();
  if (columns == 0) return style;
  style.column_count = std::min(std::max(columns, kColumnsMin), kColumnsMax);
  const char* terminal = std::getenv("TERM");
  style.bold = terminal && *terminal && std::strcmp(terminal, "dumb") != 0 && !is_set("NO_COLOR");
  return style;
}

bool wants_ascii() {
  for (const char* name : {"LC_ALL", "LC_CTYPE", "LANG"})
    if (is_set(name)) return std::strcmp(std::getenv(name), "C") == 0 || std::strcmp(std::getenv(name), "POSIX") == 0;
  return false;  // nothing is known, and most terminals show UTF-8
}

std::string as_ascii(const std::string& text) {
  std::string ascii;
  for (std::size_t i = 0; i < text.size();) {
    const auto byte = static_cast<unsigned char>(text[i]);
    if (byte < 0x80) {
      ascii += text[i++];
      continue;
    }
    std::size_t end = i + 1;
    while (end < text.size() && (static_cast<unsigned char>(text[end]) & 0xc0) == 0x80) ++end;
    const std::string letter = text.substr(i, end - i);
    const auto* row = std::find_if(std::begin(kReplacements), std::end(kReplacements),
                                   [&](const auto& each) { return letter == each.text; });
    ascii += row == std::end(kReplacements) ? "?" : row->ascii;
    i = end;
  }
  return ascii;
}

}  // namespace pocketray
