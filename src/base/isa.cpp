#include "base/isa.h"

#include <atomic>

#include "base/check.h"

namespace pocketray {
namespace {

constexpr int kUnknown = -1;
std::atomic<int> active{kUnknown};

}  // namespace

Isa best_isa() {
#if defined(__x86_64__)
  if (!__builtin_cpu_supports("avx2") || !__builtin_cpu_supports("fma") || !__builtin_cpu_supports("bmi") ||
      !__builtin_cpu_supports("bmi2"))
    return Isa::kBaseline;
  bool wide =
      __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl");
  return wide ? Isa::kAvx512 : Isa::kAvx2;
#else
  return static_cast<Isa>(kIsaCount - 1);
#endif
}

Isa active_isa() {
  int isa = active.load(std::memory_order_relaxed);
  if (isa == kUnknown) {
    isa = static_cast<int>(best_isa());
    active.store(isa, std::memory_order_relaxed);
  }
  return static_cast<Isa>(isa);
}

void select_isa(Isa isa) {
  CHECK_GE(static_cast<int>(isa), 0);
  CHECK_LE(static_cast<int>(isa), static_cast<int>(best_isa()));
  active.store(static_cast<int>(isa), std::memory_order_relaxed);
}

const char* isa_name(Isa isa) {
#if defined(__x86_64__)
  static constexpr const char* kNames[kIsaCount] = {"baseline", "avx2", "avx512"};
#else
  static constexpr const char* kNames[] = {"baseline", "neon"};
#endif
  const int index = static_cast<int>(isa);
  CHECK(index >= 0 && index < kIsaCount);
  return kNames[index];
}

}  // namespace pocketray
