// PLATFORM_CHECK guards against mistakes of a caller or of a backend itself. Faults of a device, a file or a peer are
// errors with a message instead. Prints both operands and aborts; stays on in release builds. Like src/base/check.h,
// under another name, so that a program may include both. For .cpp files.
#pragma once
#include <cstdio>
#include <cstdlib>

namespace platform {

[[noreturn]] inline void check_failed(const char* file, int line, const char* text, double left, double right) {
  std::fprintf(stderr, "%s:%d: PLATFORM_CHECK(%s) failed: %.17g against %.17g\n", file, line, text, left, right);
  std::abort();
}

}  // namespace platform

#define PLATFORM_CHECK_OP(left, op, right)                                                              \
  do {                                                                                                  \
    if (!((left)op(right)))                                                                             \
      ::platform::check_failed(__FILE__, __LINE__, #left " " #op " " #right, static_cast<double>(left), \
                               static_cast<double>(right));                                             \
  } while (0)
#define PLATFORM_CHECK(condition)                                                     \
  do {                                                                                \
    if (!(condition)) ::platform::check_failed(__FILE__, __LINE__, #condition, 0, 0); \
  } while (0)
#define PLATFORM_CHECK_EQ(left, right) PLATFORM_CHECK_OP(left, ==, right)
#define PLATFORM_CHECK_LE(left, right) PLATFORM_CHECK_OP(left, <=, right)
#define PLATFORM_CHECK_LT(left, right) PLATFORM_CHECK_OP(left, <, right)
#define PLATFORM_CHECK_GE(left, right) PLATFORM_CHECK_OP(left, >=, right)
#define PLATFORM_CHECK_GT(left, right) PLATFORM_CHECK_OP(left, >, right)
