// The plan of a sweep and the summary of its figures.
#include "desktop/accuracy/findings.h"
#include "desktop/accuracy/sum_up.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <set>

#include "base/rng.h"
#include "desktop/accuracy/csv.h"
#include "effect/setting_list.h"
#include "support/effort.h"

using namespace pocketray;

namespace {

Status always(const Settings&) { return success(); }

EffectPlan all_effects() {
  EffectPlan plan;
  plan.mask = kAllEffects;
  return plan;
}

const SweptKnob& knob_named(const SweepPlan& plan, const char* name) {
  for (const SweptKnob& k : plan.knobs)
    if (std::strcmp(k.knob->name, name) == 0) return k;
  REQUIRE(false);
  return plan.knobs[0];
}

const Measured& measured_as(const Sweep& sweep, const char* knob, const char* value) {
  for (const Measured& m : sweep.measured)
    if (m.knob == knob && m.value == value) return m;
  REQUIRE(false);
  return sweep.measured[0];
}

// Times of a power law with noise common to a round; errors that fall with the square root of time to a rest owed to
// other knobs.
std::vector<PointFigures> made_up(const SweepPlan& plan) {
  std::vector<PointFigures> figures;
  for (const SweepPoint& point : plan.points) {
    PointFigures f;
    f.has_errors = true;
    f.truth.flip = f.model.flip = f.flip_before = 0.1 / std::sqrt(point.price);
    f.errors.rmse = std::sqrt(0.02 * 0.02 + 0.01 / point.price);
    for (int round = 0; round < 15; ++round) f.ns_per_pixel.push_back(1000 * point.price * (1 + 0.1 * (round % 5)));
    figures.push_back(f);
  }
  return figures;
}

}  // namespace

// Goal: each value of each knob occurs once, with all other knobs as in the baseline; the covering set varies several
// within the limit. Method: cornell with every effect.
TEST_CASE("sweep_plan_turns_one_knob_at_a_time_and_then_several") {
  Configuration baseline;
  SweepPlan plan = plan_sweep("cornell", all_effects(), baseline, always, 16);
  CHECK(plan.points[0].knob == "baseline");
  CHECK(plan.knobs.size() == knob_list().size() - bake_knobs().size());
  std::set<std::string> ids;
  std::size_t end = 1;
  for (const SweptKnob& swept : plan.knobs) {
    CHECK(swept.first == end);
    end += swept.count;
    int defaults = 0;
    for (std::size_t i = swept.first; i < end; ++i) {
      const SweepPoint& p = plan.points[i];
      CHECK(p.knob == swept.knob->name);
      CHECK(p.missing.empty());
      defaults += p.is_default;
      for (const SweptKnob& other : plan.knobs)
        if (&other != &swept) CHECK(other.knob->get(p.configuration) == other.knob->get(baseline));
    }
    CHECK(defaults == 1);
  }
  CHECK(plan.points.size() >= end + 6);
  for (std::size_t i = 0; i < plan.points.size(); ++i) {
    CHECK(ids.insert(plan.points[i].knob + plan.points[i].value).second);
    if (i < end) continue;
    CHECK(plan.points[i].knob == "several");
    CHECK(plan.points[i].price <= 16);
    int turned = 0;
    for (const SweptKnob& k : plan.knobs) turned += k.knob->get(plan.points[i].configuration) != k.knob->get(baseline);
    for (const SweptKnob& k : plan.knobs)
      if (k.knob->alone) CHECK(k.knob->get(plan.points[i].configuration) == k.knob->get(baseline));
    CHECK(turned >= 2);
  }
}

