// Lines, words and numbers of OBJ and MTL texts. Numbers are parsed strictly, and damage is reported by line (HARDCASES
// row 8).
#pragma once
#include <cstddef>
#include <string>
#include <vector>

#include "desktop/import/files.h"

namespace pocketray {

struct ObjWord {
  const char *begin, *end;
  std::string text() const { return std::string(begin, end); }
  bool is(const char* text) const;
};

// A line without its comment: '#' starts one at the beginning or after a blank, and ends words, but not names.
class ObjLine {
 public:
  // `file` is named in errors; empty: the scene file itself.
  ObjLine(const char* begin, const char* end, std::size_t number, const char* file);
  bool next(ObjWord* word);
  // Returns the rest without blanks at its ends; a name may contain blanks.
  std::string rest();
  // Parses the word as a number of at most `limit`; refuses any other.
  float number(const ObjWord& word, float limit) const;
  // Parses up to `count` words as numbers; refuses other words, and a non-finite number after them. Returns how many it
  // parsed.
  int numbers(int count, float limit, float* values);
  [[noreturn]] void refuse(const std::string& what) const;
  std::size_t number() const { return number_; }

 private:
  const char *at_, *end_;
  std::size_t number_;
  const char* file_;
};

// True if the word is a decimal number, [+-]digits[.digits][e[+-]digits]; stores it, infinite if it is too large.
bool read_number(const ObjWord& word, double* value);
bool read_number(const ObjWord& word, float* value);
// Returns whether the word is NaN, infinity or a number too large for a float.
bool is_not_finite(const ObjWord& word);

// Calls visit(ObjLine*) for each line. Lines end in LF, CR LF or CR.
template <class Visit>
void for_each_line(const Bytes& bytes, const char* file, Visit visit) {
  const char* at = reinterpret_cast<const char*>(bytes.data());
  const char* stop = at + bytes.size();
  for (std::size_t number = 1; at < stop; ++number) {
    const char* end = at;
    while (end < stop && *end != '\n' && *end != '\r') ++end;
    ObjLine line(at, end, number, file);
    visit(&line);
    at = end + (end + 1 < stop && end[0] == '\r' && end[1] == '\n' ? 2 : 1);
  }
}

}  // namespace pocketray
