// How much a test does: everything natively, a share under CPU or float emulation and in unoptimised builds, a larger
// share under a sanitizer.
#pragma once

namespace pocketray {

#if defined(POCKETRAY_EMULATED) || !defined(__OPTIMIZE__)
constexpr int kEffortDivisor = 40;
#elif defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr int kEffortDivisor = 6;
#else
constexpr int kEffortDivisor = 1;
#endif

// Floats and the CPU are both emulated: the longest tests do still less.
#ifdef __SOFTFP__
constexpr bool kSoftFloats = true;
#else
constexpr bool kSoftFloats = false;
#endif

// A number of rays, scenes or rounds, at least one.
constexpr int effort(int count) { return count / kEffortDivisor > 0 ? count / kEffortDivisor : 1; }
// A side of a picture in pixels.
constexpr unsigned effort_side(unsigned side) { return kEffortDivisor > 1 ? (side + 2) / 3 : side; }

}  // namespace pocketray
