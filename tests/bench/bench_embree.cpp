// bench_embree: the tracing core against Embree.
#include <cstdio>

#include "accel/accel_list.h"
#include "app/options.h"
#include "bench/build_report.h"
#include "bench/duel.h"
#include "bench/duel_report.h"
#include "bench/ray_sets.h"
#include "session/interrupt.h"
#include "session/report.h"

namespace pocketray {
namespace {

struct BenchOptions {
  std::vector<std::string> scenes, sizes = {"320x240", "1280x960"}, isas = {"sse2", "native"},
                                   kinds = {"primary", "shadow", "bounce"};
  std::string accel = kAccelList[0]->name, models = POCKETRAY_SHARED "/scenes", cache = POCKETRAY_CACHE, json,
              build_json;
  int rounds = 15, build_rounds = 5;
};

Status bench_scene(const std::string& name, const BenchOptions& options, std::vector<DuelRow>* rows,
                   std::vector<BuildRow>* builds) {
  BenchScene scene;
  bool found;
  RETURN_IF_ERROR(load_bench_scene(name, options.models, options.cache, &scene, &found));
  if (!found) {
    std::fprintf(stderr, "skipped: %s is not under %s\n", name.c_str(), options.models.c_str());
    return success();
  }
  for (const std::string& isa : options.isas) {
    hold_ours(isa);
    OurSide ours = build_ours(scene, find_accel(options.accel));
    EmbreeSide embree(scene, isa);
    for (const std::string& size : options.sizes) {
      std::vector<RaySet> sets;
      RETURN_IF_ERROR(make_ray_sets(scene, size, options.kinds, ours, &sets));
      for (const RaySet& set : sets) {
        if (interrupted) return success();
        std::vector<DuelRow> more = duel(scene, isa, ours, &embree, set, options.rounds);
        if (options.json != "-") print_duel_rows(more);
        rows->insert(rows->end(), more.begin(), more.end());
      }
      if (isa != options.isas.back() || size != options.sizes.front() || options.build_rounds == 0 || interrupted)
        continue;
      std::vector<BuildRow> more = bench_builds(&scene, &embree, sets, options.build_rounds);
      builds->insert(builds->end(), more.begin(), more.end());
    }
  }
  return success();
}

Status check_rows(const std::vector<DuelRow>& rows) {
  for (const DuelRow& r : rows)
    if (r.differing_share > kDifferingShareMax)
      return failure("%s, %s rays at %s: %.3f %% differ from Embree's mode \"%s\", more than %.1f %%", r.scene.c_str(),
                     r.rays.c_str(), r.size.c_str(), r.differing_share * 100, r.embree_mode.c_str(),
                     kDifferingShareMax * 100);
  return success();
}

int run(const BenchOptions& options) {
  std::vector<DuelRow> rows;
  std::vector<BuildRow> builds;
  if (options.json != "-") print_duel_header();
  for (const std::string& scene : options.scenes.empty() ? default_scene_names() : options.scenes) {
    Status status = bench_scene(scene, options, &rows, &builds);
    if (!status.ok) return report(status);
    if (interrupted) break;
  }
  if (options.json != "-") {
    if (!builds.empty()) print_builds(builds);
    print_verdicts(rows, builds);
  }
  Status status = success();
  if (!options.json.empty()) status = write_json(options.json, duel_json(rows));
  if (status.ok && !options.build_json.empty()) status = write_json(options.build_json, builds_json(builds));
  if (status.ok) status = check_rows(rows);
  return status.ok && interrupted ? kExitInterrupted : report(status);
}

void add_options(Command program, BenchOptions* o) {
  std::vector<std::string> accels;
  for (const AccelInfo* info : kAccelList) accels.push_back(info->name);
  program
      .add_option("--scene NAME", o->scenes,
                  "buddha, bunny, dragon, conference, a built-in scene or a file; may list several")
      .default_str("these four, cornell and statue");
  program.add_option("--rays KIND", o->kinds, "kinds of rays to trace")
      .one_of({"primary", "shadow", "bounce"})
      .default_str("all");
  program.add_option("--size WxH", o->sizes, "picture sizes, multiples of 8").default_str("320x240 1280x960");
  program.add_option("--isa NAME", o->isas, "what both sides may use: SSE2 or everything the CPU has")
      .one_of({"sse2", "native"})
      .default_str("both");
  program.add_option("--accel NAME", o->accel, "our accelerator").one_of(accels).capture_default_str();
  program.add_option("--rounds", o->rounds, "rounds in which both trace them in turn")
      .range(1, 10000)
      .capture_default_str();
  program.add_option("--build-rounds", o->build_rounds, "the same for building and refitting; 0: skip them")
      .range(0, 10000)
      .capture_default_str();
  program.add_option("--models DIR", o->models, "folder of the models").capture_default_str();
  program.add_option("--cache DIR", o->cache, "folder to unpack archives into").capture_default_str();
  program.add_option("--json FILE", o->json, "write the table as JSON to FILE, or - for standard output");
  program.add_option("--build-json FILE", o->build_json, "write the table of acceleration structures as JSON to FILE");
}

}  // namespace
}  // namespace pocketray

int main(int argument_count, char** arguments) {
  using namespace pocketray;
  CommandLine line(
      "bench_embree",
      "bench_embree traces the same rays through pocketray's accelerator and through Embree, in turn, on one thread, "
      "checks that both hit the same, and prints the rays per second of each.");
  Command program = line.program();
  BenchOptions options;
  add_options(program, &options);
  program.example("bench_embree --scene bunny --size 320x240 --isa sse2");
  program.example("bench_embree --scene cornell --rays shadow bounce --json -");
  program.footer("A full run takes about twenty minutes; Ctrl-C keeps finished results.");
  catch_interrupts();
  ParseResult parsed = line.parse({arguments + 1, arguments + argument_count});
  if (!parsed.error.empty()) {
    std::fprintf(stderr, "%s\nRun with --help for more information.\n", parsed.error.c_str());
    return kExitUsage;
  }
  if (!parsed.help.empty()) return std::fputs(parsed.help.c_str(), stdout), kExitDone;
  return run(options);
}
