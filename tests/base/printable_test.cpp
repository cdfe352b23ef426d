#include "base/printable.h"

#include <doctest/doctest.h>

#include <string>

using namespace pocketray;

namespace {

std::string printable(std::string text) {
  make_printable(&text[0], text.size());
  return text;
}

}  // namespace

// Goal: nothing remains that a terminal obeys or that hides text, while ordinary text does. Method: one example of each
// kind; every single byte; every truncation of a text.
TEST_CASE("printable_text_commands_no_terminal") {
  CHECK(printable("") == "");
  CHECK(printable("Büste, 像 🗿.pray") == "Büste, 像 🗿.pray");
  CHECK(printable("a\033[2Jb\nc\rd\te\x7f") == "a?[2Jb?c?d?e?");
  CHECK(printable("a\xc2\x9b"
                  "31m") == "a??31m");  // C1: CSI
  CHECK(printable("a\x9b"
                  "31m\x85") == "a?31m?");  // the same bare
  CHECK(printable("a\u202egnp.b\u2066\u200f\ufeff") == "a???gnp.b?????????");
  CHECK(printable("\xc0\xaf\xe0\x80\xaf\xed\xa0\x80\xf8\x88\x80\x80\x80\xff") == "??????????????");
  for (int byte = 0; byte < 256; ++byte) {
    std::string text = printable(std::string(1, static_cast<char>(byte)));
    CHECK(text[0] == (byte >= 0x20 && byte < 0x7f ? static_cast<char>(byte) : '?'));
  }
  std::string whole = "é像🗿";
  for (std::size_t length = 0; length <= whole.size(); ++length) {
    std::string text = printable(whole.substr(0, length));
    CHECK(text.size() == length);
    CHECK(text.find_first_not_of("é像🗿?") == std::string::npos);
  }
}
