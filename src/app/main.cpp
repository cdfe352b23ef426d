// pocketray: the program. The only place that exits.
#include <CLI/CLI.hpp>

#include "app/commands.h"
#include "app/interrupt.h"
#include "app/output.h"
#include "app/report.h"
#include "platform/standard_streams.h"

namespace pocketray {
namespace {

int run(int argument_count, char** arguments) {
  int exit_status = kExitDone;
  CLI::App program{
      "pocketray ray-traces scenes for handheld screens in a block of memory fixed at start.\n"
      "Try:  pocketray render cornell -o cornell.png\n"
      "      pocketray view statue\n"};
  program.name("pocketray");
  program.set_version_flag("--version", POCKETRAY_VERSION);
  program.require_subcommand(1);
  program.footer("Exit status: 0 done, 1 the input or the environment is at fault, 2 wrong usage, 3 interrupted.");
  add_render_command(&program, &exit_status);
  add_view_command(&program, &exit_status);
  add_bake_command(&program, &exit_status);
  add_plan_command(&program, &exit_status);
  add_bench_command(&program, &exit_status);
#ifdef POCKETRAY_HAVE_ACCURACY
  add_accuracy_command(&program, &exit_status);
#endif
#ifdef POCKETRAY_HAVE_NETWORK
  add_serve_command(&program, &exit_status);
  add_scenes_command(&program, &exit_status);
  add_split_report_command(&program, &exit_status);
#endif
  catch_interrupts();
  Status given = check_arguments(argument_count, arguments);
  if (!given.ok) return report(given), kExitUsage;
  try {
    program.parse(argument_count, arguments);
  } catch (const CLI::ParseError& error) {
    int status = program.exit(error);
    return status == 0 ? kExitDone : kExitUsage;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "pocketray: %s\n", error.what());
    return kExitInput;
  }
  return exit_status;
}

}  // namespace
}  // namespace pocketray

int main(int argument_count, char** arguments) {
  platform::open_standard_streams();
  return pocketray::finish_printing(pocketray::run(argument_count, arguments));
}
