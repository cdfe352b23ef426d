// The team of ranks that mpirun started, by Open MPI.
#pragma once
#include "session/team.h"

namespace pocketray {

// Joins the other ranks; to be called once, by the thread that sends and receives later. Programs started from here on
// do not belong to the team. leave_mpi_team() must follow on every rank, or abort_team() on one.
Status join_mpi_team(Team* team);
void leave_mpi_team();

}  // namespace pocketray
