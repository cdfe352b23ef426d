#include "desktop/accuracy/text.h"

#include <cmath>
#include <cstdarg>
#include <cstdio>

namespace pocketray {

std::string format(const char* pattern, ...) {
  va_list arguments, again;
  va_start(arguments, pattern);
  va_copy(again, arguments);
  int length = std::vsnprintf(nullptr, 0, pattern, arguments);
  std::string text(length > 0 ? static_cast<std::size_t>(length) : 0, '\0');
  std::vsnprintf(&text[0], text.size() + 1, pattern, again);
  va_end(arguments);
  va_end(again);
  return text;
}

std::string figure(double value, int digits) {
  if (std::isnan(value)) return "–";
  std::string sign = value < 0 ? "−" : "";
  double size = std::fabs(value);
  if (std::isinf(size)) return sign + "∞";
  if (size == 0) return "0";
  if (size >= 1e6) return sign + format("%.*e", digits - 1, size);
  std::string text = size >= std::pow(10.0, digits - 1) ? format("%.0f", size) : format("%#.*g", digits, size);
  if (text.back() == '.') text.pop_back();
  std::size_t exponent = text.find("e-0");
  if (exponent != std::string::npos) text.erase(exponent + 2, 1);
  return sign + text;
}

std::string escaped(const std::string& text) {
  std::string result;
  for (char c : text) {
    if (c == '&')
      result += "&amp;";
    else if (c == '<')
      result += "&lt;";
    else if (c == '>')
      result += "&gt;";
    else if (c == '"')
      result += "&quot;";
    else if (c == '\'')
      result += "&#39;";
    else
      result += static_cast<unsigned char>(c) < ' ' || c == 0x7f ? ' ' : c;
  }
  return result;
}

std::string base64(const std::string& bytes) {
  constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string result;
  result.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::size_t count = bytes.size() - i < 3 ? bytes.size() - i : 3;
    unsigned group = 0;
    for (std::size_t k = 0; k < 3; ++k)
      group = group << 8 | (k < count ? static_cast<unsigned char>(bytes[i + k]) : 0u);
    for (std::size_t k = 0; k < 4; ++k) result += k <= count ? kDigits[group >> (18 - 6 * k) & 63] : '=';
  }
  return result;
}

std::string file_word(const std::string& text) {
  std::string result;
  for (char c : text) {
    bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-';
    result += plain ? c : '_';
  }
  return result;
}

}  // namespace pocketray
