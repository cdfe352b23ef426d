// Options shared by several commands, with their help.
#pragma once
#include "budget/budget.h"
#include "session/open_scene.h"
#include "session/servers.h"
#include "viewer/side_by_side.h"

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace pocketray {

// SCENE and the options for opening and rendering it, every setting included.
void add_scene_options(CLI::App* command, CommonOptions* options);
// --budget-ms and --front, which exclude the settings they choose. Call after add_scene_options().
void add_budget_options(CLI::App* command, BudgetOptions* options);
// --json, --isa and --server, each a single option. The variable must outlive the parsing of the command line.
CLI::Option* add_json_option(CLI::App* command, std::string* path);
CLI::Option* add_isa_option(CLI::App* command, std::string* isa);
CLI::Option* add_server_option(CLI::App* command, std::vector<std::string>* addresses);
// --server and the options that go with it, for builds with a network.
void add_servers_options(CLI::App* command, ServersOptions* options);
// --side-by-side, for builds with the reference.
void add_side_by_side_option(CLI::App* command, SideBySideOptions* options);

}  // namespace pocketray
