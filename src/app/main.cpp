// pocketray: the program. The only place that exits.
#include <cstdio>
#include <exception>

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
#if defined POCKETRAY_HAVE_ACCURACY && defined POCKETRAY_HAVE_NETWORK
#include "app/split_report/split_report_command.h"
#endif

namespace pocketray {
namespace {

int run(int argument_count, char** arguments) {
  int exit_status = kExitDone;
  CommandLine line("pocketray",
                   "pocketray ray-traces scenes for handheld screens in a block of memory sized once at start.\n"
                   "Try:  pocketray render cornell -o cornell.png\n"
                   "      pocketray view statue\n");
  line.set_version_flag("--version", POCKETRAY_VERSION);
  line.require_subcommand(1);
  Command program = line.program();
  program.footer("Exit status: 0 done, 1 bad input or environment, 2 wrong usage, 3 interrupted.");
  OptionalParts parts;
#ifdef POCKETRAY_HAVE_NETWORK
  parts.servers = &kRenderServers;
#endif
#ifdef POCKETRAY_HAVE_ACCURACY
  parts.side_by_side = &kReferenceView;
#endif
  add_render_command(program, parts, &exit_status);
  add_view_command(program, parts, &exit_status);
  add_bake_command(program, &exit_status);
  add_plan_command(program, &exit_status);
  add_bench_command(program, &exit_status);
#ifdef POCKETRAY_HAVE_ACCURACY
  add_accuracy_command(program, &exit_status);
  add_reference_command(program, &exit_status);
  add_coherence_report_command(program, &exit_status);
  add_compare_command(program, &exit_status);
#endif
#ifdef POCKETRAY_HAVE_NETWORK
  add_serve_command(program, &exit_status);
  add_scenes_command(program, &exit_status);
#endif
#if defined POCKETRAY_HAVE_ACCURACY && defined POCKETRAY_HAVE_NETWORK
  add_split_report_command(program, &exit_status);
#endif
  line.refuse_meaningless_values();
  catch_interrupts();
  Status given = check_arguments(argument_count, arguments);
  if (!given.ok) return report(given), kExitUsage;
  try {
    ParseResult parsed = line.parse({arguments + 1, arguments + argument_count});
    if (!parsed.error.empty()) {
      std::fprintf(stderr, "pocketray: %s (see --help)\n", parsed.error.c_str());
      return parsed.usage ? kExitUsage : kExitInput;
    }
    std::fputs(parsed.help.c_str(), stdout);
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
