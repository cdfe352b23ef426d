// Options that several commands have: their names, their help.
#pragma once
#include "budget/budget.h"
#include "remote/client/sharing.h"
#include "session/open_scene.h"
#include "viewer/side_by_side.h"

namespace CLI {
class App;
}

namespace pocketray {

// Adds them to a command, each with its help.
void add_scene_options(CLI::App* command, CommonOptions* options);
// --budget-ms and --front, which take the place of the options that they choose: call it after add_scene_options().
void add_budget_options(CLI::App* command, BudgetOptions* options);
// Of builds with a network.
void add_sharing_options(CLI::App* command, SharingOptions* options);
// --split-screen, of builds with the reference.
void add_split_screen_option(CLI::App* command, SplitScreenOptions* options);

}  // namespace pocketray