// Goal: available settings of a ladder within the limit are measured once, and only settings that can change from frame
// to frame are on the front. Method: a ladder with a new configuration, an existing one, one beyond the limit and an
// unavailable one; knobs that are not frame settings.
TEST_CASE("sweep_plan_measures_a_ladder_beside_the_knobs") {
  Configuration baseline;
  std::vector<Settings> ladder(5, baseline.settings);
  ladder[1].samples_per_pixel = 16;
  ladder[2].samples_per_pixel = 4, ladder[2].ray_depth = 5;
  ladder[3].samples_per_pixel = 16, ladder[3].points_per_area_light = 144;
  ladder[4].samples_per_pixel = 2, ladder[4].ray_depth = 3;
  auto had = [](const Settings& s) { return s.samples_per_pixel == 2 && s.ray_depth == 3 ? failure("no") : success(); };
  std::size_t without = plan_sweep("cornell", all_effects(), baseline, had, 16).points.size();
  SweepPlan plan = plan_sweep("cornell", all_effects(), baseline, had, 16, ladder);
  REQUIRE(plan.points.size() == without + 1);
  CHECK(plan.points.back().knob == "several");
  CHECK(plan.points.back().value == "samples 4, depth 5");
  CHECK(plan.points.back().configuration.settings.ray_depth == 5);
  CHECK(plan.points.back().price == 4);
  // A ladder may take a method whose settings the baseline ignores.
  EffectPlan ambient;
  ambient.mask = bit(Effect::ambient);
  Settings lit = baseline.settings;
  lit.indirect = indirect_choice(Effect::instant_radiosity), lit.virtual_lights = 256;
  CHECK(plan_sweep("file.pray", ambient, baseline, always, 16, {lit}).points.back().value ==
        "indirect instant-radiosity, virtual-lights 256");

  std::vector<PointFigures> figures = made_up(plan);
  for (std::size_t i = 0; i < plan.points.size(); ++i)
    if (!plan.points[i].is_choice) figures[i].truth.flip = 0.001;  // less than any other
  Sweep sweep;
  sum_up(plan, figures, &sweep);
  int front = 0, others = 0;
  for (std::size_t i = 0; i < plan.points.size(); ++i) {
    const Configuration& c = plan.points[i].configuration;
    bool is_choice = c.output == baseline.output && c.sphere_columns == baseline.sphere_columns && !c.near_lossless;
    CHECK(plan.points[i].is_choice == is_choice);
    front += sweep.measured[i].pareto && is_choice, others += sweep.measured[i].pareto && !is_choice;
  }
  CHECK(front > 2);
  CHECK(others == 0);
}

// Goal: each method of indirect light that a scene has is measured with every combination of its own settings, once,
// and with no others. Method: a scene that stores radiosity; then one that does not, where asking for it gives the
// ambient term.
TEST_CASE("sweep_plan_combines_the_settings_of_each_method") {
  EffectPlan effects;
  effects.mask = bit(Effect::radiosity);
  bool stores_it = true;
  auto effects_with = [&](const Settings& s) -> EffectMask {
    if (s.indirect == IndirectChoice::none) return 0;
    if (s.indirect == indirect_choice(Effect::instant_radiosity)) return bit(Effect::instant_radiosity);
    return bit(s.indirect == indirect_choice(Effect::ambient) || !stores_it ? Effect::ambient : Effect::radiosity);
  };
  SweepPlan plan = plan_sweep("file.pray", effects, Configuration(), always, 16, {}, effects_with);
  // Those that differ from the baseline in samples, the method and its settings alone.
  std::map<std::string, std::vector<Settings>> compared;
  for (const SweepPoint& p : plan.points) {
    Settings others = p.configuration.settings;
    others.samples_per_pixel = 1, others.indirect = IndirectChoice::automatic;
    others.virtual_lights = 64, others.compensation = Compensation::none;
    others.reconstruction = Reconstruction::bicubic;
    if (p.is_choice && !p.is_default && same_quality(others, Settings()))
      compared[p.indirect].push_back(p.configuration.settings);
  }
  auto count_of = [&](const char* method, std::uint32_t samples) {
    const std::vector<Settings>& all = compared[method];
    return std::count_if(all.begin(), all.end(), [&](const Settings& s) { return s.samples_per_pixel == samples; });
  };
  for (const auto& method : compared)
    for (std::size_t i = 0; i < method.second.size(); ++i)
      for (std::size_t k = 0; k < i; ++k) CHECK_FALSE(same_quality(method.second[i], method.second[k]));
  CHECK((count_of("none", 1) == 1 && count_of("none", 4) >= 1));
  CHECK((count_of("ambient", 1) == 1 && count_of("ambient", 4) == 1));
  CHECK((count_of("radiosity", 1) == 4 + 1 && count_of("radiosity", 4) == 5));  // also asked for by name
  CHECK(count_of("instant-radiosity", 1) == 6 * 2);
  CHECK(count_of("instant-radiosity", 4) == 6 * 2);
  const SweepPlan cheap = plan_sweep("file.pray", effects, Configuration(), always, 8, {}, effects_with);
  for (const SweepPoint& p : cheap.points)  // beyond twice the limit
    CHECK((p.configuration.settings.virtual_lights < 512 || p.configuration.settings.samples_per_pixel < 4));
  for (const Settings& s : compared["ambient"]) CHECK((s.virtual_lights == 64 && s.compensation == Compensation::none));
  stores_it = false, effects.mask = bit(Effect::ambient);
  plan = plan_sweep("file.pray", effects, Configuration(), always, 16, {}, effects_with);
  for (const SweepPoint& p : plan.points) CHECK(p.indirect != "radiosity");
}

