// Errors inside import/ are exceptions with a one-line message; import_scene() turns them into a Status.
#pragma once
#include <cstdarg>
#include <cstdio>
#include <stdexcept>

namespace pocketray {

struct ImportError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// Throws ImportError with a printf-formatted message: what is wrong and how to mend it.
[[noreturn]] __attribute__((format(printf, 1, 2))) inline void fail_import(const char* format, ...) {
  char text[480];
  va_list arguments;
  va_start(arguments, format);
  std::vsnprintf(text, sizeof text, format, arguments);
  va_end(arguments);
  throw ImportError(text);
}

}  // namespace pocketray
