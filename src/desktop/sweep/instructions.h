// Counts instructions with valgrind if the CPU cannot: valgrind runs this program again, which renders each
// configuration once (a sixteenth of large pictures).
#pragma once
#include "desktop/sweep/rigs.h"

namespace pocketray {

// Counts instructions for all points that lack a count and stores them in the state, without saving it. After an
// interrupt *whole is false and finished counts are kept. *note says how instructions are counted, or why not; this
// never fails the sweep. Starts nothing unless options.starts_valgrind.
void count_by_valgrind(const AccuracyOptions& options, const Rig& rig, const SweepPlan& plan, AccuracyState* state,
                       bool* whole, std::string* note);

// Runs inside valgrind: renders the job in options.counting_folder.
Status render_for_valgrind(const AccuracyOptions& options);

}  // namespace pocketray
