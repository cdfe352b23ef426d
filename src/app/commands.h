// One command each: adds itself to the program and, when chosen, leaves its exit status.
#pragma once
#include "session/servers.h"
#include "viewer/side_by_side.h"

namespace CLI {
class App;
}

namespace pocketray {

// Parts that a build may lack.
struct OptionalParts {
  const ServersBackend* servers = nullptr;
  const SideBySideBackend* side_by_side = nullptr;
};
// Null where no server is asked for.
inline Status open_servers(const OptionalParts& parts, const ServersOptions& options, const platform::Device* emulated,
                           Servers** servers) {
  return parts.servers ? parts.servers->open(options, emulated, servers) : success();
}

void add_render_command(CLI::App* program, const OptionalParts& parts, int* exit_status);
void add_view_command(CLI::App* program, const OptionalParts& parts, int* exit_status);
void add_bake_command(CLI::App* program, int* exit_status);
void add_plan_command(CLI::App* program, int* exit_status);
void add_bench_command(CLI::App* program, int* exit_status);

}  // namespace pocketray
