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
    if (written.ok) written = cache_front(front.prices_path, prices_alone(front.front));
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
  Command command = program.add_subcommand("accuracy", "measure what accuracy costs in time, setting by setting");
  add_scene_options(command, &o->common);
  add_look_options(command, &o->common);
  command.chapter("Animation");
  command.add_option("--time SECONDS", o->seconds, "seconds into the animation")
      .range(-kSecondsMax, kSecondsMax)
      .capture_default_str();
  command.chapter("Measurement");
  command.add_option("--rounds N", o->rounds, "measurements of each configuration")
      .range(1, 1000)
      .capture_default_str();
  command
      .add_option("--price-limit X", o->price_limit,
                  "slowest combination of settings to try, as a multiple of the baseline's time")
      .range(1, 1e6)
      .capture_default_str();
  command.add_flag("--count-instructions", o->starts_valgrind, "count instructions with valgrind")
      .details("Where the CPU does not count them; takes a minute or more, with many lights hours.");
  command.add_flag("--bake-choices", o->bakes, "also bake the scene otherwise and measure that")
      .details(
          "Bakes it with other --textures and --texture-max, without mip maps, and with --radiosity of "
          "few to many patches: time, bytes and error of each. Says first how long the bakes take.");
  command.add_flag("--restart", o->restart, "discard the folder's measurements and start over");
  command.chapter("Reference");
  command.add_option("--reference WHAT", o->reference, "judge: physical, model or a FILE")
      .capture_default_str()
      .details(
          "physical is full light transport, model the renderer's own lighting model, converged, FILE a picture of "
          "`pocketray reference`.");
  command.add_option("--reference-samples N", o->reference_samples, "samples per pixel of the judge")
      .range(2, 1e6)
      .default_str("256; model: 2048");
  command.chapter("Output");
  command.add_option("-o,--output DIR", o->folder, "folder for the page, plots and tables").required();
  command.add_option("--pixel-format NAME", o->output, "pixels of the baseline's screen")
      .one_of({"rgb565", "rgb565-dithered", "rgb888"})
      .capture_default_str();
  command.add_option("--pixels-per-degree,--ppd X", o->pixels_per_degree, "pixels per degree of visual angle, for ꟻLIP")
      .range(1, 1000)
      .capture_default_str();
  add_json_option(command, &o->common.json);
  command.add_option("--counting-folder DIR", o->counting_folder, "for the run under valgrind").hidden();
  command.everyday("Output", {"--output", "--json"});
  command.everyday("Picture", {"--size", "--camera", "--time"});
  command.everyday("Reference", {"--reference", "--reference-samples"});
  command.everyday("Measurement", {"--rounds", "--threads", "--bake-choices", "--restart"});
  command.example("pocketray accuracy cornell -o DIR");
  command.about(
      "Varies one setting at a time (samples, depth, points per area light, …), then several at once, then the "
      "settings "
      "of each method of indirect light. Times each configuration in rounds of random order and compares its picture "
      "with two references, path traced in double precision: full light transport, which is the truth, and the "
      "renderer's own lighting model, converged, which shows the numerical error of samples, points and cut-offs "
      "alone. "
      "ꟻLIP is how different two pictures look when one flips between them: .01 is hard to see, .05 seen at once, .2 "
      "another picture. The front for --budget-ms and --flip-max follows the truth.");
  command.about(
      "The scene's options set the baseline. The output folder gets index.html with all results, its plots and strips, "
      "accuracy.csv and the references, which are also kept per scene and camera in the cache. If interrupted, samples "
      "of references and finished rounds are kept, and the same command continues.");
  command.about(
      "Times are of whole frames (pose, refit, lights, tracing, packing) after a warm-up frame with the same settings; "
      "\"arithmetic double\" is timed with the reference's own tracer. Confidence intervals are 95 %, given at least "
      "six "
      "rounds. Under `mpirun`, in a build with MPI, all ranks take samples of references, and only rank 0 is timed.");
  command.callback([=] {
    o->common.output_folder = o->folder;
    *exit_status = run(*o);
  });
}

}  // namespace pocketray
