// How help and messages look on different terminals.
#include "session/terminal.h"

#include <doctest/doctest.h>

#include <cstdlib>
#include <initializer_list>
#include <utility>

using namespace pocketray;

// Goal: ASCII text stays, and other characters become similar ones or a question mark each. Method: some of each, cut
// UTF-8 included.
TEST_CASE("terminal_text_as_ascii") {
  const std::pair<const char*, const char*> texts[] = {{"plain (1, 2)\n", "plain (1, 2)\n"},
                                                       {"1 … 16", "1 ... 16"},
                                                       {"320×240 → ꟻLIP", "320x240 -> FLIP"},
                                                       {"naïve 日本", "na?ve ??"},
                                                       {"\xe2\x80", "?"},
                                                       {"\x80 a", "? a"},
                                                       {"", ""}};
  for (const auto& [text, ascii] : texts) CHECK(as_ascii(text) == ascii);
}

// Goal: the first locale variable that is set decides. Method: all three, set and empty.
TEST_CASE("terminal_wants_ascii_in_the_c_locale") {
  struct Row {
    const char *all, *ctype, *lang;
    bool ascii;
  };
  const Row rows[] = {{"C", "", "", true},         {"POSIX", "en_GB.UTF-8", "", true}, {"", "C", "en_GB.UTF-8", true},
                      {"", "", "C", true},         {"C.UTF-8", "C", "C", false},       {"en_GB.UTF-8", "C", "", false},
                      {"", "C.UTF-8", "C", false}, {"", "", "", false}};
  for (const Row& row : rows) {
    setenv("LC_ALL", row.all, 1), setenv("LC_CTYPE", row.ctype, 1), setenv("LANG", row.lang, 1);
    CHECK(wants_ascii() == row.ascii);
  }
  for (const char* name : {"LC_ALL", "LC_CTYPE", "LANG"}) unsetenv(name);
  CHECK_FALSE(wants_ascii());
}
