// pocketray accuracy: what accuracy costs in time.
#include <CLI/CLI.hpp>

#include "accuracy/csv.h"
#include "accuracy/gnuplot.h"
#include "accuracy/report.h"
#include "app/accuracy/accuracy_command.h"
#include "app/options.h"
#include "budget/front_file.h"
#include "session/gnuplot.h"
#include "session/output.h"
#include "sweep/instructions.h"
#include "sweep/report.h"
#include "sweep/sweep.h"

namespace pocketray {
namespace {

int run(const AccuracyOptions& options) {
  Sweep sweep;
  bool whole;
  SweptFront front;
  if (!options.counting_folder.empty()) return report(render_for_valgrind(options));
  Status status = check_outputs({{"SCENE", options.common.scene}}, {{"--json", options.common.json}});
  if (status.ok) status = measure_sweep(options, &sweep, &whole, &front);
  if (!status.ok) return report(status);
  if (!whole) {
    std::fprintf(stderr,
                 "pocketray: interrupted; what is measured is kept in %s: the same command goes on from there\n",
                 options.folder.c_str());
    return kExitInterrupted;
  }
  status = save_text(options.folder, "accuracy.csv", sweep_csv(sweep));
  bool drawn = true;
  if (status.ok) status = write_report(options.folder, sweep, write_file, run_gnuplot, &drawn);
  if (!drawn && status.ok)
    std::fprintf(stderr,
                 "pocketray: plots are left out: gnuplot is not installed or failed; install it (Debian: gnuplot), "
                 "then: cd -- %s && gnuplot *.gnuplot\n",
                 shell_word(options.folder).c_str());
  // Effects that were switched by hand are no part of what a budget chooses.
  bool kept = status.ok && front.front.count > 1 && !front.path.empty() && options.common.effects == "auto";
  if (kept) {
    Status written = cache_front(front.path, front.front);
    kept = written.ok;
    if (!kept) std::fprintf(stderr, "pocketray: %s; prices are not kept\n", written.message);
  }
  if (status.ok && !options.common.json.empty()) status = write_json(options.common.json, sweep_json(sweep));
  if (status.ok && options.common.json != "-") {
    print_sweep(sweep);
    std::printf("%s/index.html shows it, %s/accuracy.csv has every figure\n", options.folder.c_str(),
                options.folder.c_str());
    if (kept) std::printf("--budget-ms of render and view chooses along its front, kept in %s\n", front.path.c_str());
  }
  return report(status);
}

}  // namespace

void add_accuracy_command(CLI::App* program, int* exit_status) {
  auto o = std::make_shared<AccuracyOptions>();
  o->starts_valgrind = true;
  CLI::App* command =
      program->add_subcommand("accuracy", "show what accuracy costs in time: sweep every knob of a scene");
  command->footer(
      "Turns one knob at a time (samples, depth, points per area light, …), then several at once; times each\n"
      "configuration in rounds of random order and compares its picture with a reference by ꟻLIP and others.\n"
      "The options of the scene state the baseline. DIR gets index.html, which shows it all, its plots and strips,\n"
      "accuracy.csv and the references; interrupted, it keeps what is measured (of a reference each row, of the "
      "rounds\n"
      "each whole one), and the same command goes on. Times are of whole frames after one with the same settings:\n"
      "pose, refit, lights, tracing, packing; the time of \"arithmetic double\" is that of the reference's own "
      "tracer.\n"
      "Intervals hold the truth in 95 of 100 cases, from six rounds on.");
  add_scene_options(command, &o->common);
  command->add_option("-o,--output-folder", o->folder, "folder to write to, made if missing")->required();
  command->add_option("--output", o->output, "what the baseline's screen shows: rgb565, rgb565-dithered or rgb888")
      ->capture_default_str();
  command
      ->add_option("--reference", o->reference,
                   "what knobs are compared with: model (the lighting model at its limit) or physical (all transport)")
      ->capture_default_str();
  command->add_option("--reference-samples", o->reference_samples, "samples of each of its pixels")
      ->default_str("2048 of model, 256 of physical");
  command->add_option("--rounds", o->rounds, "times that each configuration is timed")->capture_default_str();
  command->add_option("--ppd", o->pixels_per_degree, "pixels per degree of sight, for ꟻLIP")->capture_default_str();
  command->add_option("--time", o->seconds, "seconds into the animation")->capture_default_str();
  command
      ->add_option("--price-limit", o->price_limit,
                   "how many times the baseline's time several knobs may take together")
      ->capture_default_str();
  command->add_flag("--restart", o->restart, "drop what the folder has measured");
  command->add_option("--json", o->common.json, "also write it as JSON to FILE, or - for standard output");
  command->add_option("--counting-folder", o->counting_folder)->group("");  // of valgrind's run alone
  command->callback([=] { *exit_status = run(*o); });
}

}  // namespace pocketray