// Goal: the sweep's judge marks the front, and each knob has its own: methods of indirect light are judged by the
// truth, numerical settings by the model. Method: made-up errors that fall against the model and rise against the
// truth.
TEST_CASE("sweep_judges_what_is_seen_by_the_truth") {
  SweepPlan plan = plan_sweep("file.pray", all_effects(), Configuration(), always, 16);
  std::vector<PointFigures> figures = made_up(plan);
  for (PointFigures& f : figures) f.truth.flip = 0.2 - f.model.flip;
  Sweep sweep;
  sweep.width = sweep.height = 10;
  sum_up(plan, figures, &sweep);
  int front = 0;
  for (const Measured& m : sweep.measured) front += m.pareto && !m.is_default;
  CHECK(front <= 1);  // the fastest
  CHECK(front_of(sweep, Judge::model).size() > 3);
  for (const KnobFigures& knob : sweep.knobs) {
    CAPTURE(knob.name);
    const bool is_method = knob.name == "indirect" || knob.name == "reconstruction" || knob.name == "virtual-lights" ||
                           knob.name == "compensation";
    CHECK((knob.judge == Judge::truth) == is_method);
    if (knob.name == "samples") CHECK(knob.ms_per_flip > 0);
    if (knob.name == "virtual-lights") CHECK((std::isnan(knob.ms_per_flip) && !knob.has_slope));
  }
  sweep.judge = Judge::model;
  sum_up(plan, figures, &sweep);
  front = 0;
  for (const Measured& m : sweep.measured) front += m.pareto && !m.is_default;
  CHECK(front > 3);
}

// Goal: unavailable values are listed with the reason and not in the covering set. Method: at most 36 points per area
// light.
TEST_CASE("sweep_plan_lists_what_cannot_be_had") {
  auto few = [](const Settings& s) { return s.points_per_area_light > 36 ? failure("too many points") : success(); };
  SweepPlan plan = plan_sweep("file.pray", all_effects(), Configuration(), few, 1e9);
  const SweptKnob& lights = knob_named(plan, "area-lights");
  int missing = 0;
  for (std::size_t i = lights.first; i < lights.first + lights.count; ++i)
    missing += plan.points[i].missing == "too many points";
  CHECK(missing == 3);
  std::uint32_t most = 0;
  for (const SweepPoint& p : plan.points)
    if (p.missing.empty()) most = std::max(most, p.configuration.settings.points_per_area_light);
  CHECK(most == 36);
  CHECK(std::any_of(plan.notes.begin(), plan.notes.end(),
                    [](const std::string& n) { return n.find("tessellation") != std::string::npos; }));
  Sweep sweep;
  sum_up(plan, made_up(plan), &sweep);
  CHECK(measured_as(sweep, "area-lights", "256").missing == "too many points");
}

