// The command of builds with a network and the accuracy library; see app/commands.h.
#pragma once
#include "app/command_line.h"

namespace pocketray {

void add_split_report_command(Command program, int* exit_status);

}  // namespace pocketray
