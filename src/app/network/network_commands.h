// The commands of builds with a network; see app/commands.h.
#pragma once
#include "app/command_line.h"

namespace pocketray {

void add_serve_command(Command program, int* exit_status);
void add_scenes_command(Command program, int* exit_status);
void add_keygen_command(Command program, int* exit_status);

}  // namespace pocketray
