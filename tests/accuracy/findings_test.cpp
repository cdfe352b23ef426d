// Conclusions from a sweep.
#include "desktop/accuracy/findings.h"

#include <doctest/doctest.h>

#include "sample_sweep.h"

using namespace pocketray;

// Goal: the front lists marked configurations with figures, fastest first. Method: three marked in the wrong order, one
// without figures.
TEST_CASE("findings_front_is_sorted_by_time") {
  Sweep sweep = empty_sweep();
  for (int i = 0; i < 4; ++i)
    sweep.measured.push_back(sample_measured("samples", std::to_string(i), 50 - 10 * i, 0.1 * i));
  sweep.measured[3].is_default = true;
  sweep.measured[2].missing = "no memory";
  std::vector<const Measured*> front = front_of(sweep, Judge::truth);
  REQUIRE(front.size() == 3);
  CHECK(front[0]->value == "3");
  CHECK(front[1]->knob == "baseline");
  CHECK(front[2]->value == "0");
  for (Measured& m : sweep.measured) m.model.flip = 0.5;
  CHECK(front_of(sweep, Judge::model).size() == 1);
}

// Goal: of configurations that show the same, the front has the first unless another is clearly faster. Method: twins
// of the baseline, a little and much faster, and one that is nearer by a little.
TEST_CASE("findings_front_has_no_twins") {
  Sweep sweep = empty_sweep();
  sweep.measured.push_back(sample_measured("indirect", "radiosity", 38, 0.08));
  std::vector<const Measured*> front = front_of(sweep, Judge::truth);
  REQUIRE(front.size() == 1);
  CHECK(front[0]->knob == "baseline");
  sweep.measured.push_back(sample_measured("cut-off", "16", 20, 0.08));
  front = front_of(sweep, Judge::truth);
  REQUIRE(front.size() == 1);
  CHECK(front[0]->knob == "cut-off");
  sweep.measured.push_back(sample_measured("samples", "2", 39, 0.07));
  CHECK(front_of(sweep, Judge::truth).size() == 2);
}

// Goal: a knob's ends are its first and last value with figures. Method: the last has none; a claimed gain, one too
// small for the reference, and a loss.
TEST_CASE("findings_ends_are_the_first_and_last_with_figures") {
  Sweep sweep = empty_sweep();
  double errors[] = {0.04, 0.09, 0.01, 0.5};
  for (int i = 0; i < 4; ++i) sweep.measured.push_back(sample_measured("depth", std::to_string(i), 40, errors[i]));
  sweep.measured[4].missing = "no memory", sweep.measured[2].is_default = true;
  KnobEnds ends = ends_of(sweep, "depth");
  REQUIRE((ends.worst && ends.standard && ends.best));
  CHECK(ends.worst->value == "0");
  CHECK(ends.standard->value == "1");
  CHECK(ends.best->value == "2");
  KnobFigures knob;
  CHECK(gain_of(knob, ends) == doctest::Approx(0.03));
  CHECK(gain_claimed(knob, ends));
  set_noise(0.016, &sweep.measured[1], &sweep.measured[3]);
  CHECK(!gain_claimed(knob, ends));
  knob.judge = Judge::truth;
  CHECK(gain_claimed(knob, ends));
  knob.judge = Judge::model;
  set_noise(0.001, &sweep.measured[1], &sweep.measured[3]);
  CHECK(gain_claimed(knob, ends));
  sweep.measured[1].model.flip = 0.001;
  CHECK(!gain_claimed(knob, ends_of(sweep, "depth")));
  CHECK(!ends_of(sweep, "none").worst);
}

// Goal: the knob that buys the most comes first, unless its gain cannot be claimed. Method: the cheapest knob gains too
// little for the reference, another has no price.
TEST_CASE("findings_knobs_are_sorted_by_price") {
  Sweep sweep = empty_sweep();
  add_knob(&sweep, "unknown", 1, kNotMeasured);
  add_knob(&sweep, "tiny", 2, 0.01);
  add_knob(&sweep, "dear", 4, 9);
  add_knob(&sweep, "cheap", 4, 2);
  set_noise(0.03, &sweep.measured[2], &sweep.measured[3]);
  std::string order;
  for (const KnobFigures* knob : knobs_by_price(sweep)) order += knob->name + " ";
  CHECK(order == "cheap dear tiny unknown ");
}

// Goal: a knob is paid in bytes if its ends differ in them. Method: none; the baseline's alone; both, different and
// equal.
TEST_CASE("findings_tell_what_is_paid_in_bytes") {
  Sweep sweep = sample_sweep();
  CHECK(!is_paid_in_bytes(ends_of(sweep, "none")));
  for (Measured& m : sweep.measured)
    if (m.is_default) m.bytes_per_frame = 4000;
  for (const char* knob : {"samples", "area-lights", "normals"}) CHECK(!is_paid_in_bytes(ends_of(sweep, knob)));
  add_sent_knob(&sweep);
  CHECK(is_paid_in_bytes(ends_of(sweep, "near-lossless")));
  sweep.measured.back().bytes_per_frame = 2500;
  CHECK(!is_paid_in_bytes(ends_of(sweep, "near-lossless")));
}
