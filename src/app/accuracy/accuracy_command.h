// The command of builds with the reference, as app/commands.h describes.
#pragma once

namespace CLI {
class App;
}

namespace pocketray {

void add_accuracy_command(CLI::App* program, int* exit_status);

}  // namespace pocketray
