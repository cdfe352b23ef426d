// Status: operating errors (files, options, devices, links). The message says what is wrong and how to mend it.
#pragma once
#include <cstdarg>
#include <cstdio>

namespace pocketray {

struct [[nodiscard]] Status {
  bool ok = true;
  char message[508] = {0};
};

inline Status success() { return Status(); }

// Builds an error from a printf format; longer text is cut.
__attribute__((format(printf, 1, 2))) inline Status failure(const char* format, ...) {
  Status status;
  status.ok = false;
  va_list arguments;
  va_start(arguments, format);
  std::vsnprintf(status.message, sizeof status.message, format, arguments);
  va_end(arguments);
  return status;
}

}  // namespace pocketray

#define RETURN_IF_ERROR(expression)                            \
  do {                                                         \
    ::pocketray::Status status_of_expression = (expression);   \
    if (!status_of_expression.ok) return status_of_expression; \
  } while (0)
