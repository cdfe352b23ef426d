// Each function adds its command to the program; when that command runs, it stores its exit status.
#pragma once
#include "app/command_line.h"
#include "session/servers.h"
#include "session/team.h"
#include "viewer/side_by_side.h"

namespace pocketray {

// Parts that a build may lack; null if absent.
struct OptionalParts {
  const ServersBackend* servers = nullptr;
  const SideBySideBackend* side_by_side = nullptr;
  Team team;  // alone in builds without MPI
};
// Leaves *servers unchanged in builds without a network, and null if the options name no server.
inline Status open_servers(const OptionalParts& parts, const ServersOptions& options, const platform::Device* emulated,
                           Servers** servers) {
  return parts.servers ? parts.servers->open(options, emulated, servers) : success();
}

void add_render_command(Command program, const OptionalParts& parts, int* exit_status);
void add_view_command(Command program, const OptionalParts& parts, int* exit_status);
void add_bake_command(Command program, int* exit_status);
void add_plan_command(Command program, int* exit_status);
void add_bench_command(Command program, int* exit_status);

}  // namespace pocketray
