#include "desktop/import/obj_lines.h"

#include <cmath>
#include <cstdlib>
#include <cstring>

#include "desktop/import/import_error.h"

namespace pocketray {
namespace {

bool is_blank(char c) { return c == ' ' || c == '\t'; }
bool is_digit(char c) { return c >= '0' && c <= '9'; }
const char* after_digits(const char* at, const char* end) {
  while (at < end && is_digit(*at)) ++at;
  return at;
}
const char* after_sign(const char* at, const char* end) { return at + (at < end && (*at == '+' || *at == '-')); }

const char* without_comment(const char* begin, const char* end) {
  for (const char* at = begin; at < end; ++at)
    if (*at == '#' && (at == begin || is_blank(at[-1]))) return at;
  return end;
}

double value_of(const ObjWord& word) {
  char text[64];
  const std::size_t size = static_cast<std::size_t>(word.end - word.begin);
  if (size >= sizeof text) return std::strtod(word.text().c_str(), nullptr);
  std::memcpy(text, word.begin, size);
  text[size] = 0;
  return std::strtod(text, nullptr);
}

}  // namespace

bool ObjWord::is(const char* other) const {
  const std::size_t size = static_cast<std::size_t>(end - begin);
  return std::strlen(other) == size && std::memcmp(begin, other, size) == 0;
}

bool read_number(const ObjWord& word, double* value) {
  const char* whole = after_sign(word.begin, word.end);
  const char* at = after_digits(whole, word.end);
  std::ptrdiff_t digit_count = at - whole;
  if (at < word.end && *at == '.') {
    const char* fraction = ++at;
    at = after_digits(at, word.end);
    digit_count += at - fraction;
  }
  if (digit_count == 0) return false;
  if (at < word.end) {
    if (*at != 'e' && *at != 'E') return false;
    const char* exponent = after_sign(at + 1, word.end);
    if (exponent == word.end || after_digits(exponent, word.end) != word.end) return false;
  }
  *value = value_of(word);
  return true;
}

bool read_number(const ObjWord& word, float* value) {
  double exact;
  if (!read_number(word, &exact)) return false;
  *value = static_cast<float>(exact);
  return true;
}

bool is_not_finite(const ObjWord& word) {
  const std::string text = word.text();
  char* end;
  const double value = std::strtod(text.c_str(), &end);
  return end == text.c_str() + text.size() && !std::isfinite(static_cast<float>(value));
}

ObjLine::ObjLine(const char* begin, const char* end, std::size_t number, const char* file)
    : at_(begin), end_(without_comment(begin, end)), number_(number), file_(file) {}

bool ObjLine::next(ObjWord* word) {
  while (at_ < end_ && is_blank(*at_)) ++at_;
  if (at_ == end_ || *at_ == '#') return false;
  word->begin = at_;
  while (at_ < end_ && !is_blank(*at_) && *at_ != '#') ++at_;
  word->end = at_;
  return true;
}

std::string ObjLine::rest() {
  while (at_ < end_ && is_blank(*at_)) ++at_;
  const char* last = end_;
  while (last > at_ && is_blank(last[-1])) --last;
  return std::string(at_, last);
}

void ObjLine::refuse(const std::string& what) const {
  fail_import("%.150s%sline %zu: %.200s; fix that line or export the file again", file_, *file_ ? ", " : "", number_,
              what.c_str());
}

float ObjLine::number(const ObjWord& word, float limit) const {
  float value;
  if (read_number(word, &value) && std::fabs(value) <= limit) return value;
  char text[40];
  std::snprintf(text, sizeof text, "%g", static_cast<double>(limit));
  refuse("'" + word.text().substr(0, 40) + "' is not a finite number up to " + text);
}

int ObjLine::numbers(int count, float limit, float* values) {
  ObjWord word;
  int given = 0;
  for (; next(&word); ++given) {
    if (given < count)
      values[given] = number(word, limit);
    else if (is_not_finite(word))
      number(word, limit);
  }
  return given < count ? given : count;
}

}  // namespace pocketray
