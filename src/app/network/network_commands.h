// The commands of builds with a network; see app/commands.h.
#pragma once
#include "app/command_line.h"
#include "app/network/serve_ranks.h"

namespace pocketray {

// on_ranks: null in builds without MPI.
void add_serve_command(Command program, const Team& team, ServeOnRanks on_ranks, int* exit_status);
void add_scenes_command(Command program, int* exit_status);
void add_keygen_command(Command program, int* exit_status);

}  // namespace pocketray
