// Text of reports: figures, markup, file names.
#pragma once
#include <string>

namespace pocketray {

__attribute__((format(printf, 1, 2))) std::string format(const char* pattern, ...);

// Formats to `digits` significant digits, without an exponent from 1e-4 up; "∞", and "–" for NaN.
std::string figure(double value, int digits = 3);

// Escapes text for use between tags or in a quoted attribute. Control characters become spaces.
std::string escaped(const std::string& text);

std::string base64(const std::string& bytes);

// Makes a file name: keeps letters, digits and '-', replaces every other byte by '_'.
std::string file_word(const std::string& text);

}  // namespace pocketray
