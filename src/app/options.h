// Options shared by several commands, with their help.
#pragma once
#include <initializer_list>

#include "app/command_line.h"
#include "budget/budget.h"
#include "session/open_scene.h"
#include "session/servers.h"
#include "viewer/side_by_side.h"

namespace pocketray {

// SCENE and the options for opening and rendering it, including every setting.
void add_scene_options(Command command, CommonOptions* options, bool scene_required = true);
// SCENE and the options that affect what its picture shows, for commands without settings.
void add_view_options(Command command, CommonOptions* options);
// --up, --strict and --model-root, in builds that read models.
void add_reading_options(Command command, ReadingChoice* choice);
// --animation: selects the scene's animation to play.
void add_animation_option(Command command, std::string* name);
// --environment, excluding no other option.
Option add_environment_option(Command command, std::string* name);
// --background, --environment, --light, --fov and --focus. Call after add_scene_options(), or add_view_options().
// `own_look`: the command's options that only work with the scene's own look.
void add_look_options(Command command, CommonOptions* options, std::initializer_list<const char*> own_look = {});
// --coherence, initially auto, and --coherence-table.
void add_coherence_options(Command command, CommonOptions* options, const char* usual = "auto");
// --budget-ms, --flip-max and --front, which exclude the settings that they choose. Call after add_scene_options().
void add_budget_options(Command command, BudgetOptions* options);
// --json, --isa, --server and --key, each a single option. The variable must outlive the parsing of the command line.
Option add_json_option(Command command, std::string* path);
Option add_isa_option(Command command, std::string* isa);
Option add_server_option(Command command, std::vector<std::string>* addresses);
Option add_key_option(Command command, std::string* path);
// --server and its companion options, for builds with a network.
void add_servers_options(Command command, ServersOptions* options);
// --side-by-side, for builds with the reference.
void add_side_by_side_option(Command command, SideBySideOptions* options);

}  // namespace pocketray
