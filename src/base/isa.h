// Instruction sets beyond the build's baseline, selected at run time.
//
// Code that profits from them is a *kernel*: headers whose code lies in `namespace pocketray::POCKETRAY_ISA`. Each
// instruction set has a source that defines POCKETRAY_ISA, includes them and is compiled with that set's options
// (CMakeLists.txt). The namespace keeps the copies apart: the linker could otherwise merge an inline function that a
// wide source did not inline into code for every CPU (tests/tidy/objects_test.sh looks for such functions).
#pragma once

#ifndef POCKETRAY_ISA
#define POCKETRAY_ISA baseline
#endif

// NEON of 32-bit ARM, whose arithmetic flushes denormals.
#if defined(__ARM_NEON) && !defined(__aarch64__)
#define POCKETRAY_HAVE_NEON32
#endif

namespace pocketray {

// Each includes the ones before it. kBaseline is what the compiler options allow: SSE2 on x86-64; on 32-bit ARM without
// NEON's arithmetic, which flushes denormals.
#if defined(__x86_64__)
enum class Isa { kBaseline, kAvx2, kAvx512 };
constexpr int kIsaCount = 3;
#elif defined(POCKETRAY_HAVE_NEON32)
enum class Isa { kBaseline, kNeon };
constexpr int kIsaCount = 2;
#else
enum class Isa { kBaseline };
constexpr int kIsaCount = 1;
#endif

// Widest set that this CPU supports and this build has kernels for.
Isa best_isa();
// Set in use: best_isa() unless another was selected.
Isa active_isa();
// For tests and measurements, while nothing is traced; must not exceed best_isa().
void select_isa(Isa isa);
const char* isa_name(Isa isa);  // "baseline", "avx2", "avx512", "neon"

}  // namespace pocketray
