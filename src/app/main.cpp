// pocketray: the program. The only place that exits.
#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdlib>

#include "app/commands.h"
#include "platform/standard_streams.h"
#include "session/interrupt.h"
#include "session/output.h"
#include "session/report.h"
#ifdef POCKETRAY_HAVE_ACCURACY
#include "app/accuracy/accuracy_command.h"
#include "viewer/reference/reference_view.h"
#endif
#ifdef POCKETRAY_HAVE_NETWORK
#include "app/network/network_commands.h"
#include "remote/client/servers.h"
#endif

namespace pocketray {
namespace {

// No option accepts an empty value, NaN or infinity. CLI11's range checks accept a NaN, which is neither below nor
// above.
std::string refuse_meaningless(const std::string& text, bool is_real) {
  if (text.empty()) return "must not be empty";
  return is_real && !std::isfinite(std::strtod(text.c_str(), nullptr)) ? "must be a finite number" : "";
}

void check_values(CLI::App* program) {
  for (CLI::App* command : program->get_subcommands({}))
    for (CLI::Option* option : command->get_options()) {
      if (option->get_items_expected_min() == 0) continue;  // a flag, or an optional value
      bool is_real = option->get_type_name().compare(0, 5, "FLOAT") == 0;
      option->check([is_real](const std::string& text) { return refuse_meaningless(text, is_real); });
    }
}

std::string one_line(const CLI::App*, const CLI::Error& error) {
  return std::string("pocketray: ") + error.what() + " (see --help)\n";
}

int run(int argument_count, char** arguments) {
  int exit_status = kExitDone;
  CLI::App program{
      "pocketray ray-traces scenes for handheld screens in a block of memory sized once at start.\n"
      "Try:  pocketray render cornell -o cornell.png\n"
      "      pocketray view statue\n"};
  program.name("pocketray");
  program.set_version_flag("--version", POCKETRAY_VERSION);
  program.require_subcommand(1);
  program.footer("Exit status: 0 done, 1 bad input or environment, 2 wrong usage, 3 interrupted.");
  OptionalParts parts;
#ifdef POCKETRAY_HAVE_NETWORK
  parts.servers = &kRenderServers;
#endif
#ifdef POCKETRAY_HAVE_ACCURACY
  parts.side_by_side = &kReferenceView;
#endif
  add_render_command(&program, parts, &exit_status);
  add_view_command(&program, parts, &exit_status);
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
  check_values(&program);
  program.failure_message(one_line);
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