// Goal: slopes, ratios and the front follow from the figures. Method: figures of a law with exponent -1/2.
TEST_CASE("sweep_sums_up_what_was_measured") {
  SweepPlan plan = plan_sweep("file.pray", all_effects(), Configuration(), always, 16);
  Sweep sweep;
  sweep.width = 100, sweep.height = 10, sweep.model.rmse = 0;
  sum_up(plan, made_up(plan), &sweep);
  REQUIRE(sweep.measured.size() == plan.points.size());
  const Measured& sixteen = measured_as(sweep, "samples", "16");
  CHECK(std::fabs(sixteen.time_ratio.value - 16) < 1e-9);
  CHECK(sixteen.time_ratio.low == sixteen.time_ratio.high);     // both share the round's noise
  CHECK(sixteen.ns_per_pixel.low < sixteen.ns_per_pixel.high);  // but its own time has it
  CHECK(sweep.measured[0].ns_per_pixel.low < sweep.measured[0].ns_per_pixel.high);
  CHECK(sixteen.ns_per_pixel.value == doctest::Approx(16 * 1200));
  CHECK(measured_as(sweep, "samples", "1").is_default);
  for (const KnobFigures& k : sweep.knobs) {
    if (k.name != "samples") continue;
    REQUIRE(k.has_slope);
    CHECK(k.slope.value == doctest::Approx(-0.5));
    CHECK(k.slope_misfit < 1e-4);
    // From 1 to 16 samples: 15 × 1.2 ms for 0.1 × 3/4 of ꟻLIP.
    CHECK(k.ms_per_flip == doctest::Approx(18.0 / 7.5));
  }
  CHECK(sixteen.pareto);
  int front = 0;
  for (const Measured& m : sweep.measured) front += m.pareto;
  // A coarse reference allows less to be claimed: no slope of errors below its limit, no small steps on the front.
  sweep.model.rmse = 0.009;
  std::vector<PointFigures> figures = made_up(plan);
  for (std::size_t i = 0; i < figures.size(); ++i) {
    figures[i].truth.one.assign(figures.size(), 0), figures[i].truth.other.assign(figures.size(), 0);
    figures[i].truth.one[i] = 0.02f * static_cast<float>(figures.size());
  }
  sum_up(plan, figures, &sweep);
  int coarse = 0;
  for (const Measured& m : sweep.measured) coarse += m.pareto;
  CHECK(coarse < front);
  for (const KnobFigures& k : sweep.knobs)
    if (k.name == "samples") CHECK_FALSE(k.has_slope);
}

#ifdef POCKETRAY_HAVE_NETWORK
// Goal: rows from a render server have bytes in place of a price in time, and are never on the front, however good.
// Method: made-up figures, best where rows are near-lossless.
TEST_CASE("sweep_sums_up_rows_that_are_sent") {
  SweepPlan plan = plan_sweep("file.pray", all_effects(), Configuration(), always, 16);
  const SweptKnob& sent = knob_named(plan, "near-lossless");
  std::vector<PointFigures> figures = made_up(plan);
  REQUIRE((sent.count == 2 && plan.points[sent.first].value == "on"));
  figures[0].bytes_per_frame = 4000, figures[sent.first].bytes_per_frame = 2500, figures[sent.first].truth.flip = 1e-4;
  Sweep sweep;
  sweep.width = 100, sweep.height = 10, sweep.model.rmse = 0;
  sum_up(plan, figures, &sweep);
  const Measured &on = measured_as(sweep, "near-lossless", "on"), &off = measured_as(sweep, "near-lossless", "off");
  CHECK(on.bytes_per_frame == 2500);
  CHECK(off.bytes_per_frame == 4000);
  CHECK_FALSE(on.pareto);
  CHECK(on.note.find("without a server") != std::string::npos);
  CHECK(std::isnan(sweep.knobs[static_cast<std::size_t>(&sent - plan.knobs.data())].ms_per_flip));
  CHECK(sweep_csv(sweep).find(",2500,0,,") != std::string::npos);
}
#endif

