// Instructions of configurations where the CPU counts none: valgrind counts them while this program, started once more,
// renders each configuration once, of large pictures a sixteenth.
#pragma once
#include "sweep/rigs.h"

namespace pocketray {

// Counts for all points that lack instructions and keeps that in the state, which is not saved. *whole is false after
// an interrupt; what is counted by then is kept. *note says how instructions are counted, or why they are not: nothing
// here fails the sweep. Starts nothing unless options.starts_valgrind.
void count_by_valgrind(const AccuracyOptions& options, const Rig& rig, const SweepPlan& plan, AccuracyState* state,
                       bool* whole, std::string* note);

// What the program does that is started so: renders what options.counting_folder asks for.
Status render_for_valgrind(const AccuracyOptions& options);

}  // namespace pocketray
