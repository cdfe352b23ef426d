// Replaces functions of the compiler's and the C library: the linker's --wrap redirects their callers here. Rare cases
// call the originals.
#if defined(__SOFTFP__)
#include "base/soft_float.h"

using namespace pocketray;
using Bits = std::uint32_t;
using Bits64 = std::uint64_t;

extern "C" {
Bits __real___aeabi_fdiv(Bits a, Bits b);
Bits64 __real___aeabi_ddiv(Bits64 a, Bits64 b);
Bits __real_sqrtf(Bits a);

Bits __wrap___aeabi_fdiv(Bits a, Bits b);
Bits64 __wrap___aeabi_ddiv(Bits64 a, Bits64 b);
Bits __wrap_sqrtf(Bits a);
int __wrap___aeabi_fcmplt(Bits a, Bits b);
int __wrap___aeabi_fcmple(Bits a, Bits b);
int __wrap___aeabi_fcmpgt(Bits a, Bits b);
int __wrap___aeabi_fcmpge(Bits a, Bits b);
int __wrap___aeabi_fcmpeq(Bits a, Bits b);

Bits __wrap___aeabi_fdiv(Bits a, Bits b) {
  Bits result;
  return soft_divide(a, b, &result) ? result : __real___aeabi_fdiv(a, b);
}
Bits64 __wrap___aeabi_ddiv(Bits64 a, Bits64 b) {
  Bits64 result;
  return soft_divide(a, b, &result) ? result : __real___aeabi_ddiv(a, b);
}
Bits __wrap_sqrtf(Bits a) {
  Bits result;
  return soft_root(a, &result) ? result : __real_sqrtf(a);
}
int __wrap___aeabi_fcmplt(Bits a, Bits b) { return !soft_is_nan(a) && !soft_is_nan(b) && soft_less(a, b); }
int __wrap___aeabi_fcmple(Bits a, Bits b) { return !soft_is_nan(a) && !soft_is_nan(b) && !soft_less(b, a); }
int __wrap___aeabi_fcmpgt(Bits a, Bits b) { return !soft_is_nan(a) && !soft_is_nan(b) && soft_less(b, a); }
int __wrap___aeabi_fcmpge(Bits a, Bits b) { return !soft_is_nan(a) && !soft_is_nan(b) && !soft_less(a, b); }
int __wrap___aeabi_fcmpeq(Bits a, Bits b) { return !soft_is_nan(a) && !soft_is_nan(b) && soft_equal(a, b); }
}
#endif
