// Commands of builds with the accuracy library; see app/commands.h.
#pragma once
#include "app/command_line.h"
#include "session/team.h"

namespace pocketray {

void add_accuracy_command(Command program, const Team& team, int* exit_status);
void add_reference_command(Command program, const Team& team, int* exit_status);
void add_coherence_report_command(Command program, int* exit_status);
void add_compare_command(Command program, int* exit_status);

}  // namespace pocketray
