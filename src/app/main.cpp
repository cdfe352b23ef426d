// pocketray: the program. The only place that exits.
#include <cstdio>
#include <exception>
#include <new>
#include <string>

#include "app/commands.h"
#include "platform/standard_streams.h"
#include "scene/baked.h"
#include "session/interrupt.h"
#include "session/note.h"
#include "session/output.h"
#include "session/report.h"
#include "session/terminal.h"
#ifdef POCKETRAY_HAVE_ACCURACY
#include "app/accuracy/accuracy_command.h"
#include "desktop/reference_view/reference_view.h"
#endif
#ifdef POCKETRAY_HAVE_MPI
#include "app/mpi/team_mpi.h"
#endif
#ifdef POCKETRAY_HAVE_NETWORK
#include "app/network/network_commands.h"
#include "remote/client/servers.h"
#include "wire/message.h"
#endif
#if defined POCKETRAY_HAVE_ACCURACY && defined POCKETRAY_HAVE_NETWORK
#include "app/split_report/split_report_command.h"
#endif

namespace pocketray {
namespace {

// Joins the ranks that mpirun started with this one. Only rank 0 prints from then on.
Status join_team(Team* team) {
  const TeamLaunch launch = team_launch();
  if (launch.size == 1) return success();
#ifdef POCKETRAY_HAVE_MPI
  Status status = join_mpi_team(team);
#else
  team->rank = launch.rank;
  Status status = failure(
      "mpirun started %u programs, and this build has no MPI: build one with -DPOCKETRAY_MPI=ON, or start one program",
      launch.size);
#endif
  if (!leads(*team)) platform::keep_quiet();
  return status;
}

void leave_team(const Team& team) {
#ifdef POCKETRAY_HAVE_MPI
  if (team.backend) leave_mpi_team();
#else
  (void)team;
#endif
}

std::string version_text() {
  std::string text = std::string("pocketray ") + POCKETRAY_VERSION + "\n.pray files, version " +
                     std::to_string(kBakedVersion) + " (reads " + std::to_string(kBakedVersionMin) + " and later)\n";
#ifdef POCKETRAY_HAVE_NETWORK
  text += "render servers' protocol, version " + std::to_string(kWireVersion) + "\n";
#endif
  return text;
}

int run_command(int argument_count, char** arguments, const Team& team) {
  int exit_status = kExitDone;
  CommandLine line("pocketray",
                   "pocketray ray-traces scenes for handheld screens in a block of memory sized once at start.");
  line.set_version(version_text());
  line.set_style(output_style());
  Command program = line.program();
  program.example("pocketray render cornell -o cornell.png");
  program.example("pocketray view statue");
  OptionalParts parts;
  parts.team = team;
#ifdef POCKETRAY_HAVE_NETWORK
  parts.servers = &kRenderServers;
#endif
#ifdef POCKETRAY_HAVE_ACCURACY
  parts.side_by_side = &kReferenceView;
#endif
  program.chapter("Pictures");
  add_render_command(program, parts, &exit_status);
  add_view_command(program, parts, &exit_status);
  add_bake_command(program, &exit_status);
  add_plan_command(program, &exit_status);
  program.chapter("Measurements");
  add_bench_command(program, &exit_status);
#ifdef POCKETRAY_HAVE_ACCURACY
  add_accuracy_command(program, team, &exit_status);
  add_reference_command(program, team, &exit_status);
  add_compare_command(program, &exit_status);
  add_coherence_report_command(program, &exit_status);
#endif
#if defined POCKETRAY_HAVE_ACCURACY && defined POCKETRAY_HAVE_NETWORK
  add_split_report_command(program, &exit_status);
#endif
#ifdef POCKETRAY_HAVE_NETWORK
  program.chapter("Render servers");
  ServeOnRanks on_ranks = nullptr;
#ifdef POCKETRAY_HAVE_MPI
  on_ranks = serve_on_ranks;
#endif
  add_serve_command(program, team, on_ranks, &exit_status);
  add_scenes_command(program, &exit_status);
  add_keygen_command(program, &exit_status);
#endif
  try {
    ParseResult parsed = line.parse({arguments + 1, arguments + argument_count});
    if (!parsed.error.empty()) {
      print_note(parsed.error);
      return parsed.usage ? kExitUsage : kExitInput;
    }
    std::fputs(parsed.help.c_str(), stdout);
  } catch (const std::bad_alloc&) {
    print_note(std::string("there is not enough memory for ") + arguments[1] +
               ": use a smaller model or picture, or raise the limit (ulimit -v)");
    abort_team(team, kExitInput);
    return kExitInput;
  } catch (const std::exception& error) {
    print_note(error.what());
    abort_team(team, kExitInput);
    return kExitInput;
  }
  return exit_status;
}

int run(int argument_count, char** arguments) {
  catch_interrupts();
  Team team;
  Status status = join_team(&team);
  int exit_status = report(status);
  bool is_needed = false;
  if (status.ok) {
    status = check_arguments(argument_count, arguments);
    if (!status.ok) report(status), exit_status = kExitUsage;
  }
  if (status.ok) {
    status = check_team_command(team, argument_count > 1 ? arguments[1] : nullptr, &is_needed);
    exit_status = report(status);
  }
  if (status.ok && is_needed) exit_status = run_command(argument_count, arguments, team);
  leave_team(team);
  return exit_status;
}

}  // namespace
}  // namespace pocketray

int main(int argument_count, char** arguments) {
  platform::open_standard_streams();
  return pocketray::finish_printing(pocketray::run(argument_count, arguments));
}
