// Text of reports: figures, markup, names of files.
#pragma once
#include <string>

namespace pocketray {

__attribute__((format(printf, 1, 2))) std::string format(const char* pattern, ...);

// To so many significant digits, without an exponent from 1e-4 up; "∞", and "–" for what is not a number.
std::string figure(double value, int digits = 3);

// As text between tags or in a quoted attribute. Control characters become spaces.
std::string escaped(const std::string& text);

std::string base64(const std::string& bytes);

// What may stand in the name of a file: letters, digits, '-'; '_' for each other byte.
std::string file_word(const std::string& text);

}  // namespace pocketray
