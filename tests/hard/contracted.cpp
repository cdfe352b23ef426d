// Woop's test with products and sums contracted to one rounding. hard.cmake sets the options.
namespace pocketray {
namespace ordinary {
namespace {
#include "hard/woop.h"
}  // namespace

bool woop_contracted(const float* origin, const float* direction, const float* a, const float* b, const float* c) {
  return woop(origin, direction, a, b, c);
}

bool has_contraction() {
#if defined(__x86_64__) && defined(__FMA__)
  return __builtin_cpu_supports("fma");
#elif defined(__aarch64__)
  return true;
#else
  return false;
#endif
}

}  // namespace ordinary
}  // namespace pocketray
