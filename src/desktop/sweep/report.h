// Prints a sweep for people and writes it as JSON.
#pragma once
#include "desktop/accuracy/result.h"
#include "session/report.h"

namespace pocketray {

Json sweep_json(const Sweep& sweep);
// A table per knob and the front, on standard output.
void print_sweep(const Sweep& sweep);

}  // namespace pocketray
