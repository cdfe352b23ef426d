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
  return Isa::kBaseline;
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
  CHECK_LE(static_cast<int>(isa), static_cast<int>(best_isa()));
  active.store(static_cast<int>(isa), std::memory_order_relaxed);
}

const char* isa_name(Isa isa) {
  CHECK(isa >= Isa::kBaseline && isa <= Isa::kAvx512);
  static constexpr const char* kNames[kIsaCount] = {"baseline", "avx2", "avx512"};
  return kNames[static_cast<int>(isa)];
}

}  // namespace pocketray
