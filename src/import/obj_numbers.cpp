#include "import/obj_numbers.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>

#include "base/limits.h"
#include "import/import_error.h"

namespace pocketray {
namespace {

constexpr float kFloatMax = std::numeric_limits<float>::max();

struct Token {
  const char *begin, *end;
  bool is(const char* text) const { return text_of() == text; }
  std::string text_of() const { return std::string(begin, end); }
};

bool is_digit(char c) { return c >= '0' && c <= '9'; }
const char* after_digits(const char* at, const char* end) {
  while (at < end && is_digit(*at)) ++at;
  return at;
}
const char* after_sign(const char* at, const char* end) { return at + (at < end && (*at == '+' || *at == '-')); }

// Whether the token is a decimal number, [+-]digits[.digits][e[+-]digits], whose float is at most `limit`.
bool is_number(const Token& token, float limit) {
  const char* whole = after_sign(token.begin, token.end);
  const char* at = after_digits(whole, token.end);
  std::ptrdiff_t whole_count = at - whole, digit_count = whole_count;
  if (at < token.end && *at == '.') {
    const char* fraction = ++at;
    at = after_digits(at, token.end);
    digit_count += at - fraction;
  }
  if (digit_count == 0) return false;
  if (at == token.end && whole_count <= 18) return true;  // below 1e18: decides nearly all numbers
  if (at < token.end) {
    if (*at != 'e' && *at != 'E') return false;
    const char* exponent = after_sign(at + 1, token.end);
    if (exponent == token.end || after_digits(exponent, token.end) != token.end) return false;
  }
  float value = static_cast<float>(std::strtod(token.text_of().c_str(), nullptr));
  return std::fabs(value) <= limit;
}

// True if the C library reads the whole token as NaN, infinity or a number too large.
bool is_not_finite(const Token& token) {
  std::string text = token.text_of();
  char* end;
  double value = std::strtod(text.c_str(), &end);
  return end == text.c_str() + text.size() && !std::isfinite(static_cast<float>(value));
}

// The tokens of a line, up to a comment.
struct Line {
  const char *at, *end;
  std::size_t number;
  const char* file;  // named in errors; empty: the scene file itself

  bool next(Token* token) {
    while (at < end && (*at == ' ' || *at == '\t')) ++at;
    if (at == end || *at == '#') return false;
    token->begin = at;
    while (at < end && *at != ' ' && *at != '\t') ++at;
    token->end = at;
    return true;
  }
};

[[noreturn]] void refuse(const Line& line, const Token& token, float limit) {
  fail_import("%.150s%sline %zu: '%.40s' is not a finite number up to %g; fix that line or export the file again",
              line.file, *line.file ? ", " : "", line.number, token.text_of().c_str(), static_cast<double>(limit));
}

// The next `count` tokens must be numbers; the rest of the line must not contain non-finite ones.
void require_numbers(Line* line, int count, float limit) {
  Token token;
  for (int i = 0; line->next(&token); ++i)
    if (i < count ? !is_number(token, limit) : is_not_finite(token)) refuse(*line, token, limit);
}

// Line ends as in the library: LF, CR LF or CR.
template <class Check>
void for_each_line(const Bytes& bytes, const char* file, Check check) {
  const char* at = reinterpret_cast<const char*>(bytes.data());
  const char* stop = at + bytes.size();
  for (std::size_t number = 1; at < stop; ++number) {
    const char* end = at;
    while (end < stop && *end != '\n' && *end != '\r') ++end;
    Line line = {at, end, number, file};
    check(&line);
    at = end + (end + 1 < stop && end[0] == '\r' && end[1] == '\n' ? 2 : 1);
  }
}

// How many numbers a texture option takes; the last two of three are optional.
int option_number_count(const Token& token) {
  if (token.is("-o") || token.is("-s") || token.is("-t")) return 3;
  if (token.is("-mm")) return 2;
  return token.is("-bm") || token.is("-boost") ? 1 : 0;
}

void check_texture_options(Line* line) {
  Token token;
  bool more = line->next(&token);
  while (more) {
    int count = option_number_count(token);
    more = line->next(&token);
    for (int i = 0; i < count && more; ++i) {
      bool number = is_number(token, kFloatMax);
      if (!number && (i == 0 || is_not_finite(token))) refuse(*line, token, kFloatMax);
      if (!number) break;
      more = line->next(&token);
    }
  }
}

bool is_one_of(const Token& token, std::initializer_list<const char*> names) {
  return std::any_of(names.begin(), names.end(), [&](const char* name) { return token.is(name); });
}

}  // namespace

void check_obj_numbers(const Bytes& bytes) {
  for_each_line(bytes, "", [](Line* line) {
    Token key;
    if (!line->next(&key) || *key.begin != 'v') return;
    std::ptrdiff_t size = key.end - key.begin;
    bool coordinate = size == 1 || (size == 2 && key.begin[1] == 't');
    if (coordinate) require_numbers(line, 3, kCoordinateMax);
    if (size == 2 && key.begin[1] == 'n') require_numbers(line, 3, kFloatMax);
  });
}

void check_mtl_numbers(const Bytes& bytes, const std::string& name) {
  for_each_line(bytes, name.c_str(), [](Line* line) {
    Token key;
    if (!line->next(&key)) return;
    if (is_one_of(key, {"Ka", "Kd", "Ks", "Kt", "Tf", "Ke"})) return require_numbers(line, 3, kFloatMax);
    if (is_one_of(key, {"Ns", "Ni", "Tr", "d", "illum", "Pr", "Pm", "Ps", "Pc", "Pcr", "aniso", "anisor"}))
      return require_numbers(line, 1, kFloatMax);
    if (key.text_of().compare(0, 4, "map_") == 0 || is_one_of(key, {"bump", "disp", "refl", "norm"}))
      check_texture_options(line);
  });
}

}  // namespace pocketray
