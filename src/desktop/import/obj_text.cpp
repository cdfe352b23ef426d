#include "desktop/import/obj_text.h"

#include <algorithm>

#include "base/check.h"
#include "desktop/import/import_error.h"

namespace pocketray {
namespace {

bool is_blank(std::uint8_t c) { return c == ' ' || c == '\t'; }
bool is_line_end(std::uint8_t c) { return c == '\n' || c == '\r'; }

void refuse_utf16(const Bytes& text) {
  bool mark = text.size() >= 2 && ((text[0] == 0xFF && text[1] == 0xFE) || (text[0] == 0xFE && text[1] == 0xFF));
  bool wide = text.size() >= 4 && ((text[0] == 0) != (text[1] == 0)) && (text[0] == 0) == (text[2] == 0) &&
              (text[1] == 0) == (text[3] == 0);
  if (mark || wide) fail_import("the text is UTF-16; save it as UTF-8 or ASCII");
}

// Returns whether a line whose lists of indices may end in slashes begins at `at`.
bool has_corners(const Bytes& text, std::size_t at) {
  while (at < text.size() && is_blank(text[at])) ++at;
  return at + 1 < text.size() && (text[at] == 'f' || text[at] == 'l') && is_blank(text[at + 1]);
}

bool is_comment(const Bytes& text, std::size_t at) {
  while (at < text.size() && is_blank(text[at])) ++at;
  return at < text.size() && text[at] == '#';
}

// Returns the number of bytes of the line end at `at`.
std::size_t line_end_size(const Bytes& text, std::size_t at) {
  if (at >= text.size() || !is_line_end(text[at])) return 0;
  return text[at] == '\r' && at + 1 < text.size() && text[at + 1] == '\n' ? 2 : 1;
}

void blank_slashes_before(Bytes* text, std::size_t end, std::size_t begin) {
  for (; end > begin && (*text)[end - 1] == '/'; --end) (*text)[end - 1] = ' ';
}

}  // namespace

void tidy_obj_text(Bytes* bytes) {
  CHECK(bytes != nullptr);
  Bytes& text = *bytes;
  refuse_utf16(text);
  if (text.size() >= 3 && text[0] == 0xEF && text[1] == 0xBB && text[2] == 0xBF)
    std::fill(text.begin(), text.begin() + 3, static_cast<std::uint8_t>(' '));
  std::size_t out = 0;
  for (std::size_t at = 0; at < text.size();) {
    bool corners = has_corners(text, at), comment = is_comment(text, at);
    std::size_t line = out, joined = 0;  // lines
    while (at < text.size() && !is_line_end(text[at])) {
      std::size_t next = text[at] == '\\' && !comment ? line_end_size(text, at + 1) : 0;
      bool continued = next > 0 || (text[at] == '\\' && !comment && at + 1 == text.size());
      if (corners && (continued || is_blank(text[at]))) blank_slashes_before(&text, out, line);
      text[out++] = continued ? static_cast<std::uint8_t>(' ') : text[at];
      joined += continued;
      at += 1 + next;
    }
    if (corners) blank_slashes_before(&text, out, line);
    at += line_end_size(text, at);
    for (std::size_t i = 0; i <= joined && out < at; ++i) text[out++] = '\n';
    CHECK_LE(out, at);
  }
  text.resize(out);
}

}  // namespace pocketray
