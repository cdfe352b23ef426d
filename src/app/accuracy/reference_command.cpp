// pocketray reference: renders the picture that others are judged by.
#include "app/accuracy/accuracy_command.h"

#include <nlohmann/json.hpp>

#include "app/options.h"
#include "desktop/sweep/reference_run.h"
#include "desktop/sweep/reference_team.h"
#include "desktop/sweep/references.h"
#include "desktop/sweep/rigs.h"
#include "platform/file.h"
#include "session/note.h"
#include "session/output.h"

namespace pocketray {
namespace {

constexpr std::uint32_t kPartCountMax = 4096;

struct ReferenceCommand {
  AccuracyOptions options;
  ReferenceGoal goal;
  std::string kind = "physical", part;
  std::vector<std::string> merged;
};

Status read_goal(ReferenceCommand* c) {
  ReferenceGoal* goal = &c->goal;
  goal->transport = c->kind == "model" ? Transport::model : Transport::physical;
  if (!has_suffix(goal->path.c_str(), ".pfm"))
    return failure("--output is '%.300s': it must end in .pfm", goal->path.c_str());
  if (goal->samples == 0 && goal->until == 0) goal->samples = reference_samples({}, goal->transport);
  if (c->part.empty()) return success();
  int length = 0;
  bool read = std::sscanf(c->part.c_str(), "%4u/%4u%n", &goal->part, &goal->part_count, &length) == 2;
  if (!read || c->part[static_cast<std::size_t>(length)] != 0 || goal->part < 1 || goal->part > goal->part_count ||
      goal->part_count > kPartCountMax)
    return failure("--part is '%.40s': it must be K/N, with K in 1 … N and N at most %u", c->part.c_str(),
                   kPartCountMax);
  return success();
}

Status add_file(const std::string& path, Accumulation* sum) {
  Accumulation other;
  Transport transport;
  RETURN_IF_ERROR(load_accumulation(path, &other, &transport));
  RETURN_IF_ERROR(check_same_reference(path, other, *sum));
  Status status = merge(other, sum);
  return status.ok ? status : failure("%.200s and the samples so far: %.280s", path.c_str(), status.message);
}

Status check_files(const ReferenceCommand& c) {
  std::vector<NamedFile> inputs = {{"SCENE", c.options.common.scene}};
  for (const std::string& path : c.merged) inputs.push_back({"--merge", path});
  return check_outputs(inputs, {{"--output", c.goal.path}, {"--json", c.options.common.json}});
}

Json regions_json(const std::vector<RegionError>& regions) {
  Json list = Json::array();
  for (const RegionError& r : regions)
    list.push_back(
        {{"columns", {r.column, r.column_end}}, {"rows", {r.row, r.row_end}}, {"flip", r.flip}, {"rmse", r.rmse}});
  return list;
}

void print_regions(const std::vector<RegionError>& regions) {
  std::printf("its own ꟻLIP error by region:\n");
  for (std::size_t i = 0; i < regions.size(); ++i) {
    bool ends = i + 1 == regions.size() || regions[i + 1].row != regions[i].row;
    std::printf("  %.4f%s", regions[i].flip, ends ? "\n" : "");
  }
}

Status tell(const ReferenceCommand& c, const Rig& rig, const Accumulation& sum) {
  ReferencePictures p;
  develop(sum, display_of(rig.opened.renderer), c.goal.pixels_per_degree, &p);
  std::vector<RegionError> regions = region_errors(p, sum.width, sum.height, c.goal.pixels_per_degree);
  const std::string& json = c.options.common.json;
  if (json != "-") {
    std::printf("%s: %s reference, %llu samples per pixel, its own error ꟻLIP %.4f, RMSE %.5f\n",
                shown(c.goal.path).c_str(), c.kind.c_str(), static_cast<unsigned long long>(samples_of(sum)), p.flip,
                p.rmse);
    print_regions(regions);
  }
  if (json.empty()) return success();
  return write_json(json, {{"file", c.goal.path},
                           {"kind", c.kind},
                           {"samples_per_pixel", samples_of(sum)},
                           {"flip", p.flip},
                           {"rmse", p.rmse},
                           {"regions", regions_json(regions)}});
}

// Opens the scene and prepares its frame.
Status open_for_reference(const ReferenceCommand& c, std::unique_ptr<Rig>* rig) {
  std::uint32_t columns = c.options.common.scene == "cornell" ? kReferenceColumns : kCornellSphereColumns;
  RETURN_IF_ERROR(open_rig(c.options, columns, rig));
  print_notes((*rig)->opened);
  return prepare_for_reference(c.options.seconds, rig->get());
}

Status accumulate_all(const ReferenceCommand& c, bool* whole) {
  RETURN_IF_ERROR(check_files(c));
  std::unique_ptr<Rig> rig;
  RETURN_IF_ERROR(open_for_reference(c, &rig));
  const Settings& settings = rig->opened.renderer.settings;
  std::string key = reference_key(*rig, c.options, c.goal.transport);
  Accumulation sum = empty_accumulation(key, settings.width, settings.height);
  if (platform::file_stamp(c.goal.path.c_str()) != 0) RETURN_IF_ERROR(add_file(c.goal.path, &sum));
  for (const std::string& path : c.merged) RETURN_IF_ERROR(add_file(path, &sum));
  RETURN_IF_ERROR(run_reference(c.goal, rig.get(), &sum, whole));
  return tell(c, *rig, sum);
}

int lead(ReferenceCommand command) {
  bool whole = true;
  Status status = read_goal(&command);
  if (status.ok) status = check_limit(Quantity::seconds, command.options.seconds, "--time");
  if (status.ok) status = accumulate_all(command, &whole);
  if (!status.ok) return report(status);
  if (whole) return kExitDone;
  std::fprintf(stderr, "pocketray: interrupted; samples so far are in %s: run the same command to continue\n",
               shown(command.goal.path).c_str());
  return kExitInterrupted;
}

int run(ReferenceCommand command) {
  const Team& team = command.goal.team;
  command.options.common.threads = team_threads(team, command.options.common.threads);
  std::unique_ptr<Rig> rig;
  ReferenceHelper helper(team, command.options, [&](Rig** found) { return *found = rig.get(), success(); });
  auto open = [&] {
    RETURN_IF_ERROR(check_limit(Quantity::seconds, command.options.seconds, "--time"));
    RETURN_IF_ERROR(open_for_reference(command, &rig));
    make_rig_reference(rig.get());  // while the leader makes its own
    return success();
  };
  return run_in_team(
      team, [&] { return lead(command); }, open, [&](const TeamMessage& message) { return helper.work(message); });
}

}  // namespace

void add_reference_command(Command program, const Team& team, int* exit_status) {
  auto c = std::make_shared<ReferenceCommand>();
  c->goal.team = team;
  Command command = program.add_subcommand("reference", "render a reference picture to judge others by");
  add_view_options(command, &c->options.common);
  add_look_options(command, &c->options.common);
  command.chapter("Animation");
  command.add_option("--time SECONDS", c->options.seconds, "seconds into the animation")
      .range(-kSecondsMax, kSecondsMax)
      .capture_default_str();
  command.chapter("Samples");
  command.add_option("--kind NAME", c->kind, "light transport")
      .one_of({"model", "physical"})
      .capture_default_str()
      .details("model: the renderer's lighting model, converged. physical: full light transport.");
  command.add_option("--samples N", c->goal.samples, "samples per pixel, of all parts")
      .range(2, kReferenceHalfCount * kReferenceSampleMax)
      .default_str("256; model: 2048")
      .details("With --until, there is no limit unless this option sets one.");
  command.add_option("--until X", c->goal.until, "stop when its own error is ꟻLIP X or less").range(1e-6, 1);
  command.add_option("--part K/N", c->part, "take only part K of N of the samples");
  command.add_option("--merge FILE", c->merged, "add the samples of other files");
  command
      .add_option("--pixels-per-degree,--ppd X", c->goal.pixels_per_degree,
                  "pixels per degree of visual angle, for ꟻLIP")
      .range(1, 1000)
      .capture_default_str();
  command.chapter("Output");
  command.add_option("-o,--output FILE", c->goal.path, "file to write or to continue, .pfm").required();
  add_json_option(command, &c->options.common.json);
  command.everyday("Output", {"--output", "--json"});
  command.everyday("Picture", {"--size", "--camera", "--time", "--environment"});
  command.everyday("Samples", {"--kind", "--samples", "--until", "--part", "--merge", "--threads"});
  command.example("pocketray reference cornell -o cornell.pfm --until 0.02");
  command.example("pocketray accuracy cornell -o DIR --reference cornell.pfm");
  command.about(
      "Traces paths in double precision and adds them up in a .pfm file: a picture of linear light, followed by the "
      "sums. "
      "The file is saved every minute and when interrupted; the same command continues it. Runs on several machines "
      "take "
      "one part each, and --merge adds their files; the result equals that of one run, bit for bit. Two halves of the "
      "samples are independent, and their difference gives the error: as ꟻLIP and RMSE, and per region.");
  command.about(
      "Cornell's sphere has 256 columns here, as in the references of `accuracy`. A build with MPI shares the samples "
      "among the ranks of `mpirun -n 8 pocketray reference …`, with the same result.");
  command.callback([=] {
    c->options.common.outputs = {{"--output", c->goal.path}};
    *exit_status = run(*c);
  });
}

}  // namespace pocketray
