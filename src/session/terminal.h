// How text may look where it is printed.
#pragma once
#include <string>

namespace pocketray {

struct TextStyle {
  int column_count = 80;
  bool bold = false;        // headings are bold
  bool ascii_only = false;  // the locale has no other characters
};

// Style of standard output: as wide as its terminal; bold on one that understands it, unless NO_COLOR is set.
TextStyle output_style();
// Returns whether the locale's variables ask for plain ASCII: LC_ALL=C.
bool wants_ascii();

// Replaces "…", "×", "→" and other characters beyond ASCII by similar ones, or by a question mark.
std::string as_ascii(const std::string& text);

}  // namespace pocketray
