// The commands of builds with a network; see app/commands.h.
#pragma once

namespace CLI {
class App;
}

namespace pocketray {

void add_serve_command(CLI::App* program, int* exit_status);
void add_scenes_command(CLI::App* program, int* exit_status);
void add_split_report_command(CLI::App* program, int* exit_status);

}  // namespace pocketray
