// How much a test does: all of it on the machine itself, a share where every instruction is emulated and floats are,
// too, or where nothing is optimised.
#pragma once

namespace pocketray {

#if defined(POCKETRAY_EMULATED) || !defined(__OPTIMIZE__)
constexpr int kEffortDivisor = 40;
#else
constexpr int kEffortDivisor = 1;
#endif

// A number of rays, scenes or rounds: at least one of them.
constexpr int effort(int count) { return count / kEffortDivisor > 0 ? count / kEffortDivisor : 1; }
// A side of a picture in pixels.
constexpr unsigned effort_side(unsigned side) { return kEffortDivisor > 1 ? (side + 2) / 3 : side; }

}  // namespace pocketray
