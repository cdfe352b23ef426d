// The choices of `bake` in a sweep: where they apply, and what is told of them.
#include <doctest/doctest.h>

#include <cmath>
#include <cstring>

#include "accuracy/sample_sweep.h"
#include "desktop/accuracy/csv.h"
#include "desktop/accuracy/sum_up.h"

using namespace pocketray;

namespace {

Status always(const Settings&) { return success(); }

const Knob& knob_named(const char* name) {
  for (const Knob& knob : knob_list())
    if (std::strcmp(knob.name, name) == 0) return knob;
  FAIL("no such knob");
  return knob_list()[0];
}

std::string fitting(const char* name, const BakeableScene& scene) {
  std::string values;
  const Knob& knob = knob_named(name);
  for (double value : knob.values)
    if (knob.bake_unfit(scene, value).empty()) values += value_label(knob, value) + ";";
  return values;
}

SweepPlan plan_of(const BakeableScene* bakeable) {
  EffectPlan all;
  all.mask = kAllEffects;
  return plan_sweep(
      "model.obj", all, Configuration(), always, 1, {}, [](const Settings&) { return bit(Effect::ambient); }, bakeable);
}

std::string baked_knobs(const SweepPlan& plan) {
  std::string names;
  for (const SweptKnob& swept : plan.knobs)
    if (is_bake_choice(*swept.knob)) names += std::string(swept.knob->name) + " ";
  return names;
}

}  // namespace

// Goal: a scene is baked only in ways that change it. Method: models with textures of several sides, without, and
// built-in scenes.
TEST_CASE("bake_knobs_fit_what_a_scene_holds") {
  const BakeableScene small = {true, 128, false}, usual = {true, 512, false}, large = {true, 1024, false},
                      largest = {true, 2048, false}, bare = {true, 0, true}, built_in = {false, 64, true};
  CHECK(fitting("texture-max", small) == "64 texels;2048 texels;");
  CHECK(fitting("texture-max", usual) == "64 texels;128 texels;256 texels;2048 texels;");
  CHECK(fitting("texture-max", large) == "64 texels;128 texels;256 texels;512 texels;2048 texels;");
  CHECK(fitting("texture-max", largest) == "64 texels;128 texels;256 texels;512 texels;1024 texels;2048 texels;");
  CHECK(fitting("texture-max", bare) == "");
  CHECK(fitting("texture-max", built_in) == "");
  CHECK(fitting("mip-maps", large) == "none;stored;");
  CHECK(fitting("mip-maps", bare) == "");
  CHECK(fitting("mip-maps", built_in) == "");
  CHECK(fitting("textures", built_in) == "compressed;exact;");
  CHECK(fitting("textures", bare) == "");
  CHECK(fitting("radiosity", large) == "");
  CHECK(fitting("radiosity", bare) == "as opened;75 patches;300 patches;1200 patches;2400 patches;");
}

// Goal: only a sweep that may bake has these knobs, unchanged settings besides, and never a point on the front. Method:
// plans with and without, all of them equally fast; figures that would put each baked point on the front.
TEST_CASE("bake_knobs_are_swept_on_request_and_never_on_the_front") {
  const BakeableScene lit = {true, 256, true}, dark = {true, 0, false};
  CHECK(baked_knobs(plan_of(nullptr)) == "");
  CHECK(baked_knobs(plan_of(&dark)) == "");
  const SweepPlan plan = plan_of(&lit);
  CHECK(baked_knobs(plan) == "texture-max mip-maps textures radiosity ");
  std::vector<PointFigures> figures;
  for (const SweepPoint& point : plan.points) {
    const bool is_baked = !is_as_opened(point.configuration.bake);
    CHECK((point.configuration.bake.patch_count > 0) == (point.indirect == "radiosity"));
    if (point.knob == "several") CHECK_FALSE(is_baked);
    PointFigures f;
    f.has_errors = true, f.truth.flip = f.model.flip = is_baked ? 0.01 : 0.1;
    f.ns_per_pixel = {is_baked ? 10.0 : 100.0, is_baked ? 11.0 : 110.0};
    f.stored_bytes = is_baked ? 1234 : 5678, f.bake_seconds = is_baked ? 2.5 : kNotMeasured;
    figures.push_back(f);
  }
  Sweep sweep = empty_sweep();
  sum_up(plan, figures, &sweep);
  int baked = 0, missing = 0;
  for (std::size_t i = 0; i < plan.points.size(); ++i) {
    const Measured& m = sweep.measured[i];
    if (is_as_opened(plan.points[i].configuration.bake)) continue;
    missing += !m.missing.empty(), ++baked;
    CHECK_FALSE(m.pareto);
    if (m.missing.empty()) CHECK((m.stored_bytes == 1234 && m.bake_seconds == 2.5));
  }
  CHECK(baked == 5 + 1 + 1 + 4);
  CHECK(missing == 3);  // 256, 512 and 1024 texels show what 2048 do
  for (const KnobFigures& knob : sweep.knobs) {
    CHECK(knob.is_baked == (baked_knobs(plan).find(knob.name + " ") != std::string::npos));
    if (knob.is_baked) CHECK(knob.judge == (knob.name == "radiosity" ? Judge::truth : Judge::model));
  }
  CHECK(sweep_csv(sweep).find(",1234,2.5,radiosity\n") != std::string::npos);
}

// Goal: one line says what baked radiosity would give, or why it is not predicted.
TEST_CASE("findings_say_what_radiosity_would_give") {
  Sweep sweep = sample_sweep();
  CHECK(radiosity_text(sweep) == "bake --radiosity is not predicted");
  sweep.radiosity = {"", 3.14, 1.5 * (1 << 20), 2e6, 0.061, 0.217};
  sweep.width = 100, sweep.height = 10;
  sweep.measured[0].ns_per_pixel.value = 1e6;
  CHECK(radiosity_text(sweep) ==
        "bake --radiosity would take 3.1 s here, store 1.50 MiB and give ꟻLIP 0.061 in 2000 ms a frame, where the "
        "baseline has 0.22 in 1000 ms (predicted)");
  sweep.radiosity.why_not = "the scene stores it";
  CHECK(radiosity_text(sweep) == "bake --radiosity is not predicted: the scene stores it");
}
