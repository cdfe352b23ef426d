// Options that several commands have: their names, their help.
#pragma once
#include "budget/budget.h"
#include "session/open_scene.h"
#include "session/servers.h"
#include "viewer/side_by_side.h"

namespace CLI {
class App;
}

namespace pocketray {

// Adds them to a command, each with its help.
void add_scene_options(CLI::App* command, CommonOptions* options);
// --budget-ms and --front, which take the place of the options that they choose: call it after add_scene_options().
void add_budget_options(CLI::App* command, BudgetOptions* options);
// --server and what goes with it, of builds with a network.
void add_servers_options(CLI::App* command, ServersOptions* options);
// --side-by-side, of builds with the reference.
void add_side_by_side_option(CLI::App* command, SideBySideOptions* options);

}  // namespace pocketray
