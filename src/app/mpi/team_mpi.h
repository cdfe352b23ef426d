// The team of ranks that mpirun started, through Open MPI.
#pragma once
#include "session/team.h"

namespace pocketray {

// Joins the other ranks; call it once, from the thread that later sends and receives. Processes started from here on do
// not belong to the team. leave_mpi_team() must follow on every rank, or abort_team() on one.
Status join_mpi_team(Team* team);
void leave_mpi_team();

}  // namespace pocketray
