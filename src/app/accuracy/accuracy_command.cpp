// pocketray accuracy: measures what accuracy costs in time.
#include "app/accuracy/accuracy_command.h"
#include "app/options.h"
#include "desktop/accuracy/csv.h"
#include "desktop/accuracy/gnuplot.h"
#include "desktop/accuracy/report.h"
#include "desktop/sweep/instructions.h"
#include "desktop/sweep/reference_team.h"
#include "desktop/sweep/references.h"
#include "desktop/sweep/report.h"
#include "desktop/sweep/rigs.h"
#include "session/front_file.h"
#include "session/gnuplot.h"
#include "session/note.h"
#include "session/output.h"

namespace pocketray {
namespace {

int lead(AccuracyOptions options) {
  Sweep sweep;
  bool whole;
  SweptFront front;
  Status status = check_outputs({{"SCENE", options.common.scene}, {"--reference", options.reference}},
                                {{"--json", options.common.json}});
  if (status.ok) status = name_reference(&options);
  if (status.ok) status = measure_sweep(options, &sweep, &whole, &front);
  if (!status.ok) return report(status);
  if (!whole) {
    std::fprintf(stderr, "pocketray: interrupted; measurements so far are in %s: run the same command to continue\n",
                 shown(options.folder).c_str());
    return kExitInterrupted;
  }
  status = save_text(options.folder, "accuracy.csv", sweep_csv(sweep));
  bool drawn = true;
  if (status.ok) status = write_report(options.folder, sweep, write_file, run_gnuplot, &drawn);
  if (!drawn && status.ok)
    std::fprintf(stderr,
                 "pocketray: no plots: gnuplot is missing or failed; install it (Debian: gnuplot), then: cd -- %s && "
                 "gnuplot *.gnuplot\n",
                 shell_word(options.folder).c_str());
  // A budget does not choose effects and judges by the truth, so a front measured otherwise is not kept.
  bool kept = status.ok && front.front.count > 1 && !front.path.empty() && options.common.effects == "auto" &&
              sweep.judge == Judge::truth;
  if (kept) {
    Status written = cache_front(front.path, front.front);
    kept = written.ok;
    if (!kept) std::fprintf(stderr, "pocketray: %s; prices are not kept\n", written.message);
  }
  if (status.ok && !options.common.json.empty()) status = write_json(options.common.json, sweep_json(sweep));
  if (status.ok && options.common.json != "-") {
    print_sweep(sweep);
    std::printf("open %s/index.html for the results; %s/accuracy.csv has every figure\n", shown(options.folder).c_str(),
                shown(options.folder).c_str());
    if (kept) std::printf("saved the front in %s, for --budget-ms of render and view\n", shown(front.path).c_str());
  }
  return report(status);
}

int run(const AccuracyOptions& options) {
  if (!options.counting_folder.empty()) return report(render_for_valgrind(options));
  Rigs rigs = {options, {}, {}};
  // Only when the leader begins a reference: afterwards nothing may disturb its measurements.
  ReferenceHelper helper(options.team, options, [&](Rig** found) {
    SweepPlan plan;
    RETURN_IF_ERROR(plan_rigs(&rigs, &plan));
    RETURN_IF_ERROR(reference_rig(&rigs, found));
    return prepare_for_reference(options.seconds, *found);
  });
  return run_in_team(
      options.team, [&] { return lead(options); }, success,
      [&](const TeamMessage& message) { return helper.work(message); });
}

}  // namespace

void add_accuracy_command(Command program, const Team& team, int* exit_status) {
  auto o = std::make_shared<AccuracyOptions>();
  o->team = team;
  Command command = program.add_subcommand("accuracy", "measure the time cost of accuracy: sweep every setting");
  command.footer(
      "Varies one setting at a time (samples, depth, points per area light, …), then several at once, "
      "then the settings\n"
      "of each method of indirect light. Times each configuration in rounds of random order and compares its picture\n"
      "with two references, path traced in double precision: full light transport, which is the truth, and the\n"
      "renderer's own lighting model, converged, which shows the numerical error of samples, points and cut-offs\n"
      "alone. ꟻLIP is how different two pictures look when one flips between them: .01 is hard to see, .05 seen at\n"
      "once, .2 another picture. The front for --budget-ms and --flip-max follows the truth.\n"
      "The scene's options set the baseline. The output folder gets index.html with all results, its plots and\n"
      "strips, accuracy.csv and the references, which are also kept per scene and camera in the cache. If\n"
      "interrupted, samples of references and finished rounds are kept, and the same command continues. Times are of\n"
      "whole frames (pose, refit, lights, tracing, packing) after a warm-up frame with the same settings;\n"
      "\"arithmetic double\" is timed with the reference's own tracer. Under `mpirun`, in a build with MPI, all ranks\n"
      "take samples of references, and only rank 0 is timed.\n"
      "Confidence intervals are 95 %, given at least six rounds.");
  add_scene_options(command, &o->common);
  add_look_options(command, &o->common);
  command.add_option("-o,--output", o->folder, "folder to write to; created if missing").required();
  command
      .add_option("--pixel-format", o->output,
                  "pixel format of the baseline's screen: rgb565, rgb565-dithered or rgb888")
      .capture_default_str();
  command
      .add_option(
          "--reference", o->reference,
          "judge of the front: physical (full light transport), model (the same lighting model, converged) or a file "
          "of `pocketray reference`")
      .capture_default_str();
  command.add_option("--reference-samples", o->reference_samples, "samples per pixel of the judge's reference")
      .default_str("2048 for model, 256 for physical");
  command.add_option("--rounds", o->rounds, "number of times to measure each configuration").capture_default_str();
  command.add_option("--pixels-per-degree,--ppd", o->pixels_per_degree, "pixels per degree of visual angle, for ꟻLIP")
      .capture_default_str();
  command.add_option("--time", o->seconds, "seconds into the animation").capture_default_str();
  command
      .add_option("--price-limit", o->price_limit,
                  "slowest combination of settings to try, as a multiple of the baseline's time")
      .capture_default_str();
  command.add_flag("--count-instructions", o->starts_valgrind,
                   "count instructions with valgrind where the CPU does not: a minute or more, hours with many lights");
  command.add_flag("--bake-choices", o->bakes,
                   "also bake the scene with other --textures, --texture-max, without mip maps, and with "
                   "--radiosity of few to many patches: what each saves and errs. Says first how long the bakes take");
  command.add_flag("--restart", o->restart, "discard the measurements in the folder and start over");
  add_json_option(command, &o->common.json);
  command.add_option("--counting-folder", o->counting_folder, "").group("");  // for the run under valgrind
  command.callback([=] {
    o->common.output_folder = o->folder;
    *exit_status = run(*o);
  });
}

}  // namespace pocketray
