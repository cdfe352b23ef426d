// Instruction sets beyond what every CPU of the build has, chosen at run time.
//
// What profits from them is a *kernel*: headers whose code lies in `namespace pocketray::POCKETRAY_ISA`, compiled once
// per instruction set by a source of its own, which defines POCKETRAY_ISA first and is compiled with the options of
// that set (CMakeLists.txt). The namespace keeps the copies apart: an inline function outside of it that a wide source
// does not inline could be merged by the linker into code for every CPU (tests/tidy/objects_test.sh looks for such).
#pragma once

#ifndef POCKETRAY_ISA
#define POCKETRAY_ISA baseline
#endif

namespace pocketray {

// Each includes the ones before. kBaseline is what the build's compiler options allow: SSE2 on x86-64.
enum class Isa { kBaseline, kAvx2, kAvx512 };
constexpr int kIsaCount = 3;

// The widest that this CPU has and this build has kernels for.
Isa best_isa();
// The one in use: best_isa() unless another was selected.
Isa active_isa();
// For tests and measurements, while nothing is traced; must not exceed best_isa().
void select_isa(Isa isa);
const char* isa_name(Isa isa);  // "baseline", "avx2", "avx512"

}  // namespace pocketray
