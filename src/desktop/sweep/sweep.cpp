#include "desktop/sweep/sweep.h"

#include <zlib.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>

#include "base/check.h"
#include "base/limit_list.h"
#include "base/rng.h"
#include "desktop/accuracy/claim.h"
#include "desktop/accuracy/display.h"
#include "desktop/accuracy/findings.h"
#include "desktop/sweep/instructions.h"
#include "desktop/sweep/picture_errors.h"
#include "desktop/sweep/radiosity_prediction.h"
#include "desktop/sweep/references.h"
#include "desktop/sweep/rigs.h"
#include "effect/setting_list.h"
#include "plan/quality_level.h"
#include "platform/file.h"
#include "platform/instructions.h"
#include "session/interrupt.h"
#include "session/note.h"
#include "session/progress.h"

namespace pocketray {
namespace {

// Baseline measurements per round; all others are divided by them.
constexpr int kBaselineRuns = 3;
constexpr std::uint32_t kRoundsMax = 1000;
// Time of a sample of full light transport, in samples of the lighting model: 1.0 to 5.5 in eight scenes.
constexpr double kPhysicalSamplePrice = 2;

struct SweepRun {
  const AccuracyOptions& options;
  Rigs rigs;
  SweepPlan plan;
  AccuracyState state;
  Judges judges;
  double comparison_price = 0;  // of a point's first picture, in frames of the baseline
};

Json settings_json(const Quality& quality) {
  Json settings;
  for (const SettingRow& row : kSettingList) {
    double value = row.field.get(quality);
    if (row.field.kind == SettingKind::count) settings[row.name] = static_cast<std::uint32_t>(value);
    if (row.field.kind == SettingKind::real) settings[row.name] = value;
    if (row.field.kind == SettingKind::choice) settings[row.name] = row.field.names[static_cast<int>(value)];
  }
  return settings;
}

Json key_of(const SweepRun& run, const Rig& rig) {
  const AccuracyOptions& o = run.options;
  const CommonOptions& c = o.common;
  const Settings& settings = rig.baseline.settings;
  std::string ids;
  for (const SweepPoint& point : run.plan.points) ids += id_of(point) + "\n";
  Json key = settings_json(settings);
  key.update(
      {{"program", POCKETRAY_VERSION},
       {"scene", c.scene},
       {"content", rig.scene_hash},
       {"size", std::to_string(settings.width) + "x" + std::to_string(settings.height)},
       {"camera", c.camera},
       {"camera-index", c.camera_index},
       {"time", o.seconds},
       {"exposure", c.exposure},
       {"effects", c.effects},
       {"look", {c.background, c.environment, c.light, c.fov, c.focus}},
       {"output", o.output},
       {"reference", o.reference},
       {"reference-file", o.reference_file},
       {"reference-samples", {reference_samples(o, Transport::physical), reference_samples(o, Transport::model)}},
       {"ppd", o.pixels_per_degree},
       {"threads", settings.threads},
       {"isa", isa_name(active_isa())},
       {"accel", rig.opened.renderer.accel.info->name},
       {"emulate", c.emulate},
       {"bake-choices", o.bakes},
       {"configurations", crc32_z(0, reinterpret_cast<const Bytef*>(ids.data()), ids.size())}});
  return key;
}

// The quality's options, except those at their defaults.
std::string options_of(const Quality& quality) {
  std::string options;
  for (const SettingRow& row : kSettingList) {
    if (row.field.get(quality) == row.field.get(Quality())) continue;
    char value[32];
    describe_value(row, row.field.get(quality), 3, value, sizeof value);
    options += (options.empty() ? "--" : " --") + std::string(row.name) + " " + value;
  }
  return options;
}

// Order of a round: points at random, the baseline several times.
std::vector<std::size_t> round_order(const SweepPlan& plan, std::uint32_t round) {
  CHECK(!plan.points.empty());
  std::vector<std::size_t> order(kBaselineRuns, 0);
  for (std::size_t i = 1; i < plan.points.size(); ++i)
    if (is_measured(plan, i)) order.push_back(i);
  Rng rng = make_rng(15, round);
  for (std::size_t i = order.size(); i > 1; --i)
    std::swap(order[i - 1], order[static_cast<std::size_t>(next_double(&rng) * static_cast<double>(i))]);
  return order;
}

struct RoundProgress {
  Progress progress;
  double done = 0;
};

// Measures each point once. After an interrupt *whole is false and the round's times are discarded.
Status measure_round(SweepRun* run, RoundProgress* progress, bool* whole) {
  CHECK_LT(run->state.rounds, run->options.rounds);
  std::map<std::size_t, std::vector<double>> times;
  for (std::size_t i : round_order(run->plan, run->state.rounds)) {
    const SweepPoint& point = run->plan.points[i];
    Rig* rig;
    const Status opened = rig_for(&run->rigs, point.configuration, &rig);
    *whole = !interrupted;  // which ends a solution of radiosity, too
    if (!*whole) return success();
    RETURN_IF_ERROR(opened);
    double ns_per_pixel = 0;
    RETURN_IF_ERROR(time_frame(rig, point.configuration, run->options.seconds, &ns_per_pixel));
    *whole = !interrupted;
    if (!*whole) return success();
    times[i].push_back(ns_per_pixel);
    PointFigures* f = &run->state.points[id_of(point)];
    const bool counts_bytes = i == 0 || point.configuration.near_lossless;
    if (!f->has_errors) progress->done += 1000 * run->comparison_price;
    if (!f->has_errors)
      RETURN_IF_ERROR(find_errors(run->options, run->judges, counts_bytes, point.configuration, rig, f));
    if (i == 0 || !is_as_opened(point.configuration.bake)) f->stored_bytes = rig->stored_bytes;
    if (std::isnan(f->bake_seconds)) f->bake_seconds = rig->bake_seconds;
    *whole = f->has_errors;
    if (!*whole) return success();
    if (run->state.counted.empty() && std::isnan(f->instructions_per_pixel))
      RETURN_IF_ERROR(count_instructions(rig, point.configuration, run->options.seconds, &f->instructions_per_pixel));
    progress->done += 1000 * point.price;
    show_progress(&progress->progress, static_cast<std::uint64_t>(progress->done));
  }
  for (const auto& entry : times)
    run->state.points[id_of(run->plan.points[entry.first])].ns_per_pixel.push_back(median(entry.second));
  ++run->state.rounds;
  return success();
}

// A state from a file may lack points.
Status check_state(const SweepRun& run) {
  bool all = run.state.rounds <= kRoundsMax;
  for (std::size_t i : round_order(run.plan, 0)) {
    auto there = run.state.points.find(id_of(run.plan.points[i]));
    std::size_t rounds = there == run.state.points.end() ? 0 : there->second.ns_per_pixel.size();
    all = all && rounds == run.state.rounds;
  }
  return all ? success()
             : failure("%.200s holds a sweep with configurations missing: use --restart to start over",
                       run.options.folder.c_str());
}

double price_of_round(const SweepRun& run) {
  double price = 0;
  for (std::size_t i : round_order(run.plan, 0)) price += run.plan.points[i].price;
  return price;
}

std::uint32_t uncompared_points(const SweepRun& run) {
  std::uint32_t count = 0;
  for (const SweepPoint& point : run.plan.points) {
    const auto known = run.state.points.find(id_of(point));
    count += known == run.state.points.end() || !known->second.has_errors;
  }
  return count;
}

// Forecasts the time of the rounds to come from a frame of the baseline and one comparison; 0 after an interrupt.
Status forecast_rounds(SweepRun* run, double* seconds) {
  const SweepPoint& baseline = run->plan.points[0];
  Rig* rig;
  RETURN_IF_ERROR(rig_for(&run->rigs, baseline.configuration, &rig));
  const std::uint64_t start = clock_ns();
  double ns_per_pixel;
  RETURN_IF_ERROR(time_frame(rig, baseline.configuration, run->options.seconds, &ns_per_pixel));
  const std::uint64_t rendered = clock_ns();
  const Settings& settings = baseline.configuration.settings;
  const std::vector<float> black(std::size_t(3) * settings.width * settings.height, 0.0f);
  flip_errors(black, black, settings.width, settings.height, run->options.pixels_per_degree);
  constexpr double kComparisons = 9;  // of a point: two references and their halves, and other formats
  const double frame_seconds = static_cast<double>(rendered - start) * 1e-9;
  const double comparison_seconds = kComparisons * static_cast<double>(clock_ns() - rendered) * 1e-9;
  run->comparison_price = comparison_seconds / std::max(frame_seconds, 1e-6);
  *seconds = frame_seconds * price_of_round(*run) * (run->options.rounds - run->state.rounds) +
             comparison_seconds * uncompared_points(*run);
  if (interrupted) *seconds = 0;
  return success();
}

Status measure_rounds(SweepRun* run, bool* whole) {
  *whole = true;
  if (run->state.rounds >= run->options.rounds) return success();
  const double price = 1000 * (price_of_round(*run) * (run->options.rounds - run->state.rounds) +
                               run->comparison_price * uncompared_points(*run));
  RoundProgress progress;
  progress.progress = start_progress("configurations", static_cast<std::uint64_t>(price));
  Status status;
  while (*whole && status.ok && run->state.rounds < run->options.rounds) {
    status = measure_round(run, &progress, whole);
    if (status.ok) status = save_state(run->options.folder, run->state);
  }
  end_progress(&progress.progress);
  return status;
}

Status add_strip(SweepRun* run, const SweptKnob& swept, Sweep* sweep, bool* whole) {
  CHECK_LE(swept.first + swept.count, sweep->measured.size());
  Strip strip;
  strip.knob = swept.knob->name;
  std::vector<std::size_t> there;
  for (std::size_t i = swept.first; i < swept.first + swept.count; ++i)
    if (sweep->measured[i].missing.empty()) there.push_back(i);
  for (std::size_t i : there) {
    const SweepPoint& point = run->plan.points[i];
    if (i != there.front() && i != there.back() && !point.is_default) continue;
    Rig* rig;
    RETURN_IF_ERROR(rig_for(&run->rigs, point.configuration, &rig));
    double ns_per_pixel;
    RETURN_IF_ERROR(time_frame(rig, point.configuration, run->options.seconds, &ns_per_pixel));
    *whole = !interrupted;
    if (!*whole) return success();
    StripRow row;
    RETURN_IF_ERROR(find_levels(run->options, rig, point.configuration, &row.picture, nullptr));
    *whole = !interrupted;
    if (!*whole) return success();
    row.label = point.knob + " " + point.value;
    row.ms = sweep->measured[i].ns_per_pixel.value * 1e-6 * sweep->width * sweep->height;
    row.flip = distance_to(sweep->measured[i], judge_of(*swept.knob)).flip;
    if (is_paid_in_bytes(ends_of(*sweep, strip.knob))) row.bytes = sweep->measured[i].bytes_per_frame;
    const ReferencePictures& judge = judge_of(*swept.knob) == Judge::truth ? run->judges.truth : run->judges.model;
    row.flip_map = flip_errors(judge.encoded, encoded_levels(row.picture), sweep->width, sweep->height,
                               run->options.pixels_per_degree);
    strip.rows.push_back(std::move(row));
  }
  sweep->strips.push_back(std::move(strip));
  return success();
}

ReferenceFigures figures_of(const ReferencePictures& pictures) {
  return {static_cast<std::uint32_t>(pictures.samples), pictures.rmse, pictures.flip};
}

Status render_references(SweepRun* run, Sweep* sweep, bool* whole) {
  Rig* rig;
  RETURN_IF_ERROR(reference_rig(&run->rigs, &rig));
  const ReferencePictures &truth = run->judges.truth, &model = run->judges.model;
  LaterWork later;
  RETURN_IF_ERROR(forecast_rounds(run, &later.seconds));
  LaterWork physical = later;
  physical.share = kPhysicalSamplePrice * reference_samples(run->options, Transport::physical) /
                   reference_samples(run->options, Transport::model);
  RETURN_IF_ERROR(
      render_reference(run->options, Transport::model, physical, rig, &run->state, &run->judges.model, whole));
  if (!*whole) return success();
  RETURN_IF_ERROR(
      render_reference(run->options, Transport::physical, later, rig, &run->state, &run->judges.truth, whole));
  if (!*whole) return success();
  sweep->truth = figures_of(truth), sweep->model = figures_of(model);
  sweep->reference_picture = model.levels, sweep->truth_picture = truth.levels;
  double noise;
  sweep->model_distance =
      distance_of(truth, model.encoded, sweep->width, sweep->height, run->options.pixels_per_degree, &noise).flip;
  std::vector<double> of_one = truth.one, of_other = truth.other, none(of_one.size(), 0.0);
  for (std::size_t i = 0; i < none.size(); ++i) of_one[i] -= model.one[i], of_other[i] -= model.other[i];
  sweep->model_rmse = unbiased_rmse(of_one, of_other, none);
  close_rig(&run->rigs, rig);
  return success();
}

// Renders the pictures of the levels of quality.
Status add_quality(SweepRun* run, const Front& measured, Sweep* sweep, bool* whole) {
  if (measured.count < 2 || sweep->judge != Judge::truth) return success();
  Front front = measured;
  show_24_bits(&front);
  for (int i = 0; i < kQualityLevelCount; ++i) {
    const Candidate candidate = level_of(front, static_cast<QualityLevel>(i));
    Configuration configuration = run->plan.points[0].configuration;
    configuration.settings = with_candidate(configuration.settings, candidate);
    configuration.output = find_output_format("rgb888");
    Rig* rig;
    RETURN_IF_ERROR(rig_for(&run->rigs, configuration, &rig));
    double ns_per_pixel;
    RETURN_IF_ERROR(time_frame(rig, configuration, run->options.seconds, &ns_per_pixel));
    *whole = !interrupted;
    if (!*whole) return success();
    LevelPicture level = {kQualityLevelNames[i],
                          options_of(candidate),
                          ms_of(*sweep, candidate.ns_per_pixel),
                          candidate.flip,
                          {},
                          point_of_front(run->plan, *sweep, candidate)};
    RETURN_IF_ERROR(find_levels(run->options, rig, configuration, &level.picture, nullptr));
    sweep->quality.push_back(level);
  }
  return success();
}

Status check_options(const AccuracyOptions& o) {
  if (find_output_format(o.output) < 0)
    return failure("--pixel-format is '%s': it must be rgb565, rgb565-dithered or rgb888", o.output.c_str());
  CHECK(o.reference == "model" || o.reference == "physical");  // named
  if (o.rounds < 1 || o.rounds > kRoundsMax)
    return failure("--rounds is %u: it must lie in 1 … %u", o.rounds, kRoundsMax);
  if (!(o.price_limit >= 1 && o.price_limit <= 1e6))
    return failure("--price-limit is %g: it must lie in 1 … 1000000", o.price_limit);
  RETURN_IF_ERROR(check_limit(Quantity::seconds, o.seconds, "--time"));
  if (o.reference_file.empty() && (o.reference_samples == 1 || o.reference_samples > 1000000))
    return failure("--reference-samples is %u: it must lie in 2 … 1000000", o.reference_samples);
  if (!(o.pixels_per_degree >= 1 && o.pixels_per_degree <= 1000))
    return failure("--pixels-per-degree is %g: it must lie in 1 … 1000", o.pixels_per_degree);
  const std::size_t slash = o.folder.rfind('/', o.folder.find_last_not_of('/'));
  if (slash != std::string::npos && slash > 0 && platform::file_stamp(o.folder.substr(0, slash).c_str()) == 0)
    return failure("%.300s cannot be created as a folder: make %.200s first", o.folder.c_str(),
                   o.folder.substr(0, slash).c_str());
  return success();
}

void describe(const SweepRun& run, const Rig& rig, Sweep* sweep) {
  const AccuracyOptions& o = run.options;
  const Settings& settings = rig.baseline.settings;
  sweep->scene = o.common.scene;
  sweep->machine = std::to_string(settings.threads) + (settings.threads == 1 ? " thread, " : " threads, ") +
                   isa_name(active_isa()) + emulation_text(rig.opened.renderer.pace);
  sweep->width = settings.width, sweep->height = settings.height;
  sweep->pixels_per_degree = o.pixels_per_degree;
  sweep->judge = o.reference == "model" ? Judge::model : Judge::truth;
  sweep->output = o.output;
  sweep->notes = run.plan.notes;
}

// Counts instructions if the CPU does not and has counted none of this sweep.
Status count_otherwise(SweepRun* run, const Rig& rig, bool by_cpu, Sweep* sweep, bool* whole) {
  for (const auto& point : run->state.points) by_cpu = by_cpu || std::isfinite(point.second.instructions_per_pixel);
  if (by_cpu && run->state.counted.empty()) return success();
  std::string note;
  count_by_valgrind(run->options, rig, run->plan, &run->state, whole, &note);
  sweep->notes.push_back(note);
  return save_state(run->options.folder, run->state);
}

}  // namespace

Status measure_sweep(const AccuracyOptions& options, Sweep* sweep, bool* whole, SweptFront* front) {
  CHECK(sweep != nullptr && whole != nullptr);
  SweepRun run = {options, {options, {}, {}}, {}, {}, {}};
  *whole = true;
  RETURN_IF_ERROR(check_options(options));
  bool counts = platform::start_instruction_count();  // including later threads
  const Status planned = plan_rigs(&run.rigs, &run.plan);
  *whole = planned.ok || !interrupted;  // while it solved radiosity
  if (!*whole) return success();
  RETURN_IF_ERROR(planned);
  const Rig& rig = *first_rig(run.rigs);
  print_notes(rig.opened);
  describe(run, rig, sweep);
  if (options.bakes) print_note(bake_note(run.plan, rig.opened.renderer.scene));
  RETURN_IF_ERROR(open_state(options.folder, key_of(run, rig), options.restart, &run.state));
  RETURN_IF_ERROR(check_state(run));
  RETURN_IF_ERROR(render_references(&run, sweep, whole));
  if (!*whole) return success();
  RETURN_IF_ERROR(measure_rounds(&run, whole));
  if (!*whole) return success();
  RETURN_IF_ERROR(count_otherwise(&run, rig, counts, sweep, whole));
  if (!*whole) return success();
  std::vector<PointFigures> figures;
  for (const SweepPoint& point : run.plan.points) figures.push_back(run.state.points[id_of(point)]);
  sweep->rounds = run.state.rounds;
  sum_up(run.plan, figures, sweep);
  const Front measured = front_of_sweep(run.plan, *sweep);
  if (front) *front = {measured, rig.front_path, rig.prices_path};
  RETURN_IF_ERROR(predict_radiosity(options, run.judges, &run.rigs, sweep, whole));
  if (!*whole) return success();
  RETURN_IF_ERROR(add_quality(&run, measured, sweep, whole));
  if (!*whole) return success();
  for (const SweptKnob& swept : run.plan.knobs) {
    RETURN_IF_ERROR(add_strip(&run, swept, sweep, whole));
    if (!*whole) return success();
  }
  return success();
}

}  // namespace pocketray
