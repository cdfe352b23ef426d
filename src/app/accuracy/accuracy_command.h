// The accuracy command, in builds with the reference; see app/commands.h.
#pragma once
#include "app/command_line.h"

namespace pocketray {

void add_accuracy_command(Command program, int* exit_status);

}  // namespace pocketray
