// One command each: adds itself to the program and, when chosen, leaves its exit status.
#pragma once

namespace CLI {
class App;
}

namespace pocketray {

void add_render_command(CLI::App* program, int* exit_status);
void add_view_command(CLI::App* program, int* exit_status);
void add_bake_command(CLI::App* program, int* exit_status);
void add_plan_command(CLI::App* program, int* exit_status);
void add_bench_command(CLI::App* program, int* exit_status);
#ifdef POCKETRAY_HAVE_ACCURACY
void add_accuracy_command(CLI::App* program, int* exit_status);
#endif
#ifdef POCKETRAY_HAVE_NETWORK
void add_serve_command(CLI::App* program, int* exit_status);
void add_scenes_command(CLI::App* program, int* exit_status);
void add_split_report_command(CLI::App* program, int* exit_status);
#endif

}  // namespace pocketray
