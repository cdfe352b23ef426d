// The accuracy command, in builds with the reference; see app/commands.h.
#pragma once

namespace CLI {
class App;
}

namespace pocketray {

void add_accuracy_command(CLI::App* program, int* exit_status);

}  // namespace pocketray