// Goal: a sweep's 95 % intervals of times, ratios and slopes cover the truth in 93 to 97 % of sweeps. Method: sweeps of
// 15 rounds with noise per round, per run and both; a baseline measured by the median of three; truths from the made-up
// distributions.
TEST_CASE("sweep_intervals_hold_the_truth") {
  SweepPlan plan = plan_sweep("file.pray", all_effects(), Configuration(), always, 1);
  const SweptKnob& samples = knob_named(plan, "samples");
  const int sweeps = kEffortDivisor > 1 ? 40 : 500;
  const double slack = kEffortDivisor > 1 ? 0.12 : 0.02;
  auto gaussian = [](Rng* rng) {
    double sum = -6;
    for (int i = 0; i < 12; ++i) sum += next_double(rng);
    return sum;
  };
  for (double mood : {0.0, 0.03, 0.3}) {
    Rng rng = make_rng(12);
    auto run = [&] { return std::exp(0.02 * gaussian(&rng)); };
    int held_time = 0, held_ratio = 0, held_slope = 0;
    for (int round_of_sweeps = 0; round_of_sweeps < sweeps; ++round_of_sweeps) {
      std::vector<PointFigures> figures = made_up(plan);
      for (PointFigures& f : figures) f.ns_per_pixel.clear();
      for (int round = 0; round < 15; ++round) {
        double round_mood = std::exp(mood * gaussian(&rng));
        figures[0].ns_per_pixel.push_back(1000 * round_mood * median({run(), run(), run()}));
        for (std::size_t i = 1; i < figures.size(); ++i)
          figures[i].ns_per_pixel.push_back(1000 * plan.points[i].price * round_mood * run());
      }
      Sweep sweep;
      sum_up(plan, figures, &sweep);
      const Measured& sixteen = measured_as(sweep, "samples", "16");
      held_time += sixteen.ns_per_pixel.low <= 16000 && 16000 <= sixteen.ns_per_pixel.high;
      held_ratio += sixteen.time_ratio.low <= 16 && 16 <= sixteen.time_ratio.high;
      const KnobFigures& k = sweep.knobs[static_cast<std::size_t>(&samples - plan.knobs.data())];
      REQUIRE(k.has_slope);
      held_slope += k.slope.low <= -0.5 && -0.5 <= k.slope.high;
    }
    CAPTURE(mood);
    CHECK(std::fabs(double(held_time) / sweeps - 0.95) < slack);
    CHECK(std::fabs(double(held_ratio) / sweeps - 0.95) < slack);
    CHECK(std::fabs(double(held_slope) / sweeps - 0.95) < slack);
  }
}

// Goal: the table has a line for each configuration and a field for each name, whatever the texts hold. Method: fields
// counted outside quotes.
TEST_CASE("csv_has_a_field_for_each_name") {
  SweepPlan plan = plan_sweep("file.pray", all_effects(), Configuration(), always, 16);
  Sweep sweep;
  sum_up(plan, made_up(plan), &sweep);
  sweep.measured[1].missing = "a \"quoted\", reason";
  sweep.measured[2].errors.psnr = std::numeric_limits<double>::infinity();
  std::string csv = sweep_csv(sweep);
  CHECK(csv.rfind("knob,value,ns_per_pixel,", 0) == 0);
  CHECK(csv.find("\"a \"\"quoted\"\", reason\"") != std::string::npos);
  CHECK(csv.find(",inf,") != std::string::npos);
  CHECK(csv.find("nan") == std::string::npos);
  std::size_t lines = 0, fields = 1, names = 0;
  bool quoted = false;
  for (char c : csv) {
    quoted ^= c == '"';
    fields += c == ',' && !quoted;
    if (c != '\n' || quoted) continue;
    names = names ? names : fields;
    CHECK(fields == names);
    fields = 1, ++lines;
  }
  CHECK(lines == sweep.measured.size() + 1);
}
