// CHECK guards against programmer errors: it prints both operands and aborts. It stays in release builds; keep it out
// of inner loops.
#pragma once
#include <cstdio>
#include <cstdlib>

namespace pocketray {

[[noreturn]] inline void check_failed(const char* file, int line, const char* text, double left, double right) {
  std::fprintf(stderr, "%s:%d: CHECK(%s) failed: %.17g against %.17g\n", file, line, text, left, right);
  std::abort();
}

}  // namespace pocketray

#define CHECK_OP(left, op, right)                                                                        \
  do {                                                                                                   \
    if (!((left)op(right)))                                                                              \
      ::pocketray::check_failed(__FILE__, __LINE__, #left " " #op " " #right, static_cast<double>(left), \
                                static_cast<double>(right));                                             \
  } while (0)
#define CHECK(condition)                                                               \
  do {                                                                                 \
    if (!(condition)) ::pocketray::check_failed(__FILE__, __LINE__, #condition, 0, 0); \
  } while (0)
#define CHECK_EQ(left, right) CHECK_OP(left, ==, right)
#define CHECK_LE(left, right) CHECK_OP(left, <=, right)
#define CHECK_LT(left, right) CHECK_OP(left, <, right)
#define CHECK_GE(left, right) CHECK_OP(left, >=, right)
#define CHECK_GT(left, right) CHECK_OP(left, >, right)
