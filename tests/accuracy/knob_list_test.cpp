// The knobs: properties of every row, including future ones.
#include "desktop/accuracy/knob_list.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <set>

#include "base/limits.h"
#include "plan/plan_effects.h"

using namespace pocketray;

// Goal: a row sets its value and nothing else. Method: set and read back each value; the other knobs are unchanged; the
// settings are valid for a renderer.
TEST_CASE("knobs_set_what_they_get_and_nothing_else") {
  std::set<std::string> names;
  for (const Knob& knob : knob_list()) {
    CAPTURE(knob.name);
    CHECK(names.insert(knob.name).second);
    CHECK(knob.values.size() >= 2);
    CHECK((knob.labels.empty() || knob.labels.size() == knob.values.size()));
    bool rises = std::is_sorted(knob.values.begin(), knob.values.end()),
         falls = std::is_sorted(knob.values.rbegin(), knob.values.rend());
    CHECK(rises != falls);
    Configuration baseline;
    for (double value : knob.values) {
      Configuration c;
      knob.set(&c, value);
      CHECK(knob.get(c) == value);
      CHECK(validate_settings(c.settings).ok);
      CHECK_FALSE(value_label(knob, value).empty());
      CHECK(relative_price(knob, baseline, value) > 0);
      for (const Knob& other : knob_list())
        if (&other != &knob) CHECK(other.get(c) == other.get(baseline));
    }
    // The default is among the values, at a price of 1.
    std::vector<double> values = knob_values(knob, baseline);
    CHECK(std::count(values.begin(), values.end(), knob.get(baseline)) == 1);
    CHECK(relative_price(knob, baseline, knob.get(baseline)) == 1);
  }
  CHECK(names.count("samples") == 1);
}

// Goal: a baseline between the values of the list is also swept, in its place. Method: 3 samples; a cut-off of 3
// levels, whose values fall.
TEST_CASE("knobs_take_the_baselines_value_in_order") {
  Configuration c;
  c.settings.samples_per_pixel = 3;
  c.settings.cut_off_levels = 3;
  for (const Knob& knob : knob_list()) {
    std::string name = knob.name;
    if (name == "samples") CHECK(knob_values(knob, c) == std::vector<double>{1, 2, 3, 4, 6, 9, 12, 16});
    if (name == "cut-off") CHECK(knob_values(knob, c) == std::vector<double>{16, 8, 4, 3, 2, 1, 0.5, 0.25, 0});
    if (name == "depth") CHECK(knob_values(knob, c).size() == 9);
  }
}

// Goal: knobs without effect are skipped and say why. Method: a plan without effects, then one with each.
TEST_CASE("knobs_apply_where_their_effect_is_on") {
  EffectPlan none, all;
  all.mask = kAllEffects;
  for (EffectDecision& d : none.decisions) std::snprintf(d.reason, sizeof d.reason, "there is nothing");
  for (const Knob& knob : knob_list()) {
    CAPTURE(knob.name);
    std::string why;
    CHECK(knob_applies(knob, knob.scene ? knob.scene : "file.pray", all, &why));
    CHECK(knob_applies(knob, "cornell", none, &why) == (knob.needs == 0));
    if (knob.needs) CHECK(why.find("there is nothing") != std::string::npos);
    if (knob.scene) {
      CHECK_FALSE(knob_applies(knob, "file.pray", all, &why));
      CHECK(why.find(knob.scene) != std::string::npos);
    }
  }
  CHECK(find_output_format("rgb565-dithered") == Configuration().output);
  CHECK(find_output_format("rgb") == -1);
}

// Goal: only a build with a network knows near-lossless rows, which are off by default and neither a frame's setting
// nor varied with others. Method: the list.
TEST_CASE("knobs_send_rows_near_losslessly_with_a_network_alone") {
  const Knob* found = nullptr;
  for (const Knob& knob : knob_list())
    if (std::string(knob.name) == "near-lossless") found = &knob;
#ifdef POCKETRAY_HAVE_NETWORK
  REQUIRE(found != nullptr);
  CHECK_FALSE(found->is_setting);
  CHECK(found->alone);
  CHECK(value_label(*found, found->get(Configuration())) == "off");
  CHECK(value_label(*found, found->values.front()) == "on");
#else
  CHECK(found == nullptr);
#endif
}
